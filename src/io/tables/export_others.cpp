// The columns of an export that are not taken: those that could change the result must not be passed over unasked.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "columns.hpp"
#include "export_header.hpp"
#include "io/files/utf8.hpp"
#include "paracal/error.hpp"
#include "paracal/io/decimal_sign.hpp"

namespace paracal::io {
namespace {

/// Numbers under such words are for people: what was to be measured, how far the point is from it, when and how often,
/// the same point as the instrument saw it, the direction of a probed surface.
constexpr std::array<std::string_view, 74> kForPeople{
    "nominal",    "nom",       "nomi",       "design",    "theoretical", "reference", "ref",         "target",
    "dev",        "deviation", "deviations", "error",     "err",         "diff",      "dx",          "dy",
    "dz",         "d3d",       "rms",        "residual",  "tol",         "tolerance", "no",          "nr",
    "num",        "number",    "index",      "idx",       "id",          "row",       "line",        "count",
    "samples",    "n",         "#",          "date",      "time",        "timestamp", "datum",       "zeit",
    "hour",       "day",       "comment",    "remark",    "note",        "temp",      "temperature", "pressure",
    "humidity",   "status",    "azimuth",    "elevation", "range",       "distance",  "snr",         "quality",
    "intensity",  "frame",     "markers",    "marker",    "i",           "j",         "k",           "normal",
    "upper",      "lower",     "uppertol",   "lowertol",  "soll",        "sollwert",  "abweichung",  "\u00E9cart",
    "\u00C9cart", "ecart"};

bool is_for_people(const Heading& heading) {
  return std::ranges::any_of(split(heading.meaning, ' '), [](std::string_view word) {
    return std::ranges::find(kForPeople, word) != kForPeople.end();
  });
}

/// Below the header row; a column of words has none.
bool has_number(const TextFile& file, int header_line, std::size_t column) {
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    if (++number <= header_line || is_export_comment(line)) continue;
    const std::vector<std::string> fields = export_fields(with_other_bytes_decoded(line), file.style.decimal_comma);
    if (column < fields.size() && !fields[column].empty() && may_be_number(fields[column])) return true;
  }
  return false;
}

}  // namespace

bool is_ignored(const TextFile& file, const std::string& heading) {
  return std::ranges::find(file.style.ignored_columns, heading) != file.style.ignored_columns.end();
}

void check_others(const TextFile& file, const HeaderRow& row, const std::vector<std::size_t>& taken,
                  const Places& wanted) {
  std::vector<std::string> others;
  for (std::size_t k = 0; k < row.fields.size(); ++k) {
    const auto is_of = [&](std::size_t field) {
      return !wanted[field].empty() && row.headings[k].meaning == kExportFields[field];  // another column was chosen
    };
    const bool is_passed = row.fields[k].empty() || is_ignored(file, row.fields[k]) || is_for_people(row.headings[k]) ||
                           std::ranges::find(taken, k + 1) != taken.end() || is_of(1) || is_of(2) || is_of(3);
    if (!is_passed && has_number(file, row.line, k)) others.push_back(row.fields[k]);
  }
  if (others.empty()) return;
  throw InputFileError(
      file.name, row.line,
      fmt::format(
          "expected no column beside name, x, y, z and sigma that could change the result, got \"{}\": state "
          "orientations as quaternions (qw, qx, qy, qz), or angles with a comment \"# angles: Rz Ry Rx\", second "
          "points and joints in a table of points, or ignore columns with --ignore-columns \"{}\"",
          fmt::join(others, "\", \""), fmt::join(others, ",")));
}

}  // namespace paracal::io
