#include "export_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "embedded.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/version.hpp"
#include "variants.hpp"

namespace paracal {

std::string harmless(std::string text) {
  const auto is_harmful = [](unsigned char c) {
    return std::isprint(c) == 0 || c == '"' || c == '\\' || c == '*' || c == '?' || c == '$';
  };
  std::ranges::replace_if(text, is_harmful, '_');
  return text;
}

namespace compensation_detail {
namespace {

std::string_view export_template(std::string_view name) {
  const auto files = detail::export_templates();
  const auto found = std::ranges::find(files, name, &detail::EmbeddedFile::name);
  if (found == files.end()) throw std::logic_error(fmt::format("no template {} is built in", name));
  return found->text;
}

/// What `times` runs do, turns by their series included.
void add(OperationCount& sum, const Procedure& procedure, const RecordedMachine& recorded, std::size_t times) {
  const auto add_one = [&](const OperationCount& one, std::size_t count) {
    sum.additions += count * one.additions;
    sum.multiplications += count * one.multiplications;
    sum.divisions += count * one.divisions;
    sum.square_roots += count * one.square_roots;
    sum.functions += count * one.functions;
  };
  const OperationCount one = procedure.count();
  add_one(one, times);
  add_one(recorded.turn_cosine.count(), times * one.turns / 2);
  add_one(recorded.turn_sine.count(), times * one.turns / 2);
}

std::string brief(const OperationCount& count, std::string_view functions) {
  return fmt::format("{} additions, {} multiplications, {} divisions, {} square roots, {} {}", count.additions,
                     count.multiplications, count.divisions, count.square_roots, count.functions, functions);
}

}  // namespace

std::string filled_template(std::string_view name, const Values& values) {
  std::string_view text = export_template(name);
  std::string result;
  for (std::size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$')) {
    const std::size_t end = text.find('$', at + 1);
    const std::string_view key = text.substr(at + 1, end - at - 1);
    result += text.substr(0, at);
    const auto value = std::ranges::find(values, key, &Values::value_type::first);
    if (value == values.end()) throw std::logic_error(fmt::format("template {}: nothing is known for {}", name, key));
    result += value->second;
    text.remove_prefix(end + 1);
  }
  return result.append(text);
}

namespace {

/// Further lines of a comment, each behind what begins its lines.
std::string remarks(const ExportOrigin& origin, std::string_view begin) {
  std::string text;
  for (const std::string& one : origin.remarks) text.append("\n").append(begin).append(harmless(one));
  return text;
}

/// The unit of all joints, or of either kind.
std::string joint_units(const Robot& robot) {
  const std::vector<Actuator> kinds = kinds_of(robot.limbs());
  const auto in_mm = [](Actuator kind) { return joint_unit(kind) == Unit::mm; };
  const auto lengths = std::ranges::count_if(kinds, in_mm);
  if (lengths == 0) return "rad";
  return std::cmp_equal(lengths, kinds.size()) ? "mm" : "rad or mm";
}

/// "a plate free in x, y on 2 limbs".
std::string plate_in_words(const Robot& robot) {
  if (robot.is_level()) return fmt::format("a plate that {} parallelograms keep level", robot.limb_count());
  const PlateFreedoms& freedoms = robot.freedoms();
  const std::string plate = freedoms.are_all() ? "a plate" : fmt::format("a plate free in {}", in_words(freedoms));
  return fmt::format("{} on {} limbs", plate, robot.limb_count());
}

/// What a variant leaves, and on which poses it was measured.
std::string worst_in_words(const ExportedMachine& exported) {
  const double micrometres = 1e3 * exported.worst;
  const std::string poses = fmt::format("at {} poses of the workspace", kVariantPoses);
  if (micrometres < 1e-3) return "below 0.001 um " + poses;
  return fmt::format("at most {:.2g} um {}, against the exact method", micrometres, poses);
}

std::string method_without_drives(const ExportedMachine& exported) {
  const std::string exact = "inverse of the identified machine with all its errors";
  if (!exported.searches()) return fmt::format("exact: {}, in closed form", exact);
  switch (exported.variant) {
    case ExportVariant::one_step:
      return "one step: closed form, then one step of the search for the tilt";
    case ExportVariant::single:
      return fmt::format("float: closed form in double, then {} steps for the tilt in float", kSingleSteps);
    default:
      return fmt::format("exact: {}; at most {} steps for the tilt", exact, closure::kMostSteps);
  }
}

std::string method_in_words(const ExportedMachine& exported) {
  return method_without_drives(exported) + (exported.is_even() ? "" : "; uneven drives included");
}

/// What one compensation computes, as a sentence.
std::string operations(const ExportedMachine& exported) {
  const RecordedMachine& recorded = exported.recorded;
  OperationCount count;
  add(count, recorded.closed, recorded, 1);
  const std::string_view functions = "sines, cosines and arctangents";
  const std::string drives = exported.is_even()
                                 ? ""
                                 : fmt::format("; uneven drives: about 3 steps a joint, at most {}, of {} cubics each",
                                               kMostDriveSteps, kDriveKnots);
  if (!exported.searches()) return brief(count, functions) + " per call" + drives;
  const int steps = usual_steps(exported.variant);
  add(count, recorded.answer, recorded, 1);
  add(count, recorded.step, recorded, static_cast<std::size_t>(steps));
  const bool varies = exported.variant == ExportVariant::exact;
  return fmt::format("{} per call with {} step{}{}", brief(count, functions), steps, steps == 1 ? "" : "s",
                     varies ? ", the usual number" : "") +
         drives;
}

}  // namespace

Values head(const Robot& robot, const ExportOrigin& origin) {
  const std::string unit = joint_units(robot);
  return {{"PROGRAM", fmt::format("paracal {}", version())},
          {"ROBOT", harmless(robot.name())},
          {"CALIBRATION", harmless(origin.calibration)},
          {"SHA256", origin.sha256},
          {"DATE", origin.date},
          {"C_REMARKS", remarks(origin, " *   ")},
          {"ST_REMARKS", remarks(origin, "   ")},
          {"HAL_REMARKS", remarks(origin, "#   ")},
          {"PLAIN_REMARKS", remarks(origin, "")},
          {"LIMBS", std::to_string(robot.limb_count())},
          {"LAST_JOINT", std::to_string(robot.limb_count() - 1)},
          {"JOINT_UNIT", unit},
          {"SHOWN_JOINT_UNIT", unit == "rad"  ? "deg"
                               : unit == "mm" ? "mm"
                                              : "deg or mm"},
          {"SERIES_REACH", decimal(closure::kSeriesReach)},
          {"MOST_STEPS", std::to_string(closure::kMostSteps)},
          {"SETTLED", decimal(closure::kSettled<double>)}};
}

void add_head(const Robot& robot, const ExportedMachine& exported, Values& values) {
  const std::size_t free = exported.places.size();
  const bool is_exact = !exported.searches() || exported.variant == ExportVariant::exact;
  const bool in_mm = joint_units(robot) == "mm";
  // What a variant leaves, in the poses that are found from joints, and in the joints; arms are longer than 100 mm.
  const double slack = is_exact ? 0.0 : 4.0 * exported.worst;
  const double joint_slack = joint_units(robot) == "rad" ? 0.01 * slack : slack;
  values.emplace_back("PLATE", plate_in_words(robot));
  values.emplace_back("METHOD", method_in_words(exported));
  values.emplace_back("WORST", worst_in_words(exported));
  values.emplace_back("OPERATIONS", operations(exported));
  values.emplace_back("RATES_ERROR",
                      exported.searches()
                          ? fmt::format("of the closed form: within {:.1g} of the largest of a coordinate",
                                        2.0 * rate_error(robot, exported.machine))
                          : "exact");
  values.emplace_back("FREE", std::to_string(free));
  values.emplace_back("NUMBERS", std::to_string(exported.set.numbers.size()));
  values.emplace_back("LAYOUT", decimal(exported.set.layout));
  values.emplace_back("DRIVES_AT", std::to_string(exported.drives_at()));
  values.emplace_back("KNOTS", std::to_string(kDriveKnots));
  values.emplace_back("DRIVE", std::to_string(kCurveNumbers));
  values.emplace_back("MOST_DRIVE_STEPS", std::to_string(kMostDriveSteps));
  values.emplace_back("STEEPEST", decimal(kSteepestDrive));
  values.emplace_back("TESTS", std::to_string(exported.cases.size()));
  values.emplace_back("AGREEMENT", exported.machine.spare_limbs() == 0 ? decimal(1e-6 + joint_slack)
                                   : in_mm                             ? "1.0"
                                                                       : "0.01");
  values.emplace_back("SMALLEST_STEP", decimal(1e-9 + slack));
  values.emplace_back("JOINT_TOLERANCE", decimal((in_mm ? 2e-9 : 3.4e-11) + joint_slack));
  values.emplace_back("POSE_TOLERANCE", decimal(1e-6 + slack));
}

ExportedMachine::ExportedMachine(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                                 const DriveCurves& drives)
    : machine(built_for_export(robot, errors)),
      variant(origin.variant),
      curves(compensator_parameters(robot, errors, drives).drives),
      cases(self_test(robot, machine, drives)),
      recorded(record(machine)),
      set(parameter_set(recorded, robot.nominal(), curves)),
      places(commanded_coordinates(machine)),
      worst(variant_error(robot, machine, variant)) {}

std::string coordinate_name(const Machine& machine, std::size_t place) {
  constexpr std::array kNames{"x_mm", "y_mm", "z_mm", "tilt_x_rad", "tilt_y_rad", "tilt_z_rad", "phi_rad"};
  return kNames.at(among_seven(machine, place));
}

std::string decimal(double value) {
  constexpr double kNothing = 1e-30;  // rounding's, of a coordinate that is 0: below the range of REAL it is refused
  if (std::abs(value) < kNothing) value = 0.0;
  std::string text = fmt::format("{}", value);
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos) text.insert(std::min(exponent, text.size()), ".0");
  std::ranges::replace(text, 'e', 'E');
  return text;
}

}  // namespace compensation_detail
}  // namespace paracal
