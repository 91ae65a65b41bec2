#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "io/files/letters.hpp"
#include "io/tables/columns.hpp"
#include "paracal/error.hpp"
#include "paracal/io/robot_statement.hpp"
#include "target_line.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kWrongFields = "a row with more or fewer fields than the header";
constexpr std::string_view kNoNumber = "a pose that is not a finite number";

/// Where a field's text stands in a line, without blanks and quotation marks around it.
struct Field {
  std::size_t begin = 0, end = 0;

  std::string_view of(std::string_view line) const { return line.substr(begin, end - begin); }
};

/// Fields of a line as CsvTable takes them.
/// @returns false where a quotation mark is not closed.
bool split(std::string_view line, std::vector<Field>& fields) {
  fields.clear();
  for (std::size_t at = 0;; ++at) {
    while (at < line.size() && is_blank(line[at])) ++at;
    Field field{at, at};
    if (at < line.size() && line[at] == '"') {
      field.begin = at + 1;
      for (field.end = line.find('"', field.begin);
           line.substr(std::min(field.end, line.size())).starts_with("\"\"");) {
        field.end = line.find('"', field.end + 2);
      }
      if (field.end == std::string_view::npos) return false;
      at = field.end + 1;
      while (at < line.size() && is_blank(line[at])) ++at;
      if (at < line.size() && line[at] != ',') return false;
    } else {
      at = std::min(line.find(',', at), line.size());
      if (line.substr(field.begin, at - field.begin).find('"') != std::string_view::npos) return false;
      field.end = at;
      while (field.end > field.begin && is_blank(line[field.end - 1])) --field.end;
    }
    fields.push_back(field);
    if (at == line.size()) return true;
  }
}

class PoseTable : public TargetFormat {
 public:
  PoseTable(std::string name, const Robot& robot) : name_(std::move(name)), robot_(robot), axes_(robot) {}

  std::string_view read(std::string_view text, TargetLine& target) override {
    const std::size_t mark = target.number == 1 && text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    const std::string_view line = text.substr(mark);
    check_robot(line, target.number);
    if (line.starts_with('#') || line.find_first_not_of(" \t") == std::string_view::npos) return {};
    const bool is_closed = split(line, fields_);
    if (!has_header()) {
      if (!is_closed) fail(target.number, "expected closed quotation marks around a field, got an open one");
      read_header(line, target.number);
      return {};
    }
    return is_closed && fields_.size() == column_count_ ? read_row(text, target) : kWrongFields;
  }

  void finish() const override {
    if (!has_header()) fail(0, "expected a header line, got no line");
  }

 private:
  bool has_header() const { return column_count_ > 0; }

  void check_robot(std::string_view line, std::int64_t number) const {
    const auto stated = robot_of_line(name_, static_cast<int>(number), line);
    if (stated) require_same({.robot = robot_, .by = "the calibration"}, *stated);
  }

  [[noreturn]] void fail(std::int64_t line, const std::string& complaint) const {
    throw InputFileError(name_, static_cast<int>(line), complaint);
  }

  std::optional<std::size_t> find(std::string_view line, std::int64_t number, std::string_view column) const {
    std::optional<std::size_t> found;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      if (fields_[k].of(line) != column) continue;
      if (found) fail(number, fmt::format("expected a header line with every column once, got \"{}\" twice", column));
      found = k;
    }
    return found;
  }

  void read_header(std::string_view line, std::int64_t number) {
    const PoseColumns& columns = find(line, number, kCommandedPose.x) ? kCommandedPose : kPlainPose;
    const auto& [tilt_x, tilt_y, tilt_z] = columns.tilt;
    const std::string_view about_z = axes_.tilt_plate() ? tilt_z : columns.phi;
    const std::array names{columns.x, columns.y, columns.z, tilt_x, tilt_y, about_z};
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      if (!axes_.moves(axis) && names[axis] != columns.phi) continue;
      columns_[axis] = find(line, number, names[axis]);
      if (columns_[axis] || !axes_.moves(axis)) continue;
      fail(number, fmt::format("expected a column \"{}\", got {}", names[axis], line));
    }
    column_count_ = fields_.size();
  }

  /// phi of a rigid plate is read, but left: its targets turn no more than its poses.
  std::string_view read_row(std::string_view text, TargetLine& target) const {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      if (!columns_[axis]) continue;
      const Field& field = fields_[*columns_[axis]];
      const std::optional<double> value = finite_number(field.of(text));
      if (!value) return kNoNumber;
      target.path.to[axis] = *value;
      if (axes_.moves(axis)) target.stated[axis] = {field.begin, field.end, *value};
    }
    target.kind = TargetLine::Kind::target;
    return {};
  }

  std::string name_;
  const Robot& robot_;
  RobotAxes axes_;
  std::size_t column_count_ = 0;  ///< 0: the header has not come yet
  std::array<std::optional<std::size_t>, kAxes> columns_ = {};
  std::vector<Field> fields_;
};

}  // namespace

FilterSummary filter_pose_table(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                                unsigned threads) {
  PoseTable table(in.name, correction.robot());
  LineReader lines(in);
  return filter(lines, out, table, correction, {.axes = RobotAxes(correction.robot()), .threads = threads});
}

}  // namespace paracal::io
