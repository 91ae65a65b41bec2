#include "paracal/compensation/export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "export_text.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/units.hpp"
#include "variants.hpp"

namespace paracal {
namespace {

using namespace compensation_detail;

/// C99, which has NaN for what has no answer.
class C99 : public Language {
 public:
  explicit C99(const std::vector<Symbol>& numbers, bool is_single = false) : numbers_(numbers), is_single_(is_single) {}

  bool states_precedence() const override { return true; }

  std::string number(double value) const override { return decimal(value) + (is_single_ ? "F" : ""); }

  std::string symbol(const Symbol& symbol) const override {
    if (symbol.limb >= 0) return fmt::format("p[{}]", place_of_number(numbers_, symbol));
    return symbol.index < 0 ? std::string(symbol.name) : fmt::format("{}[{}]", symbol.name, symbol.index);
  }

  FunctionNames functions() const override {
    if (is_single_) return {.square_root = "sqrtf", .sine = "sinf", .cosine = "cosf", .arctangent = "atan2f"};
    return {.square_root = "sqrt", .sine = "sin", .cosine = "cos", .arctangent = "atan2"};
  }

  std::string choice(const std::string& number, const std::string& negative, const std::string& other) const override {
    return fmt::format("(({} < {}) ? {} : {})", number, this->number(0.0), negative, other);
  }

  std::string define(const std::string& local, const std::string& formula) const override {
    return fmt::format("const {} {} = {};", is_single_ ? "float" : "double", local, formula);
  }

  std::string assign(const std::string& target, const std::string& formula) const override {
    return fmt::format("{} = {};", target, formula);
  }

  std::string guard_root(const std::string&) const override { return {}; }
  std::string guard_divisor(const std::string&) const override { return {}; }

 private:
  const std::vector<Symbol>& numbers_;
  bool is_single_;
};

std::string braced(const std::vector<double>& numbers) {
  std::vector<std::string> texts;
  texts.reserve(numbers.size());
  for (const double number : numbers) texts.push_back(decimal(number));
  return fmt::format("{{{}}}", fmt::join(texts, ", "));
}

std::string number_lines(const ParameterSet& set, std::string_view suffix, bool with_names) {
  std::string text;
  for (std::size_t k = 0; k < set.numbers.size(); ++k) {
    const std::string value = suffix.empty() ? decimal(set.numbers[k]) : decimal(static_cast<float>(set.numbers[k]));
    const std::string name = with_names ? fmt::format(" /* {}: {} */", k, set.names[k]) : "";
    text += fmt::format("    {}{}{}{}\n", value, suffix, k + 1 < set.numbers.size() ? "," : "", name);
  }
  return text;
}

std::vector<double> pose_numbers(const ExportedMachine& exported, Pose pose) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < 6; ++k) numbers.push_back(coordinate(pose, exported.machine, k));
  return numbers;
}

std::string test_vector(const ExportedMachine& exported) {
  std::string text;
  for (const auto& [pose, joints] : exported.cases) {
    text +=
        fmt::format("    {{{}, {}}},\n", braced(pose_numbers(exported, pose)), braced({joints.begin(), joints.end()}));
  }
  return text;
}

/// What of a pose can be commanded, and what the rest must be.
void add_coordinates(const ExportedMachine& exported, Values& values) {
  std::vector<int> is_held(6, 1);
  std::vector<double> held(6, 0.0);
  if (exported.machine.freedoms.holds_z()) held[2] = exported.machine.guided_z;
  for (const std::size_t place : exported.places) is_held[place] = 0;
  const bool has_slide = exported.machine.has_slide();
  values.emplace_back("PLACES", fmt::format("{}", fmt::join(exported.places, ", ")));
  values.emplace_back("IS_HELD", fmt::format("{}", fmt::join(is_held, ", ")));
  values.emplace_back("HELD", braced(held).substr(1, braced(held).size() - 2));
  values.emplace_back("POSE_WORDS", has_slide ? "x, y, z, 0.0, 0.0, phi" : "x, y, z, tilt_x, tilt_y, tilt_z");
  values.emplace_back("TURN_WORDS", has_slide
                                        ? "0, 0, phi of the end-effector"
                                        : "tilt_x, tilt_y, tilt_z: R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z, tilt_z)");
  values.emplace_back("PLATE_REMARK", has_slide ? " (its own tilt_z, not phi)" : "");
}

