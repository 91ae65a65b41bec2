#include "export_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "columns.hpp"
#include "export_header.hpp"
#include "export_units.hpp"
#include "io/files/letters.hpp"
#include "io/files/utf8.hpp"
#include "paracal/error.hpp"
#include "paracal/io/decimal_sign.hpp"

namespace paracal::io {
namespace {

constexpr std::size_t kNone = 0, kInName = 0;  ///< columns count from 1

struct Line {
  int number;
  std::vector<std::string> fields;
};

struct Layout {
  std::size_t head;  ///< index of the header row among the lines
  HeaderRow row;
  std::size_t name, axis, value;  ///< axis kInName: the name ends with it
  std::size_t unit;               ///< kNone: no column of units
};

std::vector<Line> lines_with_fields(const TextFile& file) {
  std::vector<Line> lines;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    if (is_export_comment(line)) continue;
    lines.push_back({number, export_fields(with_other_bytes_decoded(line), file.style.decimal_comma)});
  }
  return lines;
}

/// 0 to 2 for "X", "xValue", "Y-Wert", "Z coordinate"; empty for anything else.
std::optional<std::size_t> axis_of(std::string_view text) {
  std::string word = heading_of(text).meaning;
  for (const std::string_view end : {"value", "wert", "axis"}) {
    if (word.size() > end.size() && word.ends_with(end)) word.resize(word.size() - end.size());
  }
  const std::size_t axis = std::string_view("xyz").find(word);
  if (word.size() != 1 || axis == std::string_view::npos) return std::nullopt;
  return axis;
}

/// "P1.X", "P1_X", "P1 X" as P1 and 0.
std::optional<std::pair<std::string, std::size_t>> name_with_axis(std::string_view name) {
  const std::size_t at = name.find_last_of("._ :-");
  if (at == std::string_view::npos || at == 0) return std::nullopt;
  const auto axis = axis_of(name.substr(at + 1));
  if (!axis) return std::nullopt;
  return std::pair(std::string(trimmed(name.substr(0, at), " .:")), *axis);
}

/// The column of measured values: of those that say "measured" the first.
std::size_t value_column(const std::vector<Heading>& headings) {
  const auto found =
      std::ranges::find_if(headings, [](const Heading& h) { return h.is_measured && h.meaning.empty(); });
  return found == headings.end() ? kNone : static_cast<std::size_t>(found - headings.begin()) + 1;
}

std::size_t unit_column(const std::vector<Heading>& headings) {
  const auto found = std::ranges::find_if(headings, [](const Heading& h) { return is_unit_word(h.whole); });
  return found == headings.end() ? kNone : static_cast<std::size_t>(found - headings.begin()) + 1;
}

/// Whether the three lines below the header row are x, y and z by this column.
bool has_axes(const std::vector<Line>& lines, const Layout& layout) {
  std::array<bool, 3> seen{};
  for (std::size_t k = layout.head + 1; k <= layout.head + seen.size(); ++k) {
    if (k >= lines.size() || std::max({layout.name, layout.axis, layout.value}) > lines[k].fields.size()) return false;
    const std::string& text = lines[k].fields[(layout.axis == kInName ? layout.name : layout.axis) - 1];
    std::optional<std::size_t> axis;
    if (layout.axis != kInName) axis = axis_of(text);
    if (const auto parts = name_with_axis(text); layout.axis == kInName && parts) axis = parts->second;
    if (!axis) return false;
    seen[*axis] = true;
  }
  return std::ranges::count(seen, true) == std::ssize(seen);
}

std::optional<Layout> layout_of(const TextFile& file, const std::vector<Line>& lines) {
  constexpr std::size_t kLongestHead = 100;
  for (std::size_t k = 0; k < std::min(lines.size(), kLongestHead); ++k) {
    HeaderRow row{lines[k].number, lines[k].fields, {}, {}, k == 0};
    for (const std::string& field : row.fields) {
      row.headings.push_back(is_ignored(file, field) ? Heading() : heading_of(field));
    }
    const std::size_t value = value_column(row.headings);
    const std::vector<std::size_t> names = name_columns(row.headings);
    if (value == kNone || names.empty()) continue;
    for (const std::size_t name : names) {
      Layout layout{k, row, name, kInName, value, unit_column(row.headings)};
      for (; layout.axis <= row.fields.size(); ++layout.axis) {
        if (layout.axis != name && layout.axis != value && has_axes(lines, layout)) return layout;
      }
    }
  }
  return std::nullopt;
}

/// Three lines as one.
class PointLines {
 public:
  PointLines(const TextFile& file, const Layout& layout) : file_(file), layout_(layout) {}

