#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "columns.hpp"
#include "export_fields.hpp"
#include "export_rows.hpp"
#include "io/files/utf8.hpp"
#include "orientation.hpp"
#include "paracal/error.hpp"
#include "paracal/io/decimal_sign.hpp"
#include "paracal/io/points.hpp"
#include "readings.hpp"

namespace paracal::io {
namespace {

struct ExportedPoint {
  int line = 0;
  std::string name;
  Eigen::Vector3d point;        ///< mm
  std::optional<double> sigma;  ///< mm
  std::optional<Quaternion> orientation = {};
};

/// Reads the lines of an export one by one.
class ExportReader {
 public:
  ExportReader(const TextFile& file, const ColumnMap& map)
      : file_(file), map_(map), places_(field_columns(map)), decimals_(file.style.decimal_comma) {}

  std::vector<ExportedPoint> points() {
    std::vector<ExportedPoint> points;
    each_line([&](const std::vector<std::string>& fields) { look_at(fields); });
    each_line([&](const std::vector<std::string>& fields) { points.push_back(point_of(fields)); });
    if (points.empty()) throw InputFileError(file_.name, 0, "expected at least one line with a point, got none");
    return points;
  }

  /// Of the lines that have been read.
  void add_notes(SeriesBuilder& series) const {
    for (const std::string& note : map_.notes) series.note(note);
    if (last_of_head_ > 0) {
      series.note(fmt::format("lines up to {} have no coordinates and are ignored", last_of_head_));
    }
    if (first_decoded_ > 0) series.note(note_of_decoding(first_decoded_));
  }

 private:
  [[noreturn]] void fail(const std::string& complaint) const { throw InputFileError(file_.name, line_, complaint); }

  /// Calls take(fields) for every line that is to be a point.
  void each_line(const auto& take) {
    bool has_begun = map_.data_after > 0;
    line_ = 0;
    for (const std::string_view line : lines_of(file_.text)) {
      if (++line_ <= map_.data_after || is_export_comment(line)) continue;
      const std::vector<std::string> fields = fields_of(line);
      if (!has_begun && is_head(fields)) {
        last_of_head_ = line_;
        continue;
      }
      has_begun = true;
      take(fields);
    }
  }

  std::vector<std::string> fields_of(std::string_view line) {
    std::string decoded;
    if (!is_utf8(line)) line = decoded = decode(line);
    if (std::ranges::count(line, '"') % 2 != 0) {
      fail("expected closed quotation marks around a field, got an open one");
    }
    std::vector<std::string> fields = export_fields(line, file_.style.decimal_comma);
    const std::size_t least = *std::ranges::max_element(places_);
    while (fields.size() > std::max(least, count_) && fields.back().empty()) fields.pop_back();
    return fields;
  }

  /// Words where coordinates are to stand, or nothing, for there are too few fields.
  bool is_head(const std::vector<std::string>& fields) const {
    const auto may_be_coordinate = [&](std::size_t place) {
      return place <= fields.size() && (fields[place - 1].empty() || may_be_number(fields[place - 1]));
    };
    return std::none_of(places_.begin() + 1, places_.begin() + 4, may_be_coordinate);
  }

  void look_at(const std::vector<std::string>& fields) {
    for (std::size_t field = 1; field < places_.size(); ++field) {
      const std::size_t place = places_[field];
      if (place != 0 && place <= fields.size()) decimals_.look(fields[place - 1], line_);
    }
  }

  ExportedPoint point_of(const std::vector<std::string>& fields) {
    check_count(fields.size());
    ExportedPoint point{line_, {}, {coordinate(fields, 1), coordinate(fields, 2), coordinate(fields, 3)}, {}};
    if (places_[0] != 0) point.name = fields[places_[0] - 1];
    if (point.name.empty() && !map_.by_order) fail(fmt::format("expected a name in column {}, got none", places_[0]));
    if (places_[4] != 0) point.sigma = length(fields, 4, plausible::kNoise);
    if (map_.orientation) point.orientation = orientation(fields, *map_.orientation);
    return point;
  }

  double plain_number(const std::vector<std::string>& fields, std::size_t column) const {
    const std::string& text = column <= fields.size() ? fields[column - 1] : std::string();
    const std::optional<double> value = decimals_.number(text);
    if (!value) {
      fail(fmt::format("expected a finite number in column {} (orientation), got \"{}\"{}", column, text,
                       decimals_.why_not(text)));
    }
    return *value;
  }

  Quaternion orientation(const std::vector<std::string>& fields, const OrientationColumns& of) const {
    const auto number = [&](std::size_t k) { return plain_number(fields, of.columns[k]); };
    if (of.columns.size() == 3) {
      std::array<double, 3> angles{};
      for (std::size_t k = 0; k < angles.size(); ++k) angles[k] = number(k) * of.rad_per_unit[k];
      return AngleProduct{of.axes}.of(angles);
    }
    Quaternion read(number(0), number(1), number(2), number(3));
    if (std::abs(read.norm() - 1.0) <= PointReading::kUnitLength) return read;
    fail(fmt::format("expected a unit quaternion, got length {:.6g}", read.norm()));
  }

  std::string decode(std::string_view line) {
    if (first_decoded_ == 0) first_decoded_ = line_;
    return with_other_bytes_decoded(line);
  }

  void check_count(std::size_t count) {
    const std::size_t least = *std::ranges::max_element(places_);
    if (count < least) fail(fmt::format("expected at least {} fields for {}, got {}", least, text_of(places_), count));
    if (first_line_ == 0) {
      first_line_ = line_;
      count_ = count;
    }
    if (count != count_) {
      fail(fmt::format("expected {} fields as in line {}, got {} (put names with separators in quotation marks)",
                       count_, first_line_, count));
    }
  }

