#include "paracal/io/klipper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>

#include "columns.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kSavedMark = "#*#";
constexpr std::array<std::string_view, 3> kTowers{"stepper_a", "stepper_b", "stepper_c"};

/// How the keys of one kind of delta are called.
struct Keys {
  Actuator actuator;
  std::string_view kinematics, radius, rod;
  std::array<double, 3> angles;  ///< deg, where none is stated
};
constexpr std::array<Keys, 2> kKinds{
    {{Actuator::linear, "delta", "delta_radius", "arm_length", {210.0, 330.0, 90.0}},
     {Actuator::revolute, "rotary_delta", "shoulder_radius", "lower_arm_length", {30.0, 150.0, 270.0}}}};
constexpr std::string_view kArm = "upper_arm_length", kShoulder = "shoulder_height";

const Keys& keys_of(Actuator actuator) { return *std::ranges::find(kKinds, actuator, &Keys::actuator); }

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Without a comment: # or ; at the beginning or after a blank.
std::string_view without_comment(std::string_view line) {
  for (std::size_t k = 0; k < line.size(); ++k) {
    const bool marks = line[k] == '#' || line[k] == ';';
    if (marks && (k == 0 || line[k - 1] == ' ' || line[k - 1] == '\t')) return line.substr(0, k);
  }
  return line;
}

std::vector<std::string_view> cut(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t at = text.find(separator); at != std::string_view::npos; at = text.find(separator)) {
    parts.push_back(trimmed(text.substr(0, at)));
    text.remove_prefix(at + 1);
  }
  parts.push_back(trimmed(text));
  return parts;
}

/// Settings by section and key, with the lines where they stand; later ones replace earlier ones, so saved ones win.
class Settings {
 public:
  explicit Settings(const TextFile& file) : file_(file.name) {
    int number = 0;
    std::string section;
    for (std::string_view line : lines_of(file.text)) {
      ++number;
      const bool saved = line.starts_with(kSavedMark);
      if (saved) line.remove_prefix(kSavedMark.size());
      const std::string_view text = trimmed(saved ? line : without_comment(line));
      if (text.starts_with('[') && text.ends_with(']')) {
        section = trimmed(text.substr(1, text.size() - 2));
        continue;
      }
      const std::size_t end = text.find_first_of(":=");
      if (end == std::string_view::npos || section.empty()) continue;
      values_[{section, std::string(trimmed(text.substr(0, end)))}] = {trimmed(text.substr(end + 1)), number};
    }
  }

  [[noreturn]] void fail(int line, const std::string& complaint) const { throw InputFileError(file_, line, complaint); }

  struct Value {
    std::string_view text;
    int line = 0;
  };

  std::optional<Value> find(std::string_view section, std::string_view key) const {
    const auto found = values_.find({std::string(section), std::string(key)});
    return found == values_.end() ? std::nullopt : std::optional(found->second);
  }

  Value require(std::string_view section, std::string_view key) const {
    if (const auto value = find(section, key)) return *value;
    fail(0, fmt::format("expected {} in [{}], got none", key, section));
  }

  double number_of(const Value& value, std::string_view what) const {
    const std::optional<double> number = finite_number(value.text);
    if (!number) fail(value.line, fmt::format("expected a number for {}, got \"{}\"", what, value.text));
    return *number;
  }

  std::optional<double> optional_number(std::string_view section, std::string_view key) const {
    const auto value = find(section, key);
    return value ? std::optional(number_of(*value, key)) : std::nullopt;
  }

  double positive(std::string_view section, std::string_view key) const {
    const Value value = require(section, key);
    const double number = number_of(value, key);
    if (!(number > 0.0)) fail(value.line, fmt::format("expected {} above 0, got {}", key, number));
    return number;
  }

 private:
  std::string file_;
  std::map<std::pair<std::string, std::string>, Value> values_;
};

