// What the ladder of corrections makes of height maps of real printers: few of a map's points are read, the others
// judge.
//
//   paracal-height-map-benchmark FOLDER [TIMES [SEED]]
//
// FOLDER has pairs mapN.csv (x_mm,y_mm,z_mm: height errors with the values in force) and mapN.g (M665, M666). It only
// reports. TIMES multiplies 8, 8 and 4 draws a map with 7, 13 and 25 points.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/machine_codes.hpp"
#include "paracal/printer/ladder.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::benchmark {
namespace {

struct HeightMap {
  DeltaGeometry saved;
  std::vector<Eigen::Vector3d> points;

  double radius() const {
    double largest = 0.0;
    for (const Eigen::Vector3d& one : points) largest = std::max(largest, one.head<2>().norm());
    return largest;
  }
  std::size_t nearest(double x, double y) const {
    const auto distance = [&](const Eigen::Vector3d& one) { return std::hypot(one.x() - x, one.y() - y); };
    return static_cast<std::size_t>(std::ranges::min_element(points, {}, distance) - points.begin());
  }
};

/// The maps of a folder that have points to spare.
std::vector<HeightMap> maps_in(const std::filesystem::path& folder) {
  constexpr std::size_t kFewest = 100;
  std::vector<HeightMap> maps;
  for (int number = 1; std::filesystem::exists(folder / fmt::format("map{}.csv", number)); ++number) {
    HeightMap map{io::read_machine_codes(io::read_file((folder / fmt::format("map{}.g", number)).string()),
                                         io::CodeDialect::reprapfirmware),
                  {}};
    const std::string text = io::read_file((folder / fmt::format("map{}.csv", number)).string()).text;
    for (std::size_t line = text.find('\n'); line != std::string::npos; line = text.find('\n', line + 1)) {
      Eigen::Vector3d at;
      if (std::sscanf(text.c_str() + line + 1, "%lf,%lf,%lf", &at.x(), &at.y(), &at.z()) == 3) map.points.push_back(at);
    }
    if (map.points.size() >= kFewest) maps.push_back(std::move(map));
  }
  return maps;
}

/// The centre and rings of six, turned as drawn, as firmwares probe.
std::vector<std::size_t> drawn_points(const HeightMap& map, std::size_t rings, double turn) {
  constexpr std::array<double, 4> kRadii{0.85, 0.48, 0.9, 0.65};  // of the map
  std::vector<std::size_t> points{map.nearest(0.0, 0.0)};
  for (std::size_t ring = 0; ring < rings; ++ring) {
    for (std::size_t k = 0; k < 6; ++k) {
      const double angle = turn + std::numbers::pi / 3.0 * (static_cast<double>(k) + (ring % 2 == 1 ? 0.5 : 0.0));
      const double radius = kRadii[ring] * map.radius();
      points.push_back(map.nearest(radius * std::cos(angle), radius * std::sin(angle)));
    }
  }
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// First layer at the points that were not read, mm rms.
double unseen(const HeightMap& map, const std::vector<std::size_t>& read, const DeltaGeometry& values) {
  double sum = 0.0;
  for (std::size_t k = 0; k < map.points.size(); ++k) {
    if (std::ranges::binary_search(read, k)) continue;
    sum += std::pow(nozzle(values, drops_to(map.saved, map.points[k]).value()).value().z(), 2);
  }
  return std::sqrt(sum / static_cast<double>(map.points.size() - read.size()));
}

void report(const std::vector<HeightMap>& maps, std::size_t rings, int draws, std::mt19937_64& random) {
  std::vector<double> ratios;
  int worse = 0, all = 0;
  for (const HeightMap& map : maps) {
    for (int draw = 0; draw < draws; ++draw, ++all) {
      const double turn = std::numbers::pi / 3.0 * static_cast<double>(random() >> 11) * 0x1p-53;
      const std::vector<std::size_t> read = drawn_points(map, rings, turn);
      DeltaReadings readings;
      for (const std::size_t k : read) readings.heights.push_back({0.0, drops_to(map.saved, map.points[k]).value()});
      const auto found = ladder(map.saved, readings, {.print_radius = map.radius()});
      if (!found || found->advised == 0) continue;
      ratios.push_back(unseen(map, read, found->best().geometry) / unseen(map, read, map.saved));
      worse += ratios.back() > 1.0;
    }
  }
  fmt::print("{:>2} points: advised {} of {}, first layer of unseen points over saved {:.2f} (median), worse {}\n",
             1 + 6 * rings, ratios.size(), all, ratios.empty() ? 1.0 : test::quantile(ratios, 0.5), worse);
}

}  // namespace
}  // namespace paracal::benchmark

int main(int count, char** words) {
  using namespace paracal::benchmark;
  if (count < 2) return 2;
  const int times = count > 2 ? std::stoi(words[2]) : 1;
  std::mt19937_64 random(count > 3 ? std::stoull(words[3]) : 5);
  const std::vector<HeightMap> maps = maps_in(words[1]);
  report(maps, 1, 8 * times, random);
  report(maps, 2, 8 * times, random);
  report(maps, 4, 4 * times, random);
}
