#include "paracal/compensation/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "export_text.hpp"
#include "paracal/error.hpp"
#include "single_rods.hpp"

namespace paracal {
namespace {

using namespace compensation_detail;

template <std::size_t Size>
std::string braced(const std::array<double, Size>& numbers, std::size_t count = Size) {
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < count; ++k) texts.push_back(decimal(numbers[k]));
  return fmt::format("{{{}}}", fmt::join(texts, ", "));
}

std::string limb_constants(const CompensatorParameters<double>& parameters) {
  std::string text;
  for (std::size_t i = 0; i < parameters.limb_count; ++i) {
    const CompensatorLimb<double>& limb = parameters.identified[i];
    text += fmt::format(
        "    {{{},\n     {},\n     {},\n     {},\n     {},\n     {},\n     {},\n     {},\n     {},\n     {},\n"
        "     {},\n     {}}},\n",
        braced(limb.base), braced(limb.radial), braced(limb.normal), braced(limb.axis), braced(limb.plate),
        braced(limb.slide), braced(limb.elbow_half), braced(limb.plate_half), braced(limb.rod), decimal(limb.arm),
        decimal(limb.joint_offset), decimal(limb.joint_per_mm));
  }
  return text;
}

/// The members of a limb as C has them.
std::string members(const Limb& limb) {
  std::string text;
  for (const LimbConstant& one : constants_of(limb)) {
    text += fmt::format("  double {}{}; /* {} */\n", one.name,
                        one.values.size() == 1 ? "" : fmt::format("[{}]", one.values.size()), one.what);
  }
  return text;
}

std::string initializers(const Machine& machine) {
  const auto value = [](const LimbConstant& one) {
    if (one.values.size() == 1) return decimal(one.values[0]);
    return braced(std::array{one.values[0], one.values[1], one.values[2]});
  };
  std::string text;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    std::vector<std::string> values;
    for (const LimbConstant& one : constants_of(machine.limbs[i])) values.push_back(value(one));
    text += fmt::format("    {{{}}},\n", fmt::join(values, ",\n     "));
  }
  return text;
}

/// Poses as the language takes them, x, y, z and phi or three tilts.
std::string test_vector(const std::vector<SelfTestCase>& cases, bool tilts) {
  std::string text;
  for (const auto& [pose, joints] : cases) {
    const Eigen::Vector3d &r = pose.position, &turn = pose.tilt;
    std::array numbers{r.x(), r.y(), r.z(), tilts ? turn.x() : pose.rotation, turn.y(), turn.z()};
    std::array<double, kMaxLimbs> found{};
    std::ranges::copy(joints, found.begin());
    text += fmt::format("    {{{}, {}}},\n", braced(numbers, tilts ? 6 : 4),
                        braced(found, static_cast<std::size_t>(joints.size())));
  }
  return text;
}

/// C99, which has NaN for what has no answer.
class C99 : public Language {
 public:
  bool states_precedence() const override { return true; }

  std::string number(double value) const override { return decimal(value); }

  std::string symbol(const Symbol& symbol) const override {
    std::string text(symbol.name);
    if (symbol.limb >= 0) text = fmt::format("limb[{}].{}", symbol.limb, text);
    return symbol.index < 0 ? text : fmt::format("{}[{}]", text, symbol.index);
  }

  FunctionNames functions() const override {
    return {.square_root = "sqrt", .sine = "sin", .cosine = "cos", .arctangent = "atan2"};
  }

  std::string choice(const std::string& number, const std::string& negative, const std::string& other) const override {
    return fmt::format("(({} < 0.0) ? {} : {})", number, negative, other);
  }

  std::string define(const std::string& local, const std::string& formula) const override {
    return fmt::format("const double {} = {};", local, formula);
  }

  std::string assign(const std::string& target, const std::string& formula) const override {
    return fmt::format("{} = {};", target, formula);
  }

  std::string guard_root(const std::string&) const override { return {}; }
  std::string guard_divisor(const std::string&) const override { return {}; }
};

std::string settle_functions(const RecordedMachine& recorded, Values values) {
  const C99 language;
  values.emplace_back("STATE_SIZE", std::to_string(recorded.state_size));
  values.emplace_back("ANSWER_SIZE", std::to_string(recorded.answer_size));
  values.emplace_back("TURN_COSINE", recorded.turn_cosine.text(language, "    "));
  values.emplace_back("TURN_SINE", recorded.turn_sine.text(language, "    "));
  values.emplace_back("ANSWER", recorded.answer.text(language, "  "));
  values.emplace_back("STEP", recorded.step.text(language, "  "));
  return filled_template("settle_c99.h", values);
}

