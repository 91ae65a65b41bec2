#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "export_text.hpp"

namespace paracal {
namespace {

using namespace compensation_detail;

/// IEC 61131-3 Structured Text. Controllers may stop at a floating-point exception, so a flag takes the place of NaN.
class StructuredText : public Language {
 public:
  std::string number(double value) const override { return decimal(value); }

  std::string symbol(const Symbol& symbol) const override {
    if (symbol.limb < 0) {
      return symbol.index < 0 ? std::string(symbol.name) : fmt::format("{}[{}]", symbol.name, symbol.index);
    }
    std::string text = fmt::format("limb_{}_{}", symbol.limb + 1, symbol.name);
    if (symbol.index < 0) return text;
    return symbol.name == "rod" ? fmt::format("{}_{}", text, symbol.index + 1)
                                : fmt::format("{}_{}", text, "xyz"[symbol.index]);
  }

  FunctionNames functions() const override {
    return {.square_root = "SQRT", .sine = "SIN", .cosine = "COS", .arctangent = "paracal_atan2"};
  }

  std::string choice(const std::string& number, const std::string& negative, const std::string& other) const override {
    return fmt::format("SEL({} < 0.0, {}, {})", number, other, negative);
  }

  std::string define(const std::string& local, const std::string& formula) const override {
    return assign(local, formula);
  }

  std::string assign(const std::string& target, const std::string& formula) const override {
    return fmt::format("{} := {};", target, formula);
  }

  std::string guard_root(const std::string& number) const override {
    return fmt::format("IF {0} < 0.0 THEN held := FALSE; {0} := 0.0; END_IF;", number);
  }

