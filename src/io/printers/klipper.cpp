#include "paracal/io/klipper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>

#include "io/tables/columns.hpp"
#include "klipper_settings.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

using Settings = KlipperSettings;

constexpr std::array<std::string_view, 3> kSteppers{"stepper_a", "stepper_b", "stepper_c"};

/// How the keys of one kind of delta are called.
struct Keys {
  Actuator actuator;
  std::string_view kinematics, radius, rod;
  std::array<double, 3> angles;  ///< deg, where none is stated
};
constexpr std::array<Keys, 2> kKinematics{
    {{Actuator::linear, "delta", "delta_radius", "arm_length", {210.0, 330.0, 90.0}},
     {Actuator::revolute, "rotary_delta", "shoulder_radius", "lower_arm_length", {30.0, 150.0, 270.0}}}};
constexpr std::string_view kArm = "upper_arm_length", kShoulder = "shoulder_height";

const Keys& keys_of(Actuator actuator) { return *std::ranges::find(kKinematics, actuator, &Keys::actuator); }

double in_range(const Settings::Value& value, std::string_view key, double number, const plausible::Range& range) {
  if (const auto complaint = plausible::complaint(key, number, range)) Settings::fail(value, *complaint);
  return number;
}

double positive(const Settings& settings, std::string_view section, std::string_view key) {
  const double number = settings.positive(section, key);
  return in_range(settings.require(section, key), key, number, plausible::kPositiveOfPrinter);
}

std::optional<double> optional_number(const Settings& settings, std::string_view section, std::string_view key,
                                      const plausible::Range& range) {
  const auto value = settings.find(section, key);
  return value ? std::optional(in_range(*value, key, Settings::number_of(*value, key), range)) : std::nullopt;
}

/// Product of the ratios of "gear_ratio: 80:16, 3:1".
double gear_ratio(const Settings& settings, std::string_view section) {
  const auto value = settings.find(section, "gear_ratio");
  double ratio = 1.0;
  if (!value) return ratio;
  for (const std::string_view pair : cut(value->text, ',')) {
    const std::vector<std::string_view> teeth = cut(pair, ':');
    const double driven = finite_number(teeth.front()).value_or(0.0);
    const double driving = teeth.size() == 2 ? finite_number(teeth.back()).value_or(0.0) : 0.0;
    if (!(driven > 0.0 && driving > 0.0 && std::max(driven, driving) <= plausible::kPrinter.most)) {
      Settings::fail(*value, fmt::format("expected gear_ratio like 80:16, got \"{}\"", pair));
    }
    ratio *= driven / driving;
  }
  return ratio;
}

/// Mm or rad a micro-step. Older files state it; newer ones the way a turn of the motor makes, which of an arm is a
/// turn over the gear's ratio.
double step_size(const Settings& settings, std::string_view section, Actuator actuator) {
  constexpr double kUsualSteps = 200.0;
  if (settings.find(section, "step_distance")) return positive(settings, section, "step_distance");
  const double steps = settings.find(section, "full_steps_per_rotation")
                           ? positive(settings, section, "full_steps_per_rotation")
                           : kUsualSteps;
  const bool linear = actuator == Actuator::linear;
  if (!linear) (void)settings.require(section, "gear_ratio");
  const double turn = linear ? positive(settings, section, "rotation_distance") : 2.0 * std::numbers::pi;
  return turn / (steps * positive(settings, section, "microsteps") * gear_ratio(settings, section));
}

/// A key of all towers; of the first, B and C take what they do not state themselves.
std::array<double, 3> like_the_first(const Settings& settings, std::string_view key) {
  const double first = positive(settings, kSteppers[0], key);
  std::array<double, 3> values{first, first, first};
  for (std::size_t i = 1; i < 3; ++i) {
    if (settings.find(kSteppers[i], key)) values[i] = positive(settings, kSteppers[i], key);
  }
  return values;
}

const Keys& kind_of(const Settings& settings) {
  const Settings::Value kinematics = settings.require("printer", "kinematics");
  const auto* kind = std::ranges::find(kKinematics, kinematics.text, &Keys::kinematics);
  if (kind == kKinematics.end()) {
    Settings::fail(kinematics, fmt::format("expected kinematics: delta or rotary_delta, got \"{}\"", kinematics.text));
  }
  return *kind;
}

/// The homed nozzle must be within reach of each tower.
void check_endstops(const Settings& settings, const Keys& keys, const DeltaGeometry& geometry) {
  const std::array<double, 3> homed = homed_joints(geometry);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto own = [&](std::string_view key) {
      return settings.require(kSteppers[settings.find(kSteppers[i], key) ? i : 0], key);
    };
    if (keys.actuator == Actuator::linear && !(geometry.rod[i] > geometry.radius)) {
      Settings::fail(own(keys.rod), fmt::format("expected {} above {} ({} mm), got {} mm", keys.rod, keys.radius,
                                                geometry.radius, geometry.rod[i]));
    }
    if (!std::isfinite(homed[i])) {
      Settings::fail(own("position_endstop"),
                     fmt::format("expected a position_endstop that the arms reach, got {} mm", geometry.endstop[i]));
    }
  }
}

