// Where an instrument's export holds what is needed: as somebody says it, or as its header row does.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "columns.hpp"
#include "export_header.hpp"
#include "export_rows.hpp"
#include "export_units.hpp"
#include "io/files/letters.hpp"
#include "orientation.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

double mm_per(std::string_view unit) {
  const auto* found = std::ranges::find(kLengthUnits, unit, &LengthUnit::name);
  if (found != kLengthUnits.end()) return found->mm;
  throw InvalidArgument(fmt::format("unit: expected mm, m, um or inch, got \"{}\"", unit));
}

[[noreturn]] void refuse_columns(std::string_view columns, const std::string& reason) {
  throw InvalidArgument(fmt::format(
      "columns: expected a list like name=3,x=4,y=5,z=6 (numbers from 1, or headings; sigma=7 is optional), got "
      "\"{}\": {}",
      columns, reason));
}

Places places_in(std::string_view columns) {
  Places places{};
  for (const std::string_view part : split(columns, ',')) {
    const std::string_view entry = trimmed(part, " ");
    const std::vector<std::string_view> sides = split(entry, '=');
    const auto* field = std::ranges::find(kExportFields, sides.front());
    if (sides.size() != 2 || field == kExportFields.end()) {
      refuse_columns(columns, fmt::format("\"{}\" is unknown", entry));
    }
    std::string& place = places[static_cast<std::size_t>(field - kExportFields.begin())];
    if (!place.empty()) refuse_columns(columns, fmt::format("{} is given twice", *field));
    if (sides.back().empty()) refuse_columns(columns, "\"\" is not a column");
    place = sides.back();
  }
  return places;
}

bool is_number(const std::string& place) { return finite_number(place).has_value(); }

std::size_t column_number(std::string_view columns, const std::string& place) {
  if (place.empty()) return 0;
  const std::optional<double> number = finite_number(place);
  if (!number || !(*number >= 1.0 && *number <= 1e6) || *number != std::floor(*number)) {
    refuse_columns(columns, fmt::format("\"{}\" is not a column", place));
  }
  return static_cast<std::size_t>(*number);
}

ColumnMap map_of(const FieldColumns& places) {
  ColumnMap map{.name = places[0], .x = places[1], .y = places[2], .z = places[3]};
  if (places[4] != 0) map.sigma = places[4];
  return map;
}

void check_columns(std::string_view columns, const FieldColumns& places, bool by_order) {
  for (std::size_t k = 0; k < kExportFields.size(); ++k) {
    const bool may_lack = kExportFields[k] == "sigma" || (by_order && kExportFields[k] == "name");
    if (places[k] == 0 && !may_lack) refuse_columns(columns, fmt::format("{} is missing", kExportFields[k]));
    if (places[k] != 0 && std::ranges::count(places, places[k]) > 1) {
      refuse_columns(columns, fmt::format("column {} is given twice", places[k]));
    }
  }
}

ColumnMap numbered(std::string_view columns, const Places& places, bool by_order) {
  FieldColumns numbers{};
  for (std::size_t k = 0; k < places.size(); ++k) numbers[k] = column_number(columns, places[k]);
  check_columns(columns, numbers, by_order);
  ColumnMap map = map_of(numbers);
  map.by_order = by_order;
  return map;
}

/// The one unit of the coordinates' headings.
std::optional<double> unit_of(const TextFile& file, const HeaderRow& row, const FieldColumns& columns) {
  std::optional<double> mm = row.headings[columns[1] - 1].mm;
  for (std::size_t field = 2; field < kExportFields.size(); ++field) {
    if (columns[field] == 0 || row.headings[columns[field] - 1].mm == mm) continue;
    throw InputFileError(file.name, row.line,
                         fmt::format("expected the same unit for \"{}\" and \"{}\", got two units",
                                     row.fields[columns[1] - 1], row.fields[columns[field] - 1]));
  }
  return mm;
}

/// What a careful reader should know of a header row.
std::string note_of(const HeaderRow& row, const std::vector<std::size_t>& columns, const StatedUnit& unit) {
  std::vector<std::string> taken, passed;
  for (std::size_t k = 0; k < row.fields.size(); ++k) {
    const bool is_taken = std::ranges::find(columns, k + 1) != columns.end();
    if (!row.fields[k].empty()) (is_taken ? taken : passed).push_back(row.fields[k]);
  }
  std::string text =
      fmt::format("columns taken from the header row in line {}: {} (unit {} mm{})", row.line, fmt::join(taken, ", "),
                  unit.mm, unit.where.empty() ? "" : ", stated in " + unit.where);
  if (!passed.empty()) text += fmt::format("; ignored: {}", fmt::join(passed, ", "));
  if (!row.is_first) text += "; the lines above it are ignored";
  return text;
}