/// "struts", and what closes a limb of them.
std::pair<std::string_view, std::string_view> limbs_in_words(Actuator actuator) {
  switch (actuator) {
    case Actuator::crank:
      return {"rods on arms", "|r + R plate - base - arm (cos(joint + zero) u + sin(joint + zero) v)| = rod"};
    case Actuator::carriage:
      return {"rods on carriages", "|r + R plate - base - (zero + growth joint) v| = rod"};
    default:
      return {"struts", "|r + R plate - base| = length + growth joint"};
  }
}

/// "a plate on six struts", "a plate free in x, y on 2 rods on arms".
std::string plate_in_words(const Robot& robot) {
  const std::string_view limbs = limbs_in_words(robot.actuator()).first;
  const PlateFreedoms& freedoms = robot.geometry().freedoms;
  if (freedoms.are_all()) return fmt::format("a plate on six {}", limbs);
  return fmt::format("a plate free in {} on {} {}", in_words(freedoms), robot.limb_count(), limbs);
}

Values of_single_rods(const Robot& robot, const ExportOrigin& origin) {
  const bool in_mm = joint_unit(robot.actuator()) == Unit::mm;
  Values values = head(robot, origin);
  values.emplace_back("PLATE", plate_in_words(robot));
  values.emplace_back("EQUATION", limbs_in_words(robot.actuator()).second);
  values.emplace_back("SHOWN_JOINT", in_mm ? "1.0" : "PARACAL_DEGREES");
  values.emplace_back("ARCTANGENT", in_mm ? "" : "double atan2(double y, double x);\n");
  return values;
}

/// What of a pose is free, and what is made sure of the rest.
void add_guides(const Machine& machine, Values& values) {
  const auto& free = machine.freedoms.free;
  std::vector<std::string> places, held, where;
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k]) places.push_back(std::to_string(k));
    held.emplace_back(free[k] ? "0" : "1");
    where.push_back(decimal(k == 2 && !free[k] ? machine.guided_z : 0.0));
  }
  const bool guided = machine.has_guides;
  const std::string constants = fmt::format(
      "/* Coordinates that the guides fix, and their values, mm and rad: other poses are unreachable. */\n"
      "static const int paracal_is_held[6] = {{{}}};\nstatic const double paracal_held[6] = {{{}}};\n\n",
      fmt::join(held, ", "), fmt::join(where, ", "));
  const std::string check =
      "    if ((paracal_is_held[i] != 0) && (paracal_abs(pose[i] - paracal_held[i]) > 1.0E-6)) { return "
      "PARACAL_UNREACHABLE; }\n";
  const std::string start = "    if (paracal_is_held[k] != 0) { at[k] = paracal_held[k]; }\n";
  values.emplace_back("FREE", fmt::format("{}", fmt::join(places, ", ")));
  values.emplace_back("ROW_COUNT", std::to_string(places.size() * places.size()));
  values.emplace_back("GUIDE_CONSTANTS", guided ? constants : "");
  values.emplace_back("GUIDE_CHECK", guided ? check : "");
  values.emplace_back("GUIDE_START", guided ? start : "");
}

void check_exported(const Robot& robot) {
  if (has_compensator(robot)) return;
  throw InvalidArgument(fmt::format(
      "export: expected limbs of one kind, as many as the plate has degrees of freedom, with one rod each or "
      "three or four parallelograms, got {}: write corrected targets with paracal compensate --targets",
      robot.name()));
}

std::string single_rod_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  check_exported(robot);
  const Machine machine = build(robot, errors);
  const RecordedRods recorded = record_single_rods(machine);
  const std::vector<SelfTestCase> cases = single_rod_self_test(robot, machine);
  const C99 language;
  Values values = of_single_rods(robot, origin);
  add_guides(machine, values);
  values.emplace_back("OPERATIONS", operations(recorded.joints, robot.actuator()));
  values.emplace_back("LIMB_MEMBERS", members(machine.limbs[0]));
  values.emplace_back("LIMB_CONSTANTS", initializers(machine));
  values.emplace_back("JOINTS", recorded.joints.text(language, "  "));
  values.emplace_back("ROWS", recorded.rows.text(language, "  "));
  values.emplace_back("TESTS", std::to_string(cases.size()));
  values.emplace_back("TEST_VECTOR", test_vector(cases, true));
  return filled_template("single_rods_c99.h", values);
}

/// An axis of LinuxCNC as a coordinate of the plate, or of nothing that the robot moves.
struct Axis {
  std::string_view letter, place, what;
};
constexpr std::array<Axis, 9> kAxes{{{"x", "tran.x", "commanded position of the plate's origin, mm"},
                                     {"y", "tran.y", "and y"},
                                     {"z", "tran.z", "and z"},
                                     {"a", "a", "commanded tilt_x of the plate, deg"},
                                     {"b", "b", "commanded tilt_y, deg"},
                                     {"c", "c", "commanded tilt_z, deg"},
                                     {"u", "u", ""},
                                     {"v", "v", ""},
                                     {"w", "w", ""}}};