  double coordinate(const std::vector<std::string>& fields, std::size_t field) const {
    return length(fields, field, plausible::kInstrument);
  }

  /// mm
  double length(const std::vector<std::string>& fields, std::size_t field, const plausible::Range& range) const {
    const std::string& text = fields[places_[field] - 1];
    const double mm = decimals_.number(text).value_or(std::numeric_limits<double>::quiet_NaN()) * map_.mm_per_unit;
    const std::string column = fmt::format("column {} ({})", places_[field], kExportFields[field]);
    if (!std::isfinite(mm)) {
      fail(fmt::format("expected a finite number in {}, got \"{}\"{}", column, text, decimals_.why_not(text)));
    }
    if (const auto complaint = plausible::complaint(column, mm, range)) fail(*complaint);
    return mm;
  }

  const TextFile& file_;
  const ColumnMap& map_;
  FieldColumns places_;
  DecimalSign decimals_;
  int line_ = 0;
  int first_decoded_ = 0;  ///< line; 0: none
  int last_of_head_ = 0;   ///< likewise
  int first_line_ = 0;     ///< of data
  std::size_t count_ = 0;  ///< of its fields
};

// ---- Matching

/// A few names for a message.
std::string some_of(const auto& items) {
  constexpr std::size_t kShown = 10;
  std::string text;
  for (std::size_t k = 0; k < std::min(items.size(), kShown); ++k) {
    text.append(text.empty() ? "" : ", ").append(items[k].name);
  }
  return items.size() <= kShown ? text : fmt::format("{} and {} more", text, items.size() - kShown);
}

/// Sum of the squared distances between points that lie `step` apart in the list, of one block of `block` points.
double spread(const std::vector<ExportedPoint>& points, std::size_t block, std::size_t step) {
  double sum = 0.0;
  for (std::size_t k = 0; k + step < points.size(); ++k) {
    if (k / block == (k + step) / block) sum += (points[k + step].point - points[k].point).squaredNorm();
  }
  return sum;
}

PointReading reading_of(const ExportedPoint& point, std::size_t station) {
  PointReading reading{.station = station, .point = point.point, .sigma = point.sigma};
  reading.orientation = point.orientation;
  return reading;
}

/// Points in the order of the poses, once or in several passes over all poses.
void add_by_order(SeriesBuilder& series, const std::string& file, const std::vector<ExportedPoint>& points,
                  const std::vector<Station>& poses) {
  const std::size_t count = poses.size(), passes = points.size() / count;
  if (points.size() % count != 0) {
    throw InputFileError(file, 0,
                         fmt::format("expected {0} points in the order of the {0} poses, or {1}, {2}, ... for several "
                                     "passes over them, got {3}; add or remove points, or match by name",
                                     count, 2 * count, 3 * count, points.size()));
  }
  if (passes > 1 && spread(points, passes, 1) < spread(points, points.size(), count)) {
    throw InputFileError(file, points[1].line,
                         fmt::format("expected {} passes over the {} poses, one after the other, got the repeats of "
                                     "each pose together; sort the points by pass",
                                     passes, count));
  }
  const std::string passes_text = passes == 1 ? "" : fmt::format("{} passes over ", passes);
  series.note(fmt::format("{} points are assigned to {}the {} poses in order; their names are ignored", points.size(),
                          passes_text, count));
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::size_t station = k % count;
    series.add(points[k].line, poses[station].name, reading_of(points[k], station));
  }
}

/// "P1" of "A::Home::P1": collection, group and target as one name.
std::string_view last_part(std::string_view name) {
  const std::size_t at = name.rfind("::");
  return at == std::string_view::npos ? name : name.substr(at + 2);
}

void add_by_name(SeriesBuilder& series, const std::string& file, const std::vector<ExportedPoint>& points,
                 const std::vector<Station>& poses) {
  std::unordered_map<std::string_view, std::size_t> places;
  for (std::size_t k = 0; k < poses.size(); ++k) places.try_emplace(poses[k].name, k);
  std::vector<bool> is_measured(poses.size());
  for (const ExportedPoint& point : points) {
    auto place = places.find(point.name);
    if (place == places.end()) place = places.find(last_part(point.name));
    if (place == places.end()) {
      series.note(point.line, fmt::format("{} is not a pose and is ignored", point.name));
      continue;
    }
    is_measured[place->second] = true;
    series.add(point.line, point.name, reading_of(point, place->second));
  }
  if (series.is_empty()) {
    throw InputFileError(
        file, 0,
        fmt::format("expected a point named as one of the poses {}; got only {}: rename them, or assign "
                    "them in order with --match order",
                    some_of(poses), some_of(points)));
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (!is_measured[k]) series.note(fmt::format("pose {} was not measured", poses[k].name));
  }
}

}  // namespace

Measurements read_tracker_export(const TextFile& file, const ColumnMap& columns, const std::vector<Station>& poses,
                                 const JointSpace& joints) {
  check_map(columns);
  const std::optional<TextFile> joined = columns.is_by_coordinate ? joined_coordinates(file) : std::nullopt;
  ExportReader reader(joined ? *joined : file, columns);
  const std::vector<ExportedPoint> points = reader.points();
  SeriesBuilder series(file, joints.reach);
  reader.add_notes(series);
  (columns.by_order ? add_by_order : add_by_name)(series, file.name, points, poses);
  return std::move(series).finish(poses);
}

}  // namespace paracal::io