/// Of several candidates the one that says "measured", else the first.
std::size_t likeliest(const HeaderRow& row, const std::vector<std::size_t>& candidates) {
  const auto is_measured = [&](std::size_t column) { return row.headings[column - 1].is_measured; };
  const auto measured = std::ranges::find_if(candidates, is_measured);
  return measured != candidates.end() ? *measured : candidates.front();
}

/// The --columns that choose among the candidates of a header row: by headings, or where these cannot tell columns
/// apart by numbers, which need the unit, too.
std::string choice_of(const HeaderRow& row) {
  FieldColumns columns{};
  bool tells_apart = true;
  std::string by_heading;
  for (std::size_t field = 0; field < kExportFields.size(); ++field) {
    if (row.columns[field].empty()) continue;
    columns[field] = likeliest(row, row.columns[field]);
    const std::string& heading = row.fields[columns[field] - 1];
    tells_apart = tells_apart && std::ranges::count(row.fields, heading) == 1 &&
                  heading.find_first_of(",='") == std::string::npos && !finite_number(heading);
    by_heading += fmt::format("{}{}={}", by_heading.empty() ? "" : ",", kExportFields[field], heading);
  }
  if (tells_apart) return fmt::format("--columns '{}'", by_heading);
  const auto* unit = std::ranges::find(kLengthUnits, row.headings[columns[1] - 1].mm.value_or(1.0), &LengthUnit::mm);
  return fmt::format("--columns {} --unit {}", text_of(columns), unit->name);
}

FieldColumns columns_of(const TextFile& file, const HeaderRow& row, bool by_order) {
  FieldColumns columns{};
  for (std::size_t field = 0; field < kExportFields.size(); ++field) {
    const std::vector<std::size_t>& found = row.columns[field];
    const bool may_lack = kExportFields[field] == "sigma" || (by_order && kExportFields[field] == "name");
    if (found.empty() && may_lack) continue;
    if (found.size() == 1) {
      columns[field] = found.front();
      continue;
    }
    if (by_order && kExportFields[field] == "name") continue;  // nobody asks which
    const std::string expected = fmt::format("expected one column of {} in the header row, got ", kExportFields[field]);
    if (found.empty()) {
      throw InputFileError(file.name, row.line,
                           expected +
                               "none; choose it with --columns, or take the points in the order of the poses with "
                               "--match order");
    }
    std::vector<std::string> got;
    got.reserve(found.size());
    for (const std::size_t column : found) {
      got.push_back(fmt::format("\"{}\" (column {})", row.fields[column - 1], column));
    }
    throw InputFileError(
        file.name, row.line,
        fmt::format("{}{}; choose with --columns, e.g. {}", expected, fmt::join(got, " and "), choice_of(row)));
  }
  return columns;
}

[[noreturn]] void refuse_head(const TextFile& file) {
  throw InputFileError(file.name, 0,
                       "expected a header row that names x, y and z, or from, to and distance_mm, got none: give the "
                       "columns of points with --columns, e.g. name=1,x=2,y=3,z=4, or --columns spatialanalyzer if "
                       "lines end with target x y z");
}

/// The unit, which the file and somebody (0: nobody) must not state differently.
StatedUnit agreed(const TextFile& file, const std::optional<StatedUnit>& in_file, double stated, int line) {
  if (in_file && stated > 0.0 && in_file->mm != stated) {
    throw InputFileError(file.name, in_file->line,
                         fmt::format("expected --unit as in {} ({} mm), got {} mm",
                                     in_file->where.empty() ? "the header row" : in_file->where, in_file->mm, stated));
  }
  if (in_file) return *in_file;
  if (stated > 0.0) return {stated, line, line, {}};
  throw InputFileError(file.name, line,
                       "expected a unit in the header row, as in \"X [mm]\", a line \"Units: mm\" above it, or --unit "
                       "(mm, m, um or inch), got none");
}

StatedUnit unit_of(const TextFile& file, const HeaderRow& row, const FieldColumns& columns, double stated) {
  if (const auto mm = unit_of(file, row, columns))
    return agreed(file, StatedUnit{*mm, row.line, row.line, {}}, stated, row.line);
  return agreed(file, stated_unit(file, row, columns), stated, row.line);
}

ColumnMap headed(const TextFile& file, const Places& wanted, double stated, bool by_order) {
  const std::optional<HeaderRow> row = find_header(file, wanted);
  if (!row) refuse_head(file);
  const FieldColumns columns = columns_of(file, *row, by_order);
  ColumnMap map = map_of(columns);
  map.orientation = orientation_columns(file, *row);
  std::vector<std::size_t> taken(columns.begin(), columns.end());
  if (map.orientation) std::ranges::copy(map.orientation->columns, std::back_inserter(taken));
  check_others(file, *row, taken, wanted);
  const StatedUnit unit = unit_of(file, *row, columns, stated);
  map.mm_per_unit = unit.mm;
  map.data_after = unit.data_after;
  map.by_order = by_order;
  map.notes = {note_of(*row, taken, unit)};
  return map;
}