/// "A, B and C turn the plate: R = Rot(x, A) Rot(y, B) Rot(z, C)", as far as they do.
std::string turns_in_words(const PlateFreedoms& freedoms) {
  std::string text;
  for (std::size_t k = 3; k < 6; ++k) {
    if (freedoms.free[k]) text += fmt::format("{}Rot({}, {})", text.empty() ? "" : " ", "xyz"[k - 3], "ABC"[k - 3]);
  }
  return text.empty() ? "no axis turns the plate" : "the plate is turned by R = " + text;
}

/// How the component takes poses from axes, and leaves to joints of their own what the robot does not move.
void add_axes(const Robot& robot, Values& values) {
  const PlateFreedoms& freedoms = robot.geometry().freedoms;
  std::string pins, of_pins, of_world, to_world, others_of_world, world_of_others;
  std::vector<std::string> others;
  for (std::size_t k = 0; k < kAxes.size(); ++k) {
    const auto& [letter, place, what] = kAxes[k];
    if (k >= 6 || !freedoms.free[k]) {
      const std::size_t joint = robot.limb_count() + others.size();
      others_of_world += fmt::format("  joints[{}] = world->{};\n", joint, place);
      world_of_others += fmt::format("  world->{} = joints[{}];\n", place, joint);
      others.emplace_back(1, static_cast<char>(std::toupper(letter[0])));
      continue;
    }
    const bool turns = k >= 3;
    pins += fmt::format("pin in float command.{} \"{}\";\n", letter, what);
    of_pins += fmt::format("  pose[{}] = command_{}{};\n", k, letter, turns ? " / PARACAL_DEGREES" : "");
    of_world += fmt::format("  pose[{}] = world->{}{};\n", k, place, turns ? " / PARACAL_DEGREES" : "");
    to_world += fmt::format("  world->{} = pose[{}]{};\n", place, k, turns ? " * PARACAL_DEGREES" : "");
  }
  values.emplace_back("TURNS", turns_in_words(freedoms));
  values.emplace_back("OTHER_AXES", fmt::format("{}", fmt::join(others, ", ")));
  values.emplace_back("PINS", pins);
  values.emplace_back("POSE_OF_PINS", of_pins);
  values.emplace_back("POSE_OF_WORLD", of_world);
  values.emplace_back("WORLD_OF_POSE", to_world);
  values.emplace_back("OTHERS_OF_WORLD", others_of_world);
  values.emplace_back("WORLD_OF_OTHERS", world_of_others);
}

}  // namespace

bool has_compensator(const Robot& robot) {
  const Machine& machine = robot.nominal();
  const auto limbs = std::span(machine.limbs).first(machine.limb_count);
  const auto is_alike = [&](const Limb& limb) { return limb.has_one_rod() && limb.actuator == robot.actuator(); };
  return robot.is_level() || (std::ranges::all_of(limbs, is_alike) && limbs.size() == machine.freedoms.count());
}

std::string c99_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  if (!robot.is_level()) return single_rod_header(robot, errors, origin);
  const ExportedMachine machine(robot, errors);
  const C99 language;
  Values values = head(robot, origin);
  const bool tilts_plate = machine.parameters.tilts_plate != 0;
  values.emplace_back("OPERATIONS", operations(machine));
  values.emplace_back("ON_RAILS", robot.actuator() == Actuator::linear ? "1" : "0");
  values.emplace_back("TILTS_PLATE", tilts_plate ? "1" : "0");
  values.emplace_back("LIMB_CONSTANTS", limb_constants(machine.parameters));
  values.emplace_back("STATE_DEFINED", tilts_plate ? settle_functions(machine.recorded, values) : "");
  values.emplace_back("STATE_PARAMETER", tilts_plate ? ", double state[PARACAL_STATE]" : "");
  values.emplace_back("LEVEL", machine.recorded.level.text(language, "  "));
  values.emplace_back("WAY_BACK", machine.recorded.way_back.text(language, "  "));
  values.emplace_back("TESTS", std::to_string(machine.cases.size()));
  values.emplace_back("TEST_VECTOR", test_vector(machine.cases, false));
  return filled_template("compensator_c99.h", values);
}

std::string linuxcnc_component(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  Values values = !robot.is_level() ? of_single_rods(robot, origin) : head(robot, origin);
  if (!robot.is_level()) add_axes(robot, values);
  values.emplace_back("C99", c99_header(robot, errors, origin));
  return filled_template(!robot.is_level() ? "single_rods_kins.comp" : "paracal_kins.comp", values);
}

}  // namespace paracal
