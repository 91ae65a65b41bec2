#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "export_text.hpp"
#include "paracal/error.hpp"
#include "variants.hpp"

namespace paracal {
namespace {

using namespace compensation_detail;

/// IEC 61131-3 Structured Text. Controllers may stop at a floating-point exception, so a flag takes the place of NaN.
/// Some tools read every literal as REAL, so all lie within its range.
class StructuredText : public Language {
 public:
  explicit StructuredText(const std::vector<Symbol>& numbers) : numbers_(numbers) {}

  std::string number(double value) const override { return decimal(value); }

  std::string symbol(const Symbol& symbol) const override {
    if (symbol.limb >= 0) return fmt::format("num[{}]", place_of_number(numbers_, symbol));
    return symbol.index < 0 ? std::string(symbol.name) : fmt::format("{}[{}]", symbol.name, symbol.index);
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
    return fmt::format("IF ABS({0}) < 1.0E-30 THEN held := FALSE; {0} := 1.0; END_IF;", number);
  }

 private:
  const std::vector<Symbol>& numbers_;
};

/// A text for each of so many, `{0}` its number from 0 and `{1}` from 1.
std::string for_each(std::size_t count, std::string_view line, std::string_view between = "") {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) {
    if (k > 0) text += between;
    text += fmt::format(fmt::runtime(line), k, k + 1);
  }
  return text;
}

std::string zeros(std::size_t count) { return for_each(count, "0.0", ", "); }

/// Lines of a list with their numbers behind one another.
std::string list(const std::vector<std::vector<double>>& rows) {
  std::vector<std::string> lines;
  for (const std::vector<double>& row : rows) {
    std::vector<std::string> texts;
    texts.reserve(row.size());
    for (const double number : row) texts.push_back(decimal(number));
    lines.push_back(fmt::format("    {}", fmt::join(texts, ", ")));
  }
  return fmt::format("{}", fmt::join(lines, ",\n"));
}

/// One machine as Structured Text: what its template needs.
class Writer {
 public:
  Writer(const Robot& robot, const ExportedMachine& exported, Values values)
      : exported_(exported),
        recorded_(exported.recorded),
        language_(exported.recorded.numbers),
        limbs_(robot.limb_count()),
        free_(exported.places.size()),
        values_(std::move(values)) {
    for (const std::size_t place : exported.places)
      inputs_.push_back({coordinate_name(exported.machine, place), place});
    coordinates_ = inputs_;
    // A rigid plate is asked for no rotation, which must then be 0.
    if (robot.is_level() && !robot.slide()) inputs_.push_back({"phi_rad", 5, false});
  }

  std::string text() {
    add_sizes();
    add_coordinates();
    add_joints();
    add_forward();
    add_rates();
    add_search();
    add_drives();
    add_tests();
    return filled_template("compensator.st", values_);
  }

 private:
  struct Input {
    std::string name;
    std::size_t place;
    bool is_commanded = true;
  };

  void add(std::string_view key, std::string text) { values_.emplace_back(key, std::move(text)); }
  void add(std::string_view key, std::size_t number) { add(key, std::to_string(number)); }

  /// "joint_1_rad", "joint_2_mm"
  std::string joint(std::size_t limb) const {
    const bool in_mm = joint_unit(exported_.machine.limbs.at(limb).actuator) == Unit::mm;
    return fmt::format("joint_{}_{}", limb + 1, in_mm ? "mm" : "rad");
  }

  /// A text for each joint, `{0}` its number from 0 and `{1}` its name.
  std::string for_each_joint(std::string_view line, std::string_view between = "") const {
    std::string text;
    for (std::size_t i = 0; i < limbs_; ++i) {
      text += fmt::format("{}{}", i > 0 ? between : "", fmt::format(fmt::runtime(line), i, joint(i)));
    }
    return text;
  }

  /// A text for each input, `{0}` its number from 0 and `{1}` its name.
  static std::string for_each_input(const std::vector<Input>& inputs, std::string_view line,
                                    std::string_view between = "") {
    std::string text;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      text += fmt::format("{}{}", k > 0 ? between : "", fmt::format(fmt::runtime(line), k, inputs[k].name));
    }
    return text;
  }

