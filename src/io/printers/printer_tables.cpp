#include "paracal/io/printer_tables.hpp"

#include <fmt/format.h>

#include "io/tables/columns.hpp"
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

}  // namespace

DeltaReadings read_printer_table(const TextFile& file, const DeltaGeometry& geometry) {
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