/// What machines whose plate tilts need on top.
void add_search(const ExportedMachine& exported, Values& values) {
  const bool searches = exported.searches(), is_single = searches && exported.variant == ExportVariant::single;
  const RecordedMachine& recorded = exported.recorded;
  const std::string real = is_single ? "float" : "double";
  const C99 language(recorded.numbers, is_single);
  values.emplace_back("SINGLE_FUNCTIONS",
                      is_single ? "float sqrtf(float x);\nfloat sinf(float x);\nfloat cosf(float x);\n" : "");
  values.emplace_back("SINGLE_MEMBER", is_single ? "  float single[PARACAL_NUMBERS]; /* the same */\n" : "");
  values.emplace_back("SINGLE_NUMBERS", is_single ? ", {\n" + number_lines(exported.set, "F", false) + "}" : "");
  values.emplace_back("SINGLE_COPY", is_single ? "    next->single[k] = (float)set[k];\n" : "");
  values.emplace_back("STATE_PARAMETER", searches ? ", double state[PARACAL_STATE]" : "");
  values.emplace_back("STATE_ARGUMENT", searches ? ", closed" : "");
  Values own = values;
  own.emplace_back("REAL", real);
  own.emplace_back("ZERO", language.number(0.0));
  std::erase_if(own, [](const auto& one) { return one.first == "SERIES_REACH"; });
  own.emplace_back("SERIES_REACH", language.number(closure::kSeriesReach));
  own.emplace_back("COSINE", language.functions().cosine);
  own.emplace_back("SINE", language.functions().sine);
  const bool is_exact = exported.variant == ExportVariant::exact;
  values.emplace_back(
      "STATE_DEFINED",
      searches
          ? fmt::format("#define PARACAL_STEPS {}\n"
                        "#define PARACAL_STATE {} /* tilt (3), changes of the joints, positions of arms or carriages "
                        "*/\n#define PARACAL_ANSWER {} /* response of arms and plate to the rods */\n\n",
                        is_exact ? 0 : usual_steps(exported.variant), recorded.state_size, recorded.answer_size)
          : "");
  own.emplace_back("STEP_LIMIT", std::to_string(is_exact ? closure::kMostSteps : usual_steps(exported.variant)));
  own.emplace_back("TURN_COSINE", recorded.turn_cosine.text(language, "    "));
  own.emplace_back("TURN_SINE", recorded.turn_sine.text(language, "    "));
  own.emplace_back("ANSWER", recorded.answer.text(language, "  "));
  own.emplace_back("STEP", recorded.step.text(language, "  "));
  const std::string narrowed = is_single ? "(float)" : "", widened = is_single ? "(double)" : "";
  std::string plate;
  for (std::size_t k = 3; k < 6; ++k) {
    if (exported.machine.freedoms.free.at(k)) continue;
    if (searches) {
      plate += fmt::format("    plate[{}] = {}state[{}];\n", k, widened, k - 3);
    } else if (exported.machine.has_slide() && k == 5) {
      plate += "    plate[5] = 0.0;\n";
    }
  }
  values.emplace_back("PLATE_TILT", plate);
  values.emplace_back("SEARCH", searches ? filled_template("search_c99.h", own) : "");
  values.emplace_back("STATE", searches ? fmt::format("  double closed[PARACAL_STATE];\n  {0} state[PARACAL_STATE];\n"
                                                      "  {0} there[6];\n",
                                                      real)
                                        : "");
  values.emplace_back(
      "SETTLE", searches ? fmt::format("  for (i = 0; i < 6; ++i) {{ there[i] = {0}pose[i]; }}\n"
                                       "  for (i = 0; i < PARACAL_STATE; ++i) {{ state[i] = {0}closed[i]; }}\n"
                                       "  if (paracal_settle(numbers->{1}, there, state) != PARACAL_OK) {{ return "
                                       "PARACAL_SINGULAR; }}\n"
                                       "  for (i = 0; i < PARACAL_LIMBS; ++i) {{\n"
                                       "    found[i] += {2}state[3 + i];\n"
                                       "    if (!paracal_is_finite(found[i])) {{ return PARACAL_SINGULAR; }}\n  }}\n",
                                       narrowed, is_single ? "single" : "exact", widened)
                         : "");
}