/// Product of the ratios of "gear_ratio: 80:16, 3:1".
double gear_ratio(const Settings& settings, std::string_view section) {
  const auto value = settings.find(section, "gear_ratio");
  double ratio = 1.0;
  if (!value) return ratio;
  for (const std::string_view pair : cut(value->text, ',')) {
    const std::vector<std::string_view> teeth = cut(pair, ':');
    const double driven = finite_number(teeth.front()).value_or(0.0);
    const double driving = teeth.size() == 2 ? finite_number(teeth.back()).value_or(0.0) : 0.0;
    if (!(driven > 0.0 && driving > 0.0)) {
      settings.fail(value->line, fmt::format("expected gear_ratio as 80:16, got \"{}\"", pair));
    }
    ratio *= driven / driving;
  }
  return ratio;
}

/// Mm or rad a micro-step. Older files state it; newer ones the way a turn of the motor makes, which of an arm is a
/// turn over the gear's ratio.
double step_size(const Settings& settings, std::string_view section, Actuator actuator) {
  constexpr double kUsualSteps = 200.0;
  if (settings.find(section, "step_distance")) return settings.positive(section, "step_distance");
  const double steps = settings.find(section, "full_steps_per_rotation")
                           ? settings.positive(section, "full_steps_per_rotation")
                           : kUsualSteps;
  const bool linear = actuator == Actuator::linear;
  if (!linear) (void)settings.require(section, "gear_ratio");
  const double turn = linear ? settings.positive(section, "rotation_distance") : 2.0 * std::numbers::pi;
  return turn / (steps * settings.positive(section, "microsteps") * gear_ratio(settings, section));
}

/// A key of all towers; of the first, B and C take what they do not state themselves.
std::array<double, 3> like_the_first(const Settings& settings, std::string_view key) {
  const double first = settings.positive(kTowers[0], key);
  std::array<double, 3> values{first, first, first};
  for (std::size_t i = 1; i < 3; ++i) {
    if (settings.find(kTowers[i], key)) values[i] = settings.positive(kTowers[i], key);
  }
  return values;
}

const Keys& kind_of(const Settings& settings) {
  const Settings::Value kinematics = settings.require("printer", "kinematics");
  const auto* kind = std::ranges::find(kKinds, kinematics.text, &Keys::kinematics);
  if (kind == kKinds.end()) {
    settings.fail(kinematics.line,
                  fmt::format("expected kinematics: delta or rotary_delta, got \"{}\"", kinematics.text));
  }
  return *kind;
}

/// The homed nozzle must be within reach of each tower.
void check_endstops(const Settings& settings, const Keys& keys, const DeltaGeometry& geometry) {
  const std::array<double, 3> homed = homed_joints(geometry);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto own = [&](std::string_view key) {
      return settings.require(kTowers[settings.find(kTowers[i], key) ? i : 0], key);
    };
    if (keys.actuator == Actuator::linear && !(geometry.rod[i] > geometry.radius)) {
      settings.fail(own(keys.rod).line, fmt::format("expected {} above {} ({} mm), got {} mm", keys.rod, keys.radius,
                                                    geometry.radius, geometry.rod[i]));
    }
    if (!std::isfinite(homed[i])) {
      settings.fail(own("position_endstop").line,
                    fmt::format("expected position_endstop within reach of the arms, got {} mm", geometry.endstop[i]));
    }
  }
}

DeltaGeometry geometry_of(const Settings& settings) {
  const Keys& keys = kind_of(settings);
  DeltaGeometry geometry{.actuator = keys.actuator};
  geometry.radius = settings.positive("printer", keys.radius);
  geometry.rod = like_the_first(settings, keys.rod);
  geometry.endstop = like_the_first(settings, "position_endstop");
  if (keys.actuator == Actuator::revolute) {
    geometry.arm = like_the_first(settings, kArm);
    geometry.shoulder.fill(settings.positive("printer", kShoulder));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    geometry.tower_angle[i] = to_radians(settings.optional_number(kTowers[i], "angle").value_or(keys.angles[i]));
  }
  check_endstops(settings, keys, geometry);
  return geometry;
}

