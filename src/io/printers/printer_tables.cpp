#include "paracal/io/printer_tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <map>
#include <vector>

#include "io/tables/columns.hpp"
#include "paracal/error.hpp"
#include "paracal/io/csv.hpp"

namespace paracal::io {
namespace {

class ReadingRows {
 public:
  ReadingRows(const CsvTable& table, const DeltaGeometry& geometry) : table_(table), geometry_(geometry) {}

  BedReading height(std::size_t row) const {
    return {.height = or_zero(row, "height_mm"), .drops = drops(row, "x_mm", "y_mm", number(row, "z_mm"))};
  }

  PrintedDistance distance(std::size_t row) const {
    const double length = number(row, "distance_mm"), z = or_zero(row, "z_mm");
    if (!(length >= PrintedDistance::kShortest)) {
      table_.fail(row,
                  fmt::format("expected distance_mm of at least {:g}, got {}", PrintedDistance::kShortest, length));
    }
    return {
        .distance = length, .from = drops(row, "from_x_mm", "from_y_mm", z), .to = drops(row, "to_x_mm", "to_y_mm", z)};
  }

 private:
  double or_zero(std::size_t row, std::string_view column) const {
    return table_.optional_number(row, column, plausible::length(reach(geometry_))).value_or(0.0);
  }
  double number(std::size_t row, std::string_view column) const {
    return table_.number(row, column, plausible::length(reach(geometry_)));
  }

  JointDrops drops(std::size_t row, std::string_view x, std::string_view y, double z) const {
    const Eigen::Vector3d place(number(row, x), number(row, y), z);
    const auto drops = drops_to(geometry_, place);
    if (!drops) {
      table_.fail(row, fmt::format("expected a position that the printer reaches, got ({:g}, {:g}, {:g}) mm", place.x(),
                                   place.y(), place.z()));
    }
    return *drops;
  }

  const CsvTable& table_;
  const DeltaGeometry& geometry_;
};

constexpr std::string_view kHeightMap = "RepRapFirmware height map";

/// The grid of a height map.
class HeightMap {
 public:
  /// @param names, values  second and third line of the file, which differ from version to version.
  HeightMap(const TextFile& file, std::string_view names, std::string_view values) : file_(file) {
    const std::vector<std::string_view> keys = cut(names, ','), numbers = cut(values, ',');
    for (std::size_t k = 0; k < std::min(keys.size(), numbers.size()); ++k) {
      if (const auto number = finite_number(numbers[k])) grid_.emplace(trimmed(keys[k]), *number);
    }
  }

  Eigen::Vector2d place(std::size_t row, std::size_t column) const {
    return {value({"xmin", "min0"}) + static_cast<double>(column) * value({"xspacing", "spacing0", "spacing"}),
            value({"ymin", "min1"}) + static_cast<double>(row) * value({"yspacing", "spacing1", "spacing"})};
  }

 private:
  double value(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      if (const auto found = grid_.find(name); found != grid_.end()) return found->second;
    }
    throw InputFileError(file_.name, 3, fmt::format("expected {} of the height map, got none", *names.begin()));
  }

  const TextFile& file_;
  std::map<std::string_view, double> grid_;
};

/// RepRapFirmware's heightmap.csv: where the nozzle was when the probe triggered. A plain 0 was not probed.
DeltaReadings read_height_map(const TextFile& file, const DeltaGeometry& geometry) {
  constexpr std::size_t kHead = 3;
  const std::vector<std::string_view> lines = lines_of(file.text);
  if (lines.size() <= kHead) throw InputFileError(file.name, 0, "expected rows of heights, got none");
  const HeightMap map(file, lines[1], lines[2]);
  DeltaReadings readings;
  for (std::size_t line = kHead; line < lines.size(); ++line) {
    const std::vector<std::string_view> cells = cut(lines[line], ',');
    for (std::size_t column = 0; column < cells.size(); ++column) {
      const std::string_view cell = trimmed(cells[column]);
      if (cell.empty() || cell == "0") continue;
      const auto number = static_cast<int>(line) + 1;
      const auto height = finite_number(cell);
      if (!height || std::abs(*height) > plausible::length(reach(geometry)).most) {
        throw InputFileError(file.name, number, fmt::format("expected a height of the bed, got \"{}\"", cell));
      }
      Eigen::Vector3d place;
      place << map.place(line - kHead, column), *height;
      const auto drops = drops_to(geometry, place);
      if (!drops) {
        throw InputFileError(file.name, number,
                             fmt::format("expected a position that the printer reaches, got ({:g}, {:g})"
                                         " mm",
                                         place.x(), place.y()));
      }
      readings.heights.push_back({.height = 0.0, .drops = *drops});
    }
  }
  return readings;
}

}  // namespace

DeltaReadings read_printer_table(const TextFile& file, const DeltaGeometry& geometry) {
  if (file.text.starts_with(kHeightMap)) return read_height_map(file, geometry);
  const CsvTable table(file);
  const ReadingRows reader(table, geometry);
  DeltaReadings readings;
  if (table.has("distance_mm")) {
    table.allow_only({"from_x_mm", "from_y_mm", "to_x_mm", "to_y_mm", "distance_mm", "z_mm"});
    for (std::size_t row = 0; row < table.row_count(); ++row) readings.distances.push_back(reader.distance(row));
    return readings;
  }
  table.allow_only({"x_mm", "y_mm", "z_mm", "height_mm"});
  for (std::size_t row = 0; row < table.row_count(); ++row) readings.heights.push_back(reader.height(row));
  return readings;
}

}  // namespace paracal::io