/// What machines with uneven drives need on top.
void add_drives(const ExportedMachine& exported, Values& values) {
  const bool is_uneven = !exported.is_even();
  values.emplace_back("COMMAND", is_uneven ? "  paracal_command(numbers->exact, found);\n" : "");
  values.emplace_back("COMMAND_RATES", is_uneven ? "  paracal_command_rates(numbers->exact, joints, found);\n" : "");
  if (!is_uneven) {
    values.emplace_back("DRIVES", "");
    return;
  }
  const bool is_single = exported.searches() && exported.variant == ExportVariant::single;
  const C99 language(exported.recorded.numbers, is_single);
  Values own = values;
  own.emplace_back("REAL", is_single ? "float" : "double");
  own.emplace_back("NARROWED", is_single ? "(float)" : "");
  own.emplace_back("WIDENED", is_single ? "(double)" : "");
  own.emplace_back("SINE", language.functions().sine);
  own.emplace_back("COSINE", language.functions().cosine);
  constexpr std::array<std::pair<std::string_view, double>, 7> kNumbers{{{"ZERO", 0.0},
                                                                         {"HALF", 0.5},
                                                                         {"ONE", 1.0},
                                                                         {"TWO", 2.0},
                                                                         {"THREE", 3.0},
                                                                         {"SIX", 6.0},
                                                                         {"NOTHING", kNoDriveChange}}};
  for (const auto& [name, number] : kNumbers) own.emplace_back(name, language.number(number));
  values.emplace_back("DRIVES", filled_template("drives_c99.h", own));
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

/// "the plate is turned by R = Rot(x, A) Rot(y, B) Rot(z, C)", as far as it is.
std::string turns_in_words(const Machine& machine) {
  if (machine.has_slide()) return "C turns the end-effector";
  std::string text;
  for (std::size_t k = 3; k < 6; ++k) {
    if (machine.freedoms.free.at(k))
      text += fmt::format("{}Rot({}, {})", text.empty() ? "" : " ", "xyz"[k - 3], "ABC"[k - 3]);
  }
  return text.empty() ? "no axis turns the plate" : "the plate is turned by R = " + text;
}

/// How the component takes poses from axes, and leaves to joints of their own what the robot does not move.
void add_axes(const ExportedMachine& exported, Values& values) {
  const std::size_t limbs = exported.machine.limb_count;
  std::string pins, of_pins, of_world, to_world, others_of_world, world_of_others;
  std::vector<std::string> others;
  for (std::size_t k = 0; k < kAxes.size(); ++k) {
    const auto& [letter, place, what] = kAxes.at(k);
    if (std::ranges::count(exported.places, k) == 0) {
      const std::size_t joint = limbs + others.size();
      others_of_world += fmt::format("  joints[{}] = world->{};\n", joint, place);
      world_of_others += fmt::format("  world->{} = joints[{}];\n", place, joint);
      others.emplace_back(1, static_cast<char>(std::toupper(letter[0])));
      continue;
    }
    const bool turns = k >= 3, is_slide = among_seven(exported.machine, k) == 6;
    pins += fmt::format("pin in float command.{} \"{}\";\n", letter,
                        is_slide ? "commanded rotation of the end-effector, deg" : what);
    of_pins += fmt::format("  pose[{}] = command_{}{};\n", k, letter, turns ? " / PARACAL_DEGREES" : "");
    of_world += fmt::format("  pose[{}] = world->{}{};\n", k, place, turns ? " / PARACAL_DEGREES" : "");
    to_world += fmt::format("  world->{} = pose[{}]{};\n", place, k, turns ? " * PARACAL_DEGREES" : "");
  }
  values.emplace_back("TURNS", turns_in_words(exported.machine));
  values.emplace_back("OTHER_AXES", fmt::format("{}", fmt::join(others, ", ")));
  values.emplace_back("PINS", pins);
  values.emplace_back("POSE_OF_PINS", of_pins);
  values.emplace_back("POSE_OF_WORLD", of_world);
  values.emplace_back("WORLD_OF_POSE", to_world);
  values.emplace_back("OTHERS_OF_WORLD", others_of_world);
  values.emplace_back("WORLD_OF_OTHERS", world_of_others);
}

/// Factors between what the kinematics compute, mm and rad, and what LinuxCNC shows, mm and deg.
void add_shown_units(const ExportedMachine& exported, Values& values) {
  std::vector<std::string> joints, coordinates;
  for (std::size_t i = 0; i < exported.machine.limb_count; ++i) {
    const bool in_mm = joint_unit(exported.machine.limbs.at(i).actuator) == Unit::mm;
    joints.emplace_back(in_mm ? "1.0" : "PARACAL_DEGREES");
  }
  for (const std::size_t place : exported.places) coordinates.emplace_back(place < 3 ? "1.0" : "PARACAL_DEGREES");
  values.emplace_back("SHOWN_JOINTS", fmt::format("{}", fmt::join(joints, ", ")));
  values.emplace_back("SHOWN_COORDINATES", fmt::format("{}", fmt::join(coordinates, ", ")));
  values.emplace_back("RATE_COUNT", std::to_string(joints.size() * coordinates.size()));
}

std::string c99_of(const Robot& robot, const ExportedMachine& exported, const ExportOrigin& origin) {
  const C99 language(exported.recorded.numbers);
  Values values = head(robot, origin);
  add_head(robot, exported, values);
  add_coordinates(exported, values);
  add_search(exported, values);
  add_drives(exported, values);
  values.emplace_back("SET", std::to_string(exported.set.numbers.size() + 2));
  values.emplace_back("EXACT_NUMBERS", number_lines(exported.set, "", true));
  values.emplace_back("CLOSED", exported.recorded.closed.text(language, "  "));
  values.emplace_back("RATES", exported.recorded.rates.text(language, "  "));
  values.emplace_back("TEST_VECTOR", test_vector(exported));
  return filled_template("compensator_c99.h", values);
}

}  // namespace

ExportedSet exported_set(const Robot& robot, const SourceErrors& errors, const DriveCurves& drives) {
  const CommandCurves curves = compensator_parameters(robot, errors, drives).drives;
  ParameterSet set = parameter_set(record(built_for_export(robot, errors)), robot.nominal(), curves);
  ExportedSet exported{std::move(set.names), std::move(set.numbers)};
  exported.set.insert(exported.set.end(), {set.layout, set.sum});
  return exported;
}

std::string c99_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                       const DriveCurves& drives) {
  return c99_of(robot, ExportedMachine(robot, errors, origin, drives), origin);
}

std::string linuxcnc_component(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                               const DriveCurves& drives) {
  const ExportedMachine exported(robot, errors, origin, drives);
  Values values = head(robot, origin);
  add_head(robot, exported, values);
  add_axes(exported, values);
  add_shown_units(exported, values);
  values.emplace_back("C99", c99_of(robot, exported, origin));
  return filled_template("paracal_kins.comp", values);
}

}  // namespace paracal
