#include "paracal/io/machine_codes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "columns.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::array<double, 3> kDesignAngles{210.0, 330.0, 90.0};  // deg
constexpr std::array<char, 3> kTowers{'X', 'Y', 'Z'}, kTrims{'A', 'B', 'C'};

/// Words of one code by their letters, the last ones of a file, with their line.
struct Words {
  std::map<char, std::string> text;
  int line = 0;
};

std::vector<std::string_view> words_of(std::string_view line) {
  line = line.substr(0, line.find(';'));
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

class Codes {
 public:
  explicit Codes(const TextFile& file) : file_(file.name) {
    int number = 0;
    for (const std::string_view line : lines_of(file.text)) {
      ++number;
      const std::vector<std::string_view> words = words_of(line);
      if (words.empty() || (words[0] != "M665" && words[0] != "M666")) continue;
      Words& code = words[0] == "M665" ? geometry_ : endstops_;
      code.line = number;
      for (std::size_t k = 1; k < words.size(); ++k) {
        const auto letter = static_cast<char>(std::toupper(static_cast<unsigned char>(words[k].front())));
        code.text[letter] = words[k].substr(1);
      }
    }
  }

  [[noreturn]] void fail(int line, const std::string& complaint) const { throw InputFileError(file_, line, complaint); }

  const Words& geometry() const { return geometry_; }
  const Words& endstops() const { return endstops_; }

  double number(const Words& words, char letter, std::string_view text) const {
    const std::optional<double> value = finite_number(text);
    if (!value) fail(words.line, fmt::format("expected a number after {}, got \"{}\"", letter, text));
    return *value;
  }

  double number_or(const Words& words, char letter, double otherwise) const {
    const auto found = words.text.find(letter);
    return found == words.text.end() ? otherwise : number(words, letter, found->second);
  }

  const std::string& require(char letter, std::string_view what) const {
    const auto found = geometry_.text.find(letter);
    if (found == geometry_.text.end()) {
      fail(geometry_.line, fmt::format("expected M665 with {} ({}), got none", letter, what));
    }
    return found->second;
  }

 private:
  std::string file_;
  Words geometry_, endstops_;
};

/// L290 for all, or L290.1:290.2:290.0; Marlin: and trims A, B, C. (B is the printable radius in RepRapFirmware.)
std::array<double, 3> arms_of(const Codes& codes, CodeDialect dialect) {
  const std::string& text = codes.require('L', "length of the rods");
  const auto colons = std::ranges::count(text, ':');
  if (colons != 0 && colons != 2) {
    codes.fail(codes.geometry().line, fmt::format("expected one length or three after L, got \"{}\"", text));
  }
  std::array<double, 3> arms{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    arms[i] = codes.number(codes.geometry(), 'L', rest.substr(0, end));
    if (dialect == CodeDialect::marlin) arms[i] += codes.number_or(codes.geometry(), kTrims[i], 0.0);
    if (end < rest.size()) rest.remove_prefix(end + 1);
  }
  return arms;
}

double below_carriage(const DeltaGeometry& g, std::size_t i) {
  return std::sqrt(g.arm[i] * g.arm[i] - g.radius * g.radius);
}

/// Height of the nozzle with all carriages at 0.
double nozzle_below(DeltaGeometry geometry) {
  for (std::size_t i = 0; i < 3; ++i) geometry.endstop[i] = -below_carriage(geometry, i);
  const auto place = nozzle(geometry, {0.0, 0.0, 0.0});
  return place ? place->z() : std::nan("");
}

}  // namespace

DeltaGeometry read_machine_codes(const TextFile& file, CodeDialect dialect) {
  const Codes codes(file);
  DeltaGeometry geometry;
  geometry.arm = arms_of(codes, dialect);
  geometry.radius = codes.number(codes.geometry(), 'R', codes.require('R', "delta radius"));
  const double homed = codes.number(codes.geometry(), 'H', codes.require('H', "homed height"));
  if (!(geometry.radius > 0.0) || !(*std::ranges::min_element(geometry.arm) > geometry.radius)) {
    codes.fail(codes.geometry().line,
               fmt::format("expected a delta radius above 0 and rods longer than it, got R {} and L {}",
                           geometry.radius, *std::ranges::min_element(geometry.arm)));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    geometry.tower_angle[i] = to_radians(kDesignAngles[i] + codes.number_or(codes.geometry(), kTowers[i], 0.0));
  }
  const double below = nozzle_below(geometry);
  for (std::size_t i = 0; i < 3; ++i) {
    const double adjustment = codes.number_or(codes.endstops(), kTowers[i], 0.0);
    geometry.endstop[i] =
        dialect == CodeDialect::marlin ? homed - adjustment : homed - below + adjustment - below_carriage(geometry, i);
  }
  return geometry;
}

std::string machine_codes(const DeltaGeometry& geometry, CodeDialect dialect) {
  std::array<double, 3> turned{};
  for (std::size_t i = 0; i < 3; ++i) turned[i] = to_degrees(geometry.tower_angle[i]) - kDesignAngles[i];
  const auto lines = [&](const std::string& rods, double homed, const std::array<double, 3>& adjustments) {
    return fmt::format("M665 {} R{:.4f} H{:.4f} X{:.4f} Y{:.4f} Z{:.4f}\nM666 X{:.4f} Y{:.4f} Z{:.4f}\n", rods,
                       geometry.radius, homed, turned[0], turned[1], turned[2], adjustments[0], adjustments[1],
                       adjustments[2]);
  };
  const double mean_arm = (geometry.arm[0] + geometry.arm[1] + geometry.arm[2]) / 3.0;
  std::array<double, 3> adjustments{};
  if (dialect == CodeDialect::marlin) {
    const double homed = *std::ranges::min_element(geometry.endstop);
    for (std::size_t i = 0; i < 3; ++i) adjustments[i] = homed - geometry.endstop[i];
    const std::string rods = fmt::format("L{:.4f} A{:.4f} B{:.4f} C{:.4f}", mean_arm, geometry.arm[0] - mean_arm,
                                         geometry.arm[1] - mean_arm, geometry.arm[2] - mean_arm);
    return lines(rods, homed, adjustments);
  }
  for (std::size_t i = 0; i < 3; ++i) adjustments[i] = geometry.endstop[i] + below_carriage(geometry, i);
  const double carriages = std::accumulate(adjustments.begin(), adjustments.end(), 0.0) / 3.0;
  for (double& adjustment : adjustments) adjustment -= carriages;
  return lines(fmt::format("L{:.4f}:{:.4f}:{:.4f}", geometry.arm[0], geometry.arm[1], geometry.arm[2]),
               carriages + nozzle_below(geometry), adjustments);
}

}  // namespace paracal::io
