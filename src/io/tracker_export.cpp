#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "columns.hpp"
#include "paracal/error.hpp"
#include "paracal/io/points.hpp"
#include "readings.hpp"
#include "utf8.hpp"

namespace paracal::io {
namespace {

// ---- Column map

constexpr std::array<std::string_view, 5> kFields{"name", "x", "y", "z", "sigma"};
using FieldColumns = std::array<std::size_t, kFields.size()>;  ///< 0: none

struct LengthUnit {
  std::string_view name;
  double mm;
};
constexpr std::array<LengthUnit, 4> kUnits{{{"mm", 1.0}, {"m", 1000.0}, {"um", 0.001}, {"inch", 25.4}}};

double mm_per(std::string_view unit) {
  const auto* found = std::ranges::find(kUnits, unit, &LengthUnit::name);
  if (found == kUnits.end()) throw InvalidArgument(fmt::format("unit: expected mm, m, um or inch, got \"{}\"", unit));
  return found->mm;
}

/// The text between separators; never empty.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  parts.push_back(text);
  return parts;
}

[[noreturn]] void refuse_columns(std::string_view columns, const std::string& reason) {
  throw InvalidArgument(
      fmt::format("columns: expected a list like name=3,x=4,y=5,z=6 (from 1, sigma=7 where stated), got \"{}\": {}",
                  columns, reason));
}

FieldColumns field_columns(std::string_view columns) {
  FieldColumns places{};
  for (const std::string_view part : split(columns, ',')) {
    const std::string_view entry = trimmed(part, " ");
    const std::vector<std::string_view> sides = split(entry, '=');
    const auto* field = std::ranges::find(kFields, sides.front());
    if (sides.size() != 2 || field == kFields.end()) refuse_columns(columns, fmt::format("what is \"{}\"?", entry));
    std::size_t& place = places[static_cast<std::size_t>(field - kFields.begin())];
    if (place != 0) refuse_columns(columns, fmt::format("{} stands twice", *field));
    const std::optional<double> number = finite_number(sides.back());
    if (!number || !(*number >= 1.0 && *number <= 1e6) || *number != std::floor(*number)) {
      refuse_columns(columns, fmt::format("\"{}\" is no column", sides.back()));
    }
    place = static_cast<std::size_t>(*number);
  }
  return places;
}

FieldColumns field_columns(const ColumnMap& map) { return {map.name, map.x, map.y, map.z, map.sigma.value_or(0)}; }

/// As the user gives them: "name=3,x=4,y=5,z=6".
std::string text_of(const FieldColumns& places) {
  std::string text;
  for (std::size_t k = 0; k < kFields.size(); ++k) {
    if (places[k] != 0) text += fmt::format("{}{}={}", text.empty() ? "" : ",", kFields[k], places[k]);
  }
  return text;
}

void check_columns(std::string_view columns, const FieldColumns& places) {
  for (std::size_t k = 0; k < kFields.size(); ++k) {
    if (places[k] == 0 && kFields[k] != "sigma") refuse_columns(columns, fmt::format("{} is missing", kFields[k]));
    if (places[k] != 0 && std::ranges::count(places, places[k]) > 1) {
      refuse_columns(columns, fmt::format("column {} stands twice", places[k]));
    }
  }
}

void check_map(const ColumnMap& map) {
  const FieldColumns places = field_columns(map);
  check_columns(text_of(places), places);
  if (!(map.mm_per_unit > 0.0 && std::isfinite(map.mm_per_unit))) {
    throw InvalidArgument(fmt::format("unit: expected more than 0 mm, got {}", map.mm_per_unit));
  }
}

// ---- Lines

bool is_comment(std::string_view line) {
  const std::size_t start = line.find_first_not_of(" \t");
  return start == std::string_view::npos || line.substr(start).starts_with("//") || line[start] == '#';
}

/// The first of tab, semicolon and comma that stands outside quotation marks; else a blank.
char separator_of(std::string_view line) {
  const std::vector<std::string_view> by_quotes = split(line, '"');  // every second part is inside
  for (const char separator : {'\t', ';', ','}) {
    for (std::size_t k = 0; k < by_quotes.size(); k += 2) {
      if (by_quotes[k].find(separator) != std::string_view::npos) return separator;
    }
  }
  return ' ';
}

/// Takes a field off the front of a line; a doubled quotation mark inside quotation marks is one.
std::string take_field(std::string_view& rest, char separator) {
  std::string field;
  bool is_quoted = false;
  while (!rest.empty() && (is_quoted || rest.front() != separator)) {
    const char c = rest.front();
    rest.remove_prefix(1);
    if (c != '"') {
      field += c;
    } else if (is_quoted && rest.starts_with('"')) {
      field += c;
      rest.remove_prefix(1);
    } else {
      is_quoted = !is_quoted;
    }
  }
  return std::string(trimmed(field, " "));
}

std::vector<std::string> fields_of(std::string_view line) {
  const char separator = separator_of(line);
  std::vector<std::string> fields;
  for (std::string_view rest = trimmed(line, " ");; rest.remove_prefix(1)) {
    if (separator == ' ') rest = trimmed(rest, " ");  // any number of blanks separate
    fields.push_back(take_field(rest, separator));
    if (rest.empty()) return fields;
  }
}

struct ExportedPoint {
  int line = 0;
  std::string name;
  Eigen::Vector3d point;        ///< mm
  std::optional<double> sigma;  ///< mm
};

/// Reads the lines of an export one by one.
class ExportReader {
 public:
  ExportReader(const TextFile& file, const ColumnMap& map)
      : file_(file), places_(field_columns(map)), mm_per_unit_(map.mm_per_unit) {}