DeltaGeometry geometry_of(const Settings& settings) {
  const Keys& keys = kind_of(settings);
  DeltaGeometry geometry{.actuator = keys.actuator};
  geometry.radius = positive(settings, "printer", keys.radius);
  geometry.rod = like_the_first(settings, keys.rod);
  geometry.endstop = like_the_first(settings, "position_endstop");
  if (keys.actuator == Actuator::revolute) {
    geometry.arm = like_the_first(settings, kArm);
    geometry.shoulder.fill(positive(settings, "printer", kShoulder));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    geometry.tower_angle[i] =
        to_radians(optional_number(settings, kSteppers[i], "angle", plausible::kAngle).value_or(keys.angles[i]));
  }
  check_endstops(settings, keys, geometry);
  return geometry;
}

/// Three step counts below the endstops as drops, of a reading that stands under another key.
JointDrops drops_of(const Settings& settings, const std::string& key, const std::string& place,
                    const DeltaGeometry& geometry, const std::array<double, 3>& step) {
  const Settings::Value of = settings.require("delta_calibrate", key);
  const Settings::Value value = settings.find("delta_calibrate", place).value_or(of);
  if (value.text.data() == of.text.data()) Settings::fail(of, fmt::format("expected {} with {}, got none", place, key));
  const std::vector<std::string_view> counts = cut(value.text, ',');
  if (counts.size() != 3) {
    Settings::fail(value, fmt::format("expected three step counts for {}, got \"{}\"", place, value.text));
  }
  const bool rotary = geometry.actuator == Actuator::revolute;
  const double most = rotary ? 2.0 * std::numbers::pi : plausible::length(reach(geometry)).most;
  JointDrops drops{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double steps = Settings::number_of({counts[i], value.file, value.line}, place);
    drops[i] =
        step[i] * in_range(value, place, steps, {-most / step[i], most / step[i], "steps", "as far as a joint moves"});
  }
  return drops;
}

DeltaReadings readings_of(const Settings& settings, const DeltaGeometry& geometry, const std::array<double, 3>& step) {
  DeltaReadings readings;
  const auto require_reachable = [&](const JointDrops& drops, const std::string& key) {
    if (nozzle(geometry, drops)) return;
    Settings::fail(
        settings.require("delta_calibrate", key),
        fmt::format("expected steps for {} that the printer can reach, got steps where its arms do not meet", key));
  };
  for (const bool by_hand : {false, true}) {
    const std::string_view prefix = by_hand ? "manual_height" : "height";
    for (int k = 0; settings.find("delta_calibrate", fmt::format("{}{}", prefix, k)); ++k) {
      const std::string key = fmt::format("{}{}", prefix, k), place = key + "_pos";
      const auto height = optional_number(settings, "delta_calibrate", key, plausible::length(reach(geometry)));
      readings.heights.push_back({*height, drops_of(settings, key, place, geometry, step), by_hand});
      require_reachable(readings.heights.back().drops, place);
    }
  }
  for (int k = 0; settings.find("delta_calibrate", fmt::format("distance{}", k)); ++k) {
    const std::string key = fmt::format("distance{}", k), from = key + "_pos1", to = key + "_pos2";
    const plausible::Range range{PrintedDistance::kShortest, plausible::length(reach(geometry)).most, "mm"};
    readings.distances.push_back({*optional_number(settings, "delta_calibrate", key, range),
                                  drops_of(settings, key, from, geometry, step),
                                  drops_of(settings, key, to, geometry, step)});
    require_reachable(readings.distances.back().from, from);
    require_reachable(readings.distances.back().to, to);
  }
  return readings;
}

/// A number of a geometry by the section and key that hold it.
struct Entry {
  std::string_view section, key;
  double value = 0.0;
};

std::vector<Entry> entries_of(const DeltaGeometry& geometry) {
  const Keys& keys = keys_of(geometry.actuator);
  const bool rotary = keys.actuator == Actuator::revolute;
  std::vector<Entry> entries{{"printer", keys.radius, geometry.radius}};
  if (rotary) entries.push_back({"printer", kShoulder, mean_of(geometry.shoulder)});
  for (std::size_t i = 0; i < 3; ++i) {
    entries.push_back({kSteppers[i], "angle", to_degrees(geometry.tower_angle[i])});
    if (rotary) entries.push_back({kSteppers[i], kArm, geometry.arm[i]});
    entries.push_back({kSteppers[i], keys.rod, geometry.rod[i]});
    entries.push_back({kSteppers[i], "position_endstop", geometry.endstop[i]});
  }
  return entries;
}

