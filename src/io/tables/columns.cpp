#include "columns.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "io/files/letters.hpp"
#include "names.hpp"
#include "paracal/units.hpp"

namespace paracal::io {

const std::array<std::string_view, kMaxLimbs>& joint_names(Unit unit) {
  static constexpr std::array<std::string_view, kMaxLimbs> kAngles{"q1_deg", "q2_deg", "q3_deg", "q4_deg",
                                                                   "q5_deg", "q6_deg", "q7_deg", "q8_deg"};
  static constexpr std::array<std::string_view, kMaxLimbs> kLengths{"q1_mm", "q2_mm", "q3_mm", "q4_mm",
                                                                    "q5_mm", "q6_mm", "q7_mm", "q8_mm"};
  return unit == Unit::mm ? kLengths : kAngles;
}

std::vector<std::string_view> with_joint_columns(std::vector<std::string_view> columns, const JointSpace& joints) {
  const auto add = [&](Unit unit, std::size_t count) {
    const auto& names = joint_names(unit);
    columns.insert(columns.end(), names.begin(), names.begin() + static_cast<std::ptrdiff_t>(count));
  };
  if (joints.count > 0) {
    add(joint_unit(joints.actuator), std::min(joints.count, std::size_t{kMaxLimbs}));
  } else {
    add(Unit::rad, kMaxLimbs);
    add(Unit::mm, kMaxLimbs);
  }
  return columns;
}

JointSpace joint_columns(const CsvTable& table, const JointSpace& joints) {
  const auto present = [&](Unit unit) {
    return static_cast<std::size_t>(
        std::ranges::count_if(joint_names(unit), [&](std::string_view column) { return table.has(column); }));
  };
  constexpr std::size_t kFewest = 3;  // of a robot that nobody names; one of two joints is named
  const std::size_t angles = present(Unit::rad), lengths = present(Unit::mm);
  JointSpace found;
  found.guided_z = joints.guided_z;
  found.reach = joints.reach;
  if (angles + lengths == 0) return found;
  const bool as_asked = joint_unit(joints.actuator) == (angles > 0 ? Unit::rad : Unit::mm);
  found.actuator = as_asked ? joints.actuator : angles > 0 ? Actuator::revolute : Actuator::linear;
  found.count = std::max({angles, lengths, joints.count > 0 ? joints.count : kFewest});
  return found;
}

Joints joints_of(const CsvTable& table, std::size_t row, const JointSpace& joints) {
  Joints coordinates(static_cast<Eigen::Index>(joints.count));
  for (std::size_t i = 0; i < joints.count; ++i) {
    const Unit unit = joint_unit(joints.actuator);
    const plausible::Range range = unit == Unit::mm ? plausible::length(joints.reach) : plausible::kAngle;
    const double value = table.number(row, joint_names(unit)[i], range);
    coordinates(static_cast<Eigen::Index>(i)) = from_file_unit(unit, value);
  }
  return coordinates;
}

bool states_joints(const CsvTable& table, std::size_t row, const JointSpace& joints) {
  const auto names = std::span(joint_names(joint_unit(joints.actuator))).first(joints.count);
  return std::ranges::any_of(names, [&](std::string_view column) { return !table.text(row, column).empty(); });
}

double half_last_digit(std::string_view number) {
  const std::size_t end = std::min(number.find_first_of("eE"), number.size());
  const std::string_view mantissa = number.substr(0, end);
  const double exponent = end < number.size() ? finite_number(number.substr(end + 1)).value_or(0.0) : 0.0;
  const std::size_t point = mantissa.find_last_of(".,");
  const auto decimals = point == std::string_view::npos ? 0.0 : static_cast<double>(mantissa.size() - point - 1);
  return 0.5 * std::pow(10.0, exponent - decimals);
}

Pose pose_of(const CsvTable& table, std::size_t row, const PoseColumns& columns, const JointSpace& joints) {
  const bool states_z = !joints.guided_z || table.has(columns.z);
  const auto coordinate = [&](std::string_view column) {
    return table.number(row, column, plausible::length(joints.reach));
  };
  Pose pose{{coordinate(columns.x), coordinate(columns.y), states_z ? coordinate(columns.z) : *joints.guided_z}};
  if (table.has(columns.phi)) pose.rotation = to_radians(table.number(row, columns.phi, plausible::kAngle));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!table.has(columns.tilt[axis])) continue;
    const double tilt = table.number(row, columns.tilt[axis], plausible::kAngle);
    pose.tilt(static_cast<Eigen::Index>(axis)) = columns.tilt_in_rad ? tilt : to_radians(tilt);
  }
  return pose;
}

std::string pose_name(const CsvTable& table, std::size_t row) {
  const std::string& name = table.text(row, "pose");
  if (name.empty()) table.fail(row, "expected a name in column pose, got none");
  return name;
}

std::string row_name(const CsvTable& table, std::size_t row) {
  return table.has("pose") ? pose_name(table, row) : std::to_string(table.number_of(row));
}

std::string quoted(const std::string& name) {
  const bool would_be_formula = begins_as_formula(name) && !finite_number(name);
  std::string field = would_be_formula ? kNoFormula + name : name;
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  const bool has_blank_ends = !field.empty() && (is_blank(field.front()) || is_blank(field.back()));
  if (field.find_first_of(",\"\r\n#") == std::string::npos && !has_blank_ends) return field;
  std::string text = "\"";
  for (const char c : field) text.append(c == '"' ? 2 : 1, c);
  return text + '"';
}

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

std::string_view without_end(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  parts.push_back(text);
  return parts;
}

std::vector<std::string_view> cut(std::string_view text, char separator) {
  std::vector<std::string_view> parts = split(text, separator);
  for (std::string_view& part : parts) part = trimmed(part);
  return parts;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  text = without_byte_order_mark(text);
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(without_end(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::optional<double> finite_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace paracal::io