  std::vector<ExportedPoint> points() {
    std::vector<ExportedPoint> points;
    for (const std::string_view line : lines_of(file_.text)) {
      ++line_;
      if (!is_comment(line)) points.push_back(point_of(line));
    }
    if (points.empty()) throw InputFileError(file_.name, 0, "expected at least one line with a point, got none");
    return points;
  }

 private:
  [[noreturn]] void fail(const std::string& complaint) const { throw InputFileError(file_.name, line_, complaint); }

  ExportedPoint point_of(std::string_view line) {
    if (!is_utf8(line)) fail("expected UTF-8 text, got other bytes");
    if (std::ranges::count(line, '"') % 2 != 0) {
      fail("expected closed quotation marks around a field, got an open one");
    }
    const std::vector<std::string> fields = fields_of(line);
    check_count(fields.size());
    ExportedPoint point{line_, fields[places_[0] - 1], {length(fields, 1), length(fields, 2), length(fields, 3)}, {}};
    if (point.name.empty()) fail(fmt::format("expected a name in column {}, got none", places_[0]));
    if (places_[4] != 0) point.sigma = length(fields, 4);
    if (point.sigma && !(*point.sigma > 0.0)) fail(fmt::format("expected sigma above 0, got {} mm", *point.sigma));
    return point;
  }

  void check_count(std::size_t count) {
    const std::size_t least = *std::ranges::max_element(places_);
    if (count < least) fail(fmt::format("expected at least {} fields for {}, got {}", least, text_of(places_), count));
    if (first_line_ == 0) {
      first_line_ = line_;
      count_ = count;
    }
    if (count != count_) {
      fail(fmt::format("expected {} fields as in line {}, got {} (names with separators in them need quotation marks)",
                       count_, first_line_, count));
    }
  }

  double length(const std::vector<std::string>& fields, std::size_t field) const {
    const std::string& text = fields[places_[field] - 1];
    const double mm = finite_number(text).value_or(std::numeric_limits<double>::quiet_NaN()) * mm_per_unit_;
    if (!std::isfinite(mm)) {
      fail(fmt::format("expected a finite number in column {} ({}), got \"{}\"", places_[field], kFields[field], text));
    }
    return mm;
  }

  const TextFile& file_;
  FieldColumns places_;
  double mm_per_unit_;
  int line_ = 0;
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

}  // namespace

ColumnMap parse_column_map(std::string_view columns, std::string_view unit) {
  const FieldColumns places = field_columns(columns);
  check_columns(columns, places);
  ColumnMap map{.name = places[0], .x = places[1], .y = places[2], .z = places[3], .mm_per_unit = mm_per(unit)};
  if (places[4] != 0) map.sigma = places[4];
  return map;
}

Measurements read_tracker_export(const TextFile& file, const ColumnMap& columns, const std::vector<Station>& poses) {
  check_map(columns);
  const std::vector<ExportedPoint> points = ExportReader(file, columns).points();
  std::unordered_map<std::string_view, std::size_t> places;
  for (std::size_t k = 0; k < poses.size(); ++k) places.try_emplace(poses[k].name, k);
  SeriesBuilder series(file);
  std::vector<bool> is_measured(poses.size());
  for (const ExportedPoint& point : points) {
    const auto place = places.find(point.name);
    if (place == places.end()) {
      series.note(point.line, fmt::format("{} is no pose: passed over", point.name));
      continue;
    }
    is_measured[place->second] = true;
    series.add(point.line, point.name, {.station = place->second, .point = point.point, .sigma = point.sigma});
  }
  if (series.is_empty()) {
    throw InputFileError(
        file.name, 0,
        fmt::format("expected a point named as one of the poses {}; got only {}", some_of(poses), some_of(points)));
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (!is_measured[k]) series.note(fmt::format("pose {} was not measured", poses[k].name));
  }
  return std::move(series).finish(poses);
}

}  // namespace paracal::io