/// Three step counts below the endstops as drops.
JointDrops drops_of(const Settings& settings, const std::string& key, const std::array<double, 3>& step) {
  const Settings::Value value = settings.require("delta_calibrate", key);
  const std::vector<std::string_view> counts = cut(value.text, ',');
  if (counts.size() != 3) {
    settings.fail(value.line, fmt::format("expected three step counts for {}, got \"{}\"", key, value.text));
  }
  JointDrops drops{};
  for (std::size_t i = 0; i < 3; ++i) drops[i] = step[i] * settings.number_of({counts[i], value.line}, key);
  return drops;
}

DeltaReadings readings_of(const Settings& settings, const DeltaGeometry& geometry, const std::array<double, 3>& step) {
  DeltaReadings readings;
  const auto require_reachable = [&](const JointDrops& drops, const std::string& key) {
    if (nozzle(geometry, drops)) return;
    settings.fail(
        settings.require("delta_calibrate", key).line,
        fmt::format("expected steps that the printer can take for {}, got some where its arms do not meet", key));
  };
  for (const bool by_hand : {false, true}) {
    const std::string_view prefix = by_hand ? "manual_height" : "height";
    for (int k = 0; settings.find("delta_calibrate", fmt::format("{}{}", prefix, k)); ++k) {
      const std::string key = fmt::format("{}{}", prefix, k), place = key + "_pos";
      readings.heights.push_back(
          {*settings.optional_number("delta_calibrate", key), drops_of(settings, place, step), by_hand});
      require_reachable(readings.heights.back().drops, place);
    }
  }
  for (int k = 0; settings.find("delta_calibrate", fmt::format("distance{}", k)); ++k) {
    const std::string key = fmt::format("distance{}", k), from = key + "_pos1", to = key + "_pos2";
    readings.distances.push_back(
        {settings.positive("delta_calibrate", key), drops_of(settings, from, step), drops_of(settings, to, step)});
    require_reachable(readings.distances.back().from, from);
    require_reachable(readings.distances.back().to, to);
  }
  return readings;
}

}  // namespace

KlipperDelta read_klipper(const TextFile& file) {
  const Settings settings(file);
  KlipperDelta printer;
  printer.geometry = geometry_of(settings);
  for (std::size_t i = 0; i < 3; ++i) {
    printer.step_size[i] = step_size(settings, kTowers[i], printer.geometry.actuator);
  }
  printer.readings = readings_of(settings, printer.geometry, printer.step_size);
  if (const auto radius = settings.optional_number("printer", "print_radius")) printer.print_radius = *radius;
  return printer;
}

std::string klipper_save_config(const DeltaGeometry& geometry) {
  const Keys& keys = keys_of(geometry.actuator);
  const bool rotary = keys.actuator == Actuator::revolute;
  std::string text = fmt::format("#*# [printer]\n#*# {} = {:.6f}\n", keys.radius, geometry.radius);
  if (rotary) {
    const double shoulder = (geometry.shoulder[0] + geometry.shoulder[1] + geometry.shoulder[2]) / 3.0;
    text += fmt::format("#*# {} = {:.6f}\n", kShoulder, shoulder);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    text += fmt::format("#*#\n#*# [{}]\n#*# angle = {:.6f}\n", kTowers[i], to_degrees(geometry.tower_angle[i]));
    if (rotary) text += fmt::format("#*# {} = {:.6f}\n", kArm, geometry.arm[i]);
    text +=
        fmt::format("#*# {} = {:.6f}\n#*# position_endstop = {:.6f}\n", keys.rod, geometry.rod[i], geometry.endstop[i]);
  }
  return text;
}

}  // namespace paracal::io