  std::string guard_divisor(const std::string& number) const override {
    return fmt::format("IF ABS({0}) < 1.0E-60 THEN held := FALSE; {0} := 1.0; END_IF;", number);
  }
};

const StructuredText kLanguage;

/// Declarations of the constants of limbs that procedures use.
std::string constants(const std::vector<const Procedure*>& procedures) {
  std::set<Symbol> used;
  for (const Procedure* procedure : procedures) used.merge(procedure->symbols());
  std::vector<Symbol> sorted;
  std::ranges::copy_if(used, std::back_inserter(sorted), [](const Symbol& symbol) { return symbol.limb >= 0; });
  std::ranges::stable_sort(sorted, {}, &Symbol::limb);
  std::string text;
  for (const Symbol& symbol : sorted) {
    text += fmt::format("  {} : LREAL := {};\n", kLanguage.symbol(symbol), decimal(symbol.value));
  }
  return text;
}

/// Declarations of the locals that procedures share.
std::string locals(const std::vector<const Procedure*>& procedures) {
  std::size_t most = 0;
  for (const Procedure* procedure : procedures) most = std::max(most, procedure->locals(kLanguage));
  std::string text;
  constexpr std::size_t kALine = 15;
  for (std::size_t first = 1; first <= most; first += kALine) {
    std::vector<std::string> names;
    for (std::size_t k = first; k < std::min(first + kALine, most + 1); ++k) names.push_back(fmt::format("v{}", k));
    text += fmt::format("  {} : LREAL;\n", fmt::join(names, ", "));
  }
  return text;
}

/// One line for each joint, `{0}` its number from 0 and `{1}` from 1.
std::string for_each_joint(const Robot& robot, std::string_view line, std::string_view between = "") {
  std::string text;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    if (i > 0) text += between;
    text += fmt::format(fmt::runtime(line), i, i + 1, robot.actuator() == Actuator::linear ? "mm" : "rad");
  }
  return text;
}

std::string array_entries(const std::vector<std::vector<double>>& rows) {
  std::vector<std::string> lines;
  for (const std::vector<double>& row : rows) {
    std::vector<std::string> texts;
    texts.reserve(row.size());
    for (const double number : row) texts.push_back(decimal(number));
    lines.push_back(fmt::format("    {}", fmt::join(texts, ", ")));
  }
  return fmt::format("{}", fmt::join(lines, ",\n"));
}

void add_test_vector(const std::vector<SelfTestCase>& cases, Values& values) {
  std::vector<std::vector<double>> poses, joints;
  for (const SelfTestCase& one : cases) {
    const Eigen::Vector3d& r = one.pose.position;
    poses.push_back({r.x(), r.y(), r.z(), one.pose.rotation});
    joints.emplace_back(one.joints.begin(), one.joints.end());
  }
  values.emplace_back("TESTS", std::to_string(cases.size()));
  values.emplace_back("LAST_POSE_NUMBER", std::to_string(4 * cases.size() - 1));
  values.emplace_back("LAST_EXPECTED", std::to_string(cases.size() * joints.front().size() - 1));
  values.emplace_back("TEST_POSES", array_entries(poses));
  values.emplace_back("TEST_JOINTS", array_entries(joints));
  values.emplace_back("CENTRE_X", decimal(poses.front()[0]));
  values.emplace_back("CENTRE_Y", decimal(poses.front()[1]));
  values.emplace_back("CENTRE_Z", decimal(poses.front()[2]));
}

/// Where joints come from and go to, one statement each: function blocks of all tools have single numbers as outputs.
void add_joint_statements(const Robot& robot, bool tilts_plate, Values& values) {
  values.emplace_back("JOINT_OUTPUTS", for_each_joint(robot, "  joint_{1}_{2} : LREAL;\n"));
  values.emplace_back("SET_JOINTS",
                      for_each_joint(robot, tilts_plate ? "  joint_{1}_{2} := joints[{0}] + state[3 + {0}];\n"
                                                        : "  joint_{1}_{2} := joints[{0}];\n"));
  values.emplace_back("GET_WANTED", for_each_joint(robot, "  wanted[{0}] := joint_{1}_{2};\n"));
  values.emplace_back("GET_JOINTS", for_each_joint(robot, "    joints[{0}] := inverse.joint_{1}_{2};\n"));
  values.emplace_back("GET_TESTED", for_each_joint(robot, "  joints[{0}] := compensator.joint_{1}_{2};\n"));
  values.emplace_back("GIVE_JOINTS", for_each_joint(robot, "joint_{1}_{2} := joints[{0}]", ", "));
}

std::string turn(std::string_view name, std::string_view function, const Procedure& series, Values values) {
  values.emplace_back("NAME", name);
  values.emplace_back("FUNCTION", function);
  values.emplace_back("LOCALS", locals({&series}));
  values.emplace_back("SERIES", series.text(kLanguage, "    "));
  return filled_template("turn.st", values);
}

std::string state_declarations(const RecordedMachine& recorded, std::size_t limbs) {
  return fmt::format(
      "  state : ARRAY [0..{}] OF LREAL; (* tilt, changes of the joints, positions of arms or carriages *)\n"
      "  answer : ARRAY [0..{}] OF LREAL; (* response of arms and plate to the rods *)\n"
      "  changes : ARRAY [0..{}] OF LREAL; (* rotations of arms and plate in one step *)\n"
      "  before : LREAL;\n  largest : LREAL;\n  settled : BOOL;\n  count : INT;\n  k : INT;\n",
      recorded.state_size - 1, recorded.answer_size - 1, limbs + 2);
}

/// What machines whose plate tilts need on top.
void add_settling(const RecordedMachine& recorded, std::size_t limbs, Values& values) {
  Values own = values;
  own.emplace_back("ANSWER", recorded.answer.text(kLanguage, "  "));
  own.emplace_back("STEP", recorded.step.text(kLanguage, "    "));
  own.emplace_back("LAST_CHANGE", std::to_string(limbs + 2));
  const std::string turns =
      turn("cosine", "COS", recorded.turn_cosine, values) + turn("sine", "SIN", recorded.turn_sine, values);
  values.emplace_back("TURNS", turns);
  values.emplace_back("STATE", state_declarations(recorded, limbs));
  values.emplace_back("SETTLE", filled_template("settle.st", own));
  values.emplace_back("SET_TILT", "  tilt_x_rad := state[0];\n  tilt_y_rad := state[1];\n");
}

}  // namespace

std::string structured_text(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  const ExportedMachine machine(robot, errors);
  const RecordedMachine& recorded = machine.recorded;
  const bool tilts_plate = machine.parameters.tilts_plate != 0;
  std::vector<const Procedure*> compensation{&recorded.level};
  if (tilts_plate) compensation.insert(compensation.end(), {&recorded.answer, &recorded.step});

  Values values = head(robot, origin);
  values.emplace_back("OPERATIONS", operations(machine));
  values.emplace_back("LARGEST_PHI", robot.slide() ? "1.0E9" : "0.0");
  values.emplace_back("CONSTANTS", constants(compensation));
  values.emplace_back("LOCALS", locals(compensation));
  values.emplace_back("LEVEL", recorded.level.text(kLanguage, "  "));
  if (tilts_plate) {
    add_settling(recorded, robot.limb_count(), values);
  } else {
    for (const char* key : {"TURNS", "STATE", "SETTLE"}) values.emplace_back(key, "");
    values.emplace_back("SET_TILT", "  tilt_x_rad := 0.0;\n  tilt_y_rad := 0.0;\n");
  }
  values.emplace_back("WAY_BACK_CONSTANTS", constants({&recorded.way_back}));
  values.emplace_back("WAY_BACK_LOCALS", locals({&recorded.way_back}));
  values.emplace_back("WAY_BACK", recorded.way_back.text(kLanguage, "      "));
  add_joint_statements(robot, tilts_plate, values);
  add_test_vector(machine.cases, values);
  return filled_template("compensator.st", values);
}

}  // namespace paracal