/// One line per coordinate.
std::optional<ColumnMap> of_coordinate_rows(const TextFile& file, double stated, bool by_order) {
  const std::optional<TextFile> joined = joined_coordinates(file);
  if (!joined) return std::nullopt;
  ColumnMap map = headed(*joined, Places(), stated, by_order);
  map.is_by_coordinate = true;
  map.notes.insert(map.notes.begin(), "each line has one coordinate: three lines are a point");
  return map;
}

/// Number of fields up to the last number: words behind the coordinates are time stamps and comments.
std::size_t count_to_last_number(const std::vector<std::string>& fields) {
  const auto last = std::find_if(fields.rbegin(), fields.rend(), [](const std::string& f) { return may_be_number(f); });
  return static_cast<std::size_t>(fields.rend() - last);
}

/// [[collection] group] target x y z [time stamp].
ColumnMap spatial_analyzer(const TextFile& file, double stated, bool by_order) {
  constexpr std::size_t kFewest = 4, kMost = 6, kCoordinates = 3;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    if (is_export_comment(line)) continue;
    const std::size_t count = count_to_last_number(export_fields(line, file.style.decimal_comma));
    if (count < kFewest || count > kMost) {
      throw InputFileError(file.name, number,
                           fmt::format("expected [[collection] group] target x y z, got {} fields: choose columns with "
                                       "--columns, e.g. name=3,x=4,y=5,z=6",
                                       count));
    }
    const std::size_t name = count - kCoordinates;
    ColumnMap map{.name = name, .x = name + 1, .y = name + 2, .z = name + 3, .by_order = by_order};
    if (const auto unit = unit_above(file, 0)) {
      map.mm_per_unit = agreed(file, unit, stated, number).mm;
      map.notes = {fmt::format("the unit, {} mm, is stated in {}", unit->mm, unit->where)};
    }
    return map;
  }
  throw InputFileError(file.name, 0, "expected at least one line with a point, got none");
}

/// Lines before the first that is no comment.
std::string comments_above(const TextFile& file) {
  std::string text;
  for (const std::string_view line : lines_of(file.text)) {
    if (!is_export_comment(line)) break;
    text.append(line).append("\n");
  }
  return text;
}

ColumnMap found_by(const TextFile& file, std::string_view columns, double stated, bool by_order) {
  const bool says_so = columns.empty() && lower_case(comments_above(file)).find(kSpatialAnalyzer) != std::string::npos;
  if (columns == kSpatialAnalyzer || (says_so && !has_export_header(file))) {
    return spatial_analyzer(file, stated, by_order);
  }
  if (columns.empty() && !find_header(file, Places())) {
    if (auto map = of_coordinate_rows(file, stated, by_order)) return *map;
  }
  const Places places = columns.empty() ? Places() : places_in(columns);
  const auto numbers = std::ranges::count_if(places, is_number);
  const auto given = std::ranges::count_if(places, [](const std::string& place) { return !place.empty(); });
  if (numbers == 0) return headed(file, places, stated, by_order);
  if (numbers < given) refuse_columns(columns, "give either all numbers or all headings");
  return numbered(columns, places, by_order);
}

}  // namespace

ColumnMap parse_column_map(std::string_view columns, std::string_view unit) {
  ColumnMap map = numbered(columns, places_in(columns), false);
  map.mm_per_unit = mm_per(unit);
  return map;
}

ColumnMap find_columns(const TextFile& file, std::string_view columns, std::string_view unit, bool by_order) {
  const double stated = unit.empty() ? 0.0 : mm_per(unit);
  ColumnMap map = found_by(file, columns, stated, by_order);
  if (stated > 0.0) map.mm_per_unit = stated;
  if (!(map.mm_per_unit > 0.0)) throw InvalidArgument("unit: expected mm, m, um or inch, got none");
  return map;
}

bool has_export_header(const TextFile& file) {
  return find_header(file, Places()).has_value() || joined_coordinates(file).has_value();
}

void check_map(const ColumnMap& map) {
  const FieldColumns places = field_columns(map);
  check_columns(text_of(places), places, map.by_order);
  if (!(map.mm_per_unit > 0.0 && std::isfinite(map.mm_per_unit))) {
    throw InvalidArgument(fmt::format("unit: expected more than 0 mm, got {}", map.mm_per_unit));
  }
}

}  // namespace paracal::io