  /// Declarations of the locals that procedures share.
  std::string locals(const std::vector<const Procedure*>& procedures) const {
    std::size_t most = 0;
    for (const Procedure* procedure : procedures) most = std::max(most, procedure->locals(language_));
    return for_each(most, "  v{1} : LREAL := 0.0;\n");
  }

  void add_sizes() {
    const ParameterSet& set = exported_.set;
    std::vector<std::vector<double>> numbers;
    for (const double number : set.numbers) numbers.push_back({number});
    add("NUMBER_LIST", list(numbers));
    add("LAST_NUMBER", set.numbers.size() - 1);
    add("LAST_SET", set.numbers.size() + 1);
    add("ZERO_SET", zeros(set.numbers.size() + 2));
    add("LAST_FREE", free_ - 1);
    add("COLUMNS", free_ + 1);
    add("LAST_RATE", limbs_ * free_ - 1);
    add("ZERO_RATES", zeros(limbs_ * free_));
    add("LAST_NORMAL", free_ * (free_ + 1) - 1);
    add("ZERO_NORMAL", zeros(free_ * (free_ + 1)));
    add("ZERO_JOINTS", zeros(limbs_));
    add("LOCALS", locals(searches() ? std::vector{&recorded_.closed, &recorded_.answer, &recorded_.step}
                                    : std::vector{&recorded_.closed}));
    add("RATE_LOCALS", locals({&recorded_.rates}));
  }

  bool searches() const { return exported_.searches(); }
  bool is_uneven() const { return !exported_.is_even(); }

  void add_coordinates() {
    add("INPUT_WORDS", for_each_input(inputs_, "{1}", ", "));
    add("CALL_WORDS", for_each_input(inputs_, "{1} := ...", ", "));
    add("POSE_INPUTS", for_each_input(inputs_, "  {1} : LREAL := 0.0;\n"));
    add("POSE_OUTPUTS", for_each_input(coordinates_, "  {1} : LREAL := 0.0;\n"));
    add("ALL_FINITE", for_each_input(inputs_, "(ABS({1}) < 1.0E37)", " AND "));
    std::string far;
    for (const Input& one : inputs_) {
      far +=
          fmt::format("{}(ABS({}) > {})", far.empty() ? "" : " OR ", one.name, one.is_commanded ? "1.0E9" : "1.0E-6");
    }
    add("FAR_OUT", far);
    std::string pose;
    for (const Input& one : coordinates_) pose += fmt::format("  pose[{}] := {};\n", one.place, one.name);
    add("SET_POSE", pose);
    add("GIVE_NEXT", for_each_input(coordinates_, "{1} := next[{0}]", ", "));
    add("GIVE_INPUTS", for_each_input(inputs_, "{1} := {1}", ", "));
    add("GIVE_TEST", for_each_input(coordinates_, fmt::format("{{1}} := poses[{} * number + {{0}}]", free_), ", "));
    add("GET_FOUND", for_each_input(coordinates_, "  found[{0}] := forward.{1};\n"));
    add("GIVE_POSE", for_each_input(coordinates_, "        {1} := here[{0}];\n"));
  }

