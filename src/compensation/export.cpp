#include "paracal/compensation/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "export_text.hpp"
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
        "     {}}},\n",
        braced(limb.base), braced(limb.radial), braced(limb.normal), braced(limb.axis), braced(limb.plate),
        braced(limb.slide), braced(limb.elbow_half), braced(limb.plate_half), braced(limb.rod), decimal(limb.arm),
        decimal(limb.joint_offset));
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

/// "a machine on struts", and what closes a limb of it.
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

Values of_single_rods(const Robot& robot, const ExportOrigin& origin) {
  const auto [limbs, equation] = limbs_in_words(robot.actuator());
  const bool in_mm = joint_unit(robot.actuator()) == Unit::mm;
  Values values = head(robot, origin);
  values.emplace_back("LIMBS_IN_WORDS", limbs);
  values.emplace_back("EQUATION", equation);
  values.emplace_back("SHOWN_JOINT", in_mm ? "1.0" : "PARACAL_DEGREES");
  values.emplace_back("ARCTANGENT", in_mm ? "" : "double atan2(double y, double x);\n");
  return values;
}

std::string single_rod_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  const Machine machine = build(robot, errors);
  const RecordedRods recorded = record_single_rods(machine);
  const std::vector<SelfTestCase> cases = single_rod_self_test(robot, machine);
  const C99 language;
  Values values = of_single_rods(robot, origin);
  values.emplace_back("OPERATIONS", operations(recorded.joints, robot.actuator()));
  values.emplace_back("LIMB_MEMBERS", members(machine.limbs[0]));
  values.emplace_back("LIMB_CONSTANTS", initializers(machine));
  values.emplace_back("JOINTS", recorded.joints.text(language, "  "));
  values.emplace_back("ROWS", recorded.rows.text(language, "  "));
  values.emplace_back("TESTS", std::to_string(cases.size()));
  values.emplace_back("TEST_VECTOR", test_vector(cases, true));
  return filled_template("single_rods_c99.h", values);
}

}  // namespace

std::string c99_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  if (robot.on_single_rods()) return single_rod_header(robot, errors, origin);
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
  const bool six_freedoms = robot.on_single_rods();
  Values values = six_freedoms ? of_single_rods(robot, origin) : head(robot, origin);
  values.emplace_back("C99", c99_header(robot, errors, origin));
  return filled_template(six_freedoms ? "single_rods_kins.comp" : "paracal_kins.comp", values);
}

}  // namespace paracal