/// Readings behind a gap in the numbers: the firmware stops there, and so does what is read here.
std::vector<std::string> passed_over(const Settings& settings) {
  constexpr int kMost = 1000;
  std::vector<std::string> notes;
  for (const char* prefix : {"height", "manual_height", "distance"}) {
    const auto found = [&](int k) { return settings.find("delta_calibrate", fmt::format("{}{}", prefix, k)); };
    int gap = 0;
    while (found(gap)) ++gap;
    int behind = 0;
    for (int k = gap + 1; k < kMost; ++k) behind += found(k) ? 1 : 0;
    if (behind == 0) continue;
    notes.push_back(
        fmt::format("{}: {}{} is missing: {} later readings are ignored, as in the firmware; renumber them to use them",
                    settings.files().front().name, prefix, gap, behind));
  }
  return notes;
}

std::vector<std::string> notes_of(const Settings& settings, const DeltaGeometry& geometry) {
  std::vector<std::string> notes = passed_over(settings);
  for (const Entry& one : entries_of(geometry)) {
    const auto saved = settings.overridden(one.section, one.key);
    if (!saved) continue;
    const Settings::Value typed = settings.require(one.section, one.key);
    notes.push_back(
        fmt::format("{}:{}: {} {} of [{}] is in force, because a typed line overrides the saved {} (line {})",
                    typed.file->name, typed.line, one.key, typed.text, one.section, saved->text, saved->line));
  }
  if (const auto& unread = settings.unread_block()) {
    notes.push_back(
        fmt::format("{}:{}: Klipper ignores the whole SAVE_CONFIG block because of this line: {}. Only its readings of "
                    "DELTA_CALIBRATE are used. Correct the line and restart the firmware before you save values",
                    settings.files().front().name, unread->line, unread->why));
  }
  for (const Settings::Value& one : settings.missing()) {
    notes.push_back(fmt::format(
        "{}:{}: the included {} is missing here; if it states the geometry of the printer, calibrate with that file",
        one.file->name, one.line, one.text));
  }
  return notes;
}

/// Lines of the SAVE_CONFIG block: section by section.
std::string block_lines(const std::vector<Entry>& entries) {
  std::string text;
  std::string_view section;
  for (const Entry& one : entries) {
    if (one.section != section) text += fmt::format("{}#*# [{}]\n", section.empty() ? "" : "#*#\n", one.section);
    section = one.section;
    text += fmt::format("#*# {} = {:.9f}\n", one.key, one.value);
  }
  return text;
}

constexpr std::string_view kBlockHead =
    "\n#*# <---------------------- SAVE_CONFIG ---------------------->\n"
    "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n#*#\n";

}  // namespace

KlipperDelta read_klipper(const TextFile& file) {
  const Settings settings(file);
  KlipperDelta printer;
  for (const TextFile& one : settings.files()) printer.files.push_back({one.name, sha256(one)});
  printer.geometry = geometry_of(settings);
  printer.notes = notes_of(settings, printer.geometry);
  for (std::size_t i = 0; i < 3; ++i) {
    printer.step_size[i] = step_size(settings, kSteppers[i], printer.geometry.actuator);
  }
  printer.readings = readings_of(settings, printer.geometry, printer.step_size);
  if (settings.find("printer", "print_radius")) printer.print_radius = positive(settings, "printer", "print_radius");
  if (settings.find("delta_calibrate", "radius")) (void)positive(settings, "delta_calibrate", "radius");  // refuses nan
  return printer;
}

std::string klipper_save_config(const DeltaGeometry& geometry) { return block_lines(entries_of(geometry)); }

std::string klipper_config(const TextFile& file, const DeltaGeometry& geometry) {
  const Settings settings(file);
  const TextFile& own = settings.files().front();
  if (const auto& unread = settings.unread_block()) {
    Settings::fail(
        {{}, &own, unread->line},
        fmt::format("expected a SAVE_CONFIG block that Klipper reads; it ignores the whole block because of this "
                    "line: {}. Correct the line first",
                    unread->why));
  }
  std::map<std::size_t, std::pair<std::size_t, std::string>> changes;  // by place: length, and what stands there then
  std::vector<Entry> unstated;
  for (const Entry& one : entries_of(geometry)) {
    const auto value = settings.find(one.section, one.key);
    if (!value) {
      unstated.push_back(one);
    } else if (value->file != &own) {
      Settings::fail(*value, fmt::format("expected {} of [{}] in {}, got it here: change it to {:.9f} by hand", one.key,
                                         one.section, own.name, one.value));
    } else {
      changes[static_cast<std::size_t>(value->text.data() - own.text.data())] = {value->text.size(),
                                                                                 fmt::format("{:.9f}", one.value)};
    }
  }
  std::string text;
  std::size_t done = 0;
  for (const auto& [place, change] : changes) {
    text.append(own.text, done, place - done).append(change.second);
    done = place + change.first;
  }
  text.append(own.text, done);
  if (unstated.empty()) return text;
  if (!text.empty() && text.back() != '\n') text += '\n';
  const bool has_block = std::ranges::any_of(lines_of(own.text), [](auto line) { return line.starts_with("#*#"); });
  return text + (has_block ? "#*#\n" : std::string(kBlockHead)) + block_lines(unstated);
}

}  // namespace paracal::io