  /// What machines with uneven drives need on top.
  void add_drives() {
    constexpr std::array<std::string_view, 5> kKeys{"DRIVE_FUNCTIONS", "DRIVE_LOCALS", "DRIVES", "DRIVE_RATE_LOCALS",
                                                    "DRIVE_RATES"};
    if (!is_uneven()) {
      for (const std::string_view key : kKeys) add(key, "");
      return;
    }
    const std::string locals = fmt::format(
        "  commanded : ARRAY [0..{}] OF LREAL := [{}];\n  limb : INT := 0;\n  knot : INT := 0;\n"
        "  place : LREAL := 0.0;\n",
        limbs_ - 1, zeros(limbs_));
    Values own = values_;
    own.emplace_back("TURN_AT", std::to_string(exported_.drives_at() + kDriveKnots + 2));
    own.emplace_back("DRIVE", std::to_string(kCurveNumbers));
    own.emplace_back("LAST_KNOT", std::to_string(kDriveKnots - 1));
    own.emplace_back("GET_COMMANDED", for_each_joint("  commanded[{0}] := inverse.{1};\n"));
    const std::array<std::string, kKeys.size()> texts{
        filled_template("drives_functions.st", own),
        locals + "  needed : LREAL := 0.0;\n  change : LREAL := 0.0;\n  drive_step : INT := 0;\n",
        for_each_joint(searches() ? "  commanded[{0}] := joints[{0}] + state[3 + {0}];\n"
                                  : "  commanded[{0}] := joints[{0}];\n") +
            filled_template("drives.st", own),
        locals + "  inverse : paracal_compensator;\n  way : LREAL := 1.0;\n  turned : LREAL := 0.0;\n",
        filled_template("drive_rates.st", own)};
    for (std::size_t k = 0; k < kKeys.size(); ++k) add(kKeys.at(k), texts.at(k));
  }

  void add_joints() {
    add("FIRST_JOINT", joint(0));
    add("JOINT_INPUTS", for_each_joint("  {1} : LREAL := 0.0;\n"));
    add("JOINT_OUTPUTS", for_each_joint("  {1} : LREAL := 0.0;\n"));
    add("SET_JOINTS", for_each_joint(is_uneven()  ? "  {1} := commanded[{0}];\n"
                                     : searches() ? "  {1} := joints[{0}] + state[3 + {0}];\n"
                                                  : "  {1} := joints[{0}];\n"));
    add("GET_WANTED", for_each_joint("  wanted[{0}] := {1};\n"));
    add("GET_JOINTS", for_each_joint("    joints[{0}] := inverse.{1};\n"));
    add("GET_TESTED", for_each_joint("  joints[{0}] := compensator.{1};\n"));
    add("GIVE_JOINTS", for_each_joint("{1} := joints[{0}]", ", "));
    add("SET_NOW", for_each_joint("    {1} := now.{1};\n"));
    add("SET_BETWEEN", for_each_joint("  {1} := next.{1} + fraction * (now.{1} - next.{1});\n"));
    add("CLOSED", recorded_.closed.text(language_, "  "));
  }

  void add_forward() {
    std::vector<std::string> home;
    Pose centre = exported_.cases.front().pose;
    for (const Input& one : coordinates_) {
      home.push_back(decimal(coordinate(centre, exported_.machine, one.place)));
    }
    add("HOME", fmt::format("{}", fmt::join(home, ", ")));
    const auto agreement = std::ranges::find(values_, "AGREEMENT", &Values::value_type::first);
    add("SQUARED_AGREEMENT", decimal(std::stod(agreement->second) * std::stod(agreement->second)));
  }

  /// rate_1_x_mm: of joint 1 by x, in the units of both.
  void add_rates() {
    std::string outputs, set, get;
    for (std::size_t i = 0; i < limbs_; ++i) {
      for (std::size_t k = 0; k < free_; ++k) {
        const std::string name = fmt::format("rate_{}_{}", i + 1, coordinates_[k].name);
        outputs += fmt::format("  {} : LREAL := 0.0;\n", name);
        set += fmt::format("  {} := rates[{}];\n", name, i * free_ + k);
        get += fmt::format("      rates[{}] := jacobian.{};\n", i * free_ + k, name);
      }
    }
    add("RATE_OUTPUTS", outputs);
    add("SET_RATES", set);
    add("GET_RATES", get);
    add("RATES", recorded_.rates.text(language_, "  "));
  }

  std::string turn(std::string_view name, std::string_view function, const Procedure& series) const {
    Values own = values_;
    std::erase_if(own, [](const auto& one) { return one.first == "LOCALS"; });
    own.emplace_back("NAME", name);
    own.emplace_back("FUNCTION", function);
    own.emplace_back("LOCALS", locals({&series}));
    own.emplace_back("SERIES", series.text(language_, "    "));
    return filled_template("turn.st", own);
  }