  /// Takes a line of the export; one of another value is left out.
  void add(const Line& line) {
    if (line.fields.size() < std::max(layout_.name, layout_.value)) return;
    std::string name = line.fields[layout_.name - 1];
    std::optional<std::size_t> axis;
    if (layout_.axis == kInName) {
      auto parts = name_with_axis(name);
      if (!parts) return;
      std::tie(name, axis) = *parts;
    } else if (layout_.axis <= line.fields.size()) {
      axis = axis_of(line.fields[layout_.axis - 1]);
    }
    if (!axis) return;
    if (name.empty()) name = name_;  // stated once per point
    if (first_ == 0 || name != name_ || !values_[*axis].empty()) begin(name, line);
    values_[*axis] = line.fields[layout_.value - 1];
  }

  /// Lines of points, at their places among empty lines.
  std::vector<std::string> take(std::size_t count) && {
    finish();
    lines_.resize(std::max(count, lines_.size()));
    return std::move(lines_);
  }

 private:
  void begin(const std::string& name, const Line& line) {
    finish();
    name_ = name;
    first_ = line.number;
    unit_ = layout_.unit == kNone || layout_.unit > line.fields.size() ? "" : line.fields[layout_.unit - 1];
    values_ = {};
  }

  void finish() {
    if (first_ == 0) return;
    for (std::size_t axis = 0; axis < values_.size(); ++axis) {
      if (!values_[axis].empty()) continue;
      throw InputFileError(file_.name, first_,
                           fmt::format("expected x, y and z of point {}, got no {}", name_, "xyz"[axis]));
    }
    const auto place = static_cast<std::size_t>(first_);
    if (lines_.size() < place) lines_.resize(place);
    lines_[place - 1] = fmt::format("{}\t{}\t{}", in_quotes(name_), fmt::join(values_, "\t"), unit_);
  }

  static std::string in_quotes(std::string_view name) {
    std::string text = "\"";
    for (const char c : name) text.append(c == '"' ? 2 : 1, c);
    return text + '"';
  }

  const TextFile& file_;
  const Layout& layout_;
  std::string name_, unit_;
  int first_ = 0;  ///< line of the point; 0: none
  std::array<std::string, 3> values_;
  std::vector<std::string> lines_;
};

/// " [mm]" of a heading "Measured [mm]", or nothing.
std::string unit_text(const Layout& layout) {
  const std::optional<double> mm = layout.row.headings[layout.value - 1].mm;
  if (!mm) return {};
  const auto* unit = std::ranges::find(kLengthUnits, *mm, &LengthUnit::mm);
  return fmt::format(" [{}]", unit->name);
}

}  // namespace

std::optional<TextFile> joined_coordinates(const TextFile& file) {
  const std::vector<Line> lines = lines_with_fields(file);
  const std::optional<Layout> layout = layout_of(file, lines);
  if (!layout) return std::nullopt;
  PointLines points(file, *layout);
  for (std::size_t k = layout->head + 1; k < lines.size(); ++k) points.add(lines[k]);
  const std::vector<std::string_view> all = lines_of(file.text);
  std::vector<std::string> joined = std::move(points).take(all.size());
  for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(layout->row.line); ++k) joined[k] = all[k];
  const std::string unit = unit_text(*layout);
  joined[static_cast<std::size_t>(layout->row.line) - 1] =
      fmt::format("name\tX{0}\tY{0}\tZ{0}\t{1}", unit, layout->unit == kNone ? "" : "unit");
  TextFile result{file.name, fmt::format("{}\n", fmt::join(joined, "\n")), file.style, file.encoding, file.sha256};
  return result;
}

}  // namespace paracal::io