  std::string state_declarations() const {
    return fmt::format(
        "  state : ARRAY [0..{}] OF LREAL := [{}]; (* tilt, changes of the joints, positions of arms or carriages *)\n"
        "  answer : ARRAY [0..{}] OF LREAL := [{}]; (* response of arms and plate to the rods *)\n"
        "  changes : ARRAY [0..{}] OF LREAL := [{}]; (* rotations of arms and plate in one step *)\n"
        "  before : LREAL := 1.0;\n  largest : LREAL := 0.0;\n  settled : BOOL := FALSE;\n  count : INT := 0;\n"
        "  k : INT := 0;\n",
        recorded_.state_size - 1, zeros(recorded_.state_size), recorded_.answer_size - 1, zeros(recorded_.answer_size),
        limbs_ + 2, zeros(limbs_ + 3));
  }

  /// What machines whose plate tilts need on top.
  void add_search() {
    std::string outputs, set, now, next;
    for (std::size_t k = 0; !exported_.machine.has_guides && k < 3; ++k) {
      if (exported_.machine.freedoms.free.at(3 + k)) continue;
      const std::string name = fmt::format("tilt_{}_rad", "xyz"[k]);
      outputs += fmt::format("  {} : LREAL := 0.0; (* tilt of the plate that no joint can remove *)\n", name);
      now += fmt::format("    {0} := now.{0};\n", name);
      next += fmt::format("  {0} := next.{0};\n", name);
      set += searches() ? fmt::format("  {} := state[{}];\n", name, k) : fmt::format("  {} := 0.0;\n", name);
    }
    add("TILT_OUTPUTS", outputs);
    add("TILT_NOW", now);
    add("TILT_NEXT", next);
    add("SET_TILT", set);
    if (!searches()) {
      for (const char* key : {"TURNS", "STATE", "SETTLE"}) add(key, "");
      return;
    }
    add("TURNS", turn("cosine", "COS", recorded_.turn_cosine) + turn("sine", "SIN", recorded_.turn_sine));
    add("STATE", state_declarations());
    const bool is_exact = exported_.variant == ExportVariant::exact;
    const int steps = is_exact ? closure::kMostSteps : usual_steps(exported_.variant);
    Values own = values_;
    own.emplace_back("ANSWER", recorded_.answer.text(language_, "  "));
    own.emplace_back("STEP", recorded_.step.text(language_, "    "));
    own.emplace_back("LAST_CHANGE", std::to_string(limbs_ + 2));
    own.emplace_back("STEP_LIMIT", std::to_string(steps));
    own.emplace_back("SETTLED_TEST", is_exact
                                         ? fmt::format("(largest <= before) AND (largest * largest <= {} * before)",
                                                       decimal(closure::kSettled<double>))
                                         : fmt::format("count >= {}", steps - 1));
    add("SETTLE", filled_template("settle.st", own));
  }

  void add_tests() {
    std::vector<std::vector<double>> poses, joints;
    for (SelfTestCase one : exported_.cases) {
      std::vector<double>& pose = poses.emplace_back();
      for (const Input& input : coordinates_) {
        pose.push_back(coordinate(one.pose, exported_.machine, input.place));
      }
      joints.emplace_back(one.joints.begin(), one.joints.end());
    }
    add("LAST_POSE_NUMBER", free_ * poses.size() - 1);
    add("LAST_EXPECTED", limbs_ * joints.size() - 1);
    add("TEST_POSES", list(poses));
    add("TEST_JOINTS", list(joints));
  }

  const ExportedMachine& exported_;
  const RecordedMachine& recorded_;
  StructuredText language_;
  std::size_t limbs_, free_;
  Values values_;
  std::vector<Input> inputs_, coordinates_;
};

}  // namespace

std::string structured_text(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                            const DriveCurves& drives) {
  if (origin.variant == ExportVariant::single) {
    throw InvalidArgument("--variant float: expected with --target c99 or linuxcnc, got st: use one-step");
  }
  const ExportedMachine exported(robot, errors, origin, drives);
  Values values = head(robot, origin);
  add_head(robot, exported, values);
  return Writer(robot, exported, std::move(values)).text();
}

}  // namespace paracal
