// The exported Structured Text on every robot, in an interpreter that stops where a controller might.

#include <regex>
#include <span>

#include "export_law.hpp"
#include "paracal/error.hpp"
#include "support/structured_text/program.hpp"

namespace paracal::test::export_structured_text_test {
namespace {

using StructuredTextLaw = ExportLaw;

std::string joint_name(const Robot& robot, std::size_t limb) {
  const bool in_mm = joint_unit(robot.nominal().limbs.at(limb).actuator) == Unit::mm;
  return fmt::format("joint_{}_{}", limb + 1, in_mm ? "mm" : "rad");
}

std::string coordinate_name(const Robot& robot, std::size_t place) {
  constexpr std::array kNames{"x_mm", "y_mm", "z_mm", "tilt_x_rad", "tilt_y_rad", "tilt_z_rad"};
  return place == 5 && robot.slide() ? "phi_rad" : kNames.at(place);
}

void give(FunctionBlock& block, const Robot& robot, Pose pose) {
  for (const std::size_t place : commanded_of(robot)) {
    block.set(coordinate_name(robot, place), coordinate(pose, robot, place));
  }
  if (robot.is_level()) block.set("phi_rad", pose.rotation);
}

/// The compensator of an exported text.
class CompensatorBlock {
 public:
  CompensatorBlock(const Robot& robot, const std::string& text) : robot_(robot), block_(text, "paracal_compensator") {}

  Answer answer_to(const Pose& pose) {
    give(block_, robot_, pose);
    block_.run();
    Answer answer{.status = static_cast<int>(block_.get("status")), .joints = {}, .tilt = {}};
    for (std::size_t i = 0; i < robot_.limb_count(); ++i) answer.joints.at(i) = block_.get(joint_name(robot_, i));
    const auto& free = robot_.nominal().freedoms.free;
    const auto tilt = [&](std::size_t k, const char* name) {
      return free.at(3 + k) || robot_.nominal().has_guides ? 0.0 : block_.get(name);
    };
    answer.tilt = {tilt(0, "tilt_x_rad"), tilt(1, "tilt_y_rad"), tilt(2, "tilt_z_rad")};
    return answer;
  }

  const FunctionBlock& block() const { return block_; }

 private:
  const Robot& robot_;
  FunctionBlock block_;
};

TEST_P(StructuredTextLaw, GivesTheLibrarysJoints) {
  CompensatorBlock block(robot, structured_text(robot, errors, kOrigin, drives));
  const auto answer_to = [&](const Pose& pose) { return block.answer_to(pose); };
  hold_to_the_library(answer_to);
  survive_bad_poses(answer_to);
  judge_poses_anywhere(answer_to);
}

TEST_P(StructuredTextLaw, PassesItsSelfTestAPoseACall) {
  const std::string text = structured_text(robot, errors, kOrigin, drives);
  const auto failed = [](const std::string& program) {
    FunctionBlock block(program, "paracal_self_test");
    int calls = 0;
    for (; block.get("done") == 0.0; ++calls) block.run();
    EXPECT_EQ(calls, std::stoi(program.substr(program.find("at start, one of ") + 17)));
    EXPECT_GE(calls, 7);
    block.run();
    return static_cast<int>(block.get("failed"));
  };
  EXPECT_EQ(failed(text), 0);
  std::string damaged = text;
  const std::string numbers = "  num : ARRAY";
  damaged.insert(damaged.find('[', damaged.find(":=", damaged.find(numbers))) + 6, "1");
  EXPECT_EQ(failed(damaged), 1);
}

TEST_P(StructuredTextLaw, FindsTheWayBack) {
  const std::string text = structured_text(robot, errors, kOrigin, drives);
  FunctionBlock forward(text, "paracal_forward");
  const auto give_joints = [&](const CompensatorJoints<double>& joints) {
    for (std::size_t i = 0; i < robot.limb_count(); ++i) forward.set(joint_name(robot, i), joints.at(i));
    forward.run();
    return static_cast<int>(forward.get("status"));
  };
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    Pose pose = random.pose(robot);
    ASSERT_EQ(give_joints(expected(pose).joints), 0) << k;
    for (const std::size_t place : commanded_of(robot)) {
      const double found = forward.get(coordinate_name(robot, place));
      worst = std::max(worst, std::abs(found - coordinate(pose, robot, place)));
    }
  }
  EXPECT_LT(worst, 1e-8);
  const double last = forward.get("x_mm");
  EXPECT_EQ(give_joints({std::nan(""), 0.0, 0.0, 0.0}), 2);
  EXPECT_EQ(forward.get("x_mm"), last);
  if (!robot.is_level()) return;
  const double far = runs_on_rail(robot.actuator()) ? 5000.0 : 3.0;
  EXPECT_NE(give_joints({far, -far, far, -far}), 0);
  EXPECT_EQ(forward.get("x_mm"), last);
}

TEST_P(StructuredTextLaw, RatesAreThoseOfTheJoints) {
  const std::string text = structured_text(robot, errors, kOrigin, drives);
  FunctionBlock block(text, "paracal_jacobian");
  const auto rates_at = [&](const Pose& pose) {
    give(block, robot, pose);
    block.run();
    EXPECT_EQ(block.get("status"), 0.0);
    std::vector<double> rates;
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      for (const std::size_t place : commanded_of(robot)) {
        rates.push_back(block.get(fmt::format("rate_{}_{}", i + 1, coordinate_name(robot, place))));
      }
    }
    return rates;
  };
  hold_rates(rates_at, std::max(stated_rate_error(text), 1e-7));
}

/// The numbers of a later calibration come in equal parts, without a jump, or not at all.
TEST_P(StructuredTextLaw, ChangesInEqualParts) {
  FunctionBlock block(structured_text(robot, errors, kOrigin, drives), "paracal_changing");
  SourceErrors later;
  for (const Parameter& one : robot.parameters()) later(one.limb, one.source) = 1.2 * errors(one.limb, one.source);
  std::vector<double> set = exported_set(robot, later, drives).set;
  const Pose pose = random.pose(robot);
  give(block, robot, pose);
  const auto stage = [&](std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      block.set("set_at", static_cast<double>(k));
      block.set("set_number", set[k]);
      block.run();
    }
    block.set("set_at", -1.0);
  };
  const auto joint = [&] {
    block.run();
    EXPECT_EQ(block.get("status"), 0.0);
    return block.get(joint_name(robot, 0));
  };
  const auto ask = [&] {
    block.set("change", 0.0);
    block.run();
    block.set("change", 1.0);
    block.set("cycles", 4.0);
    return joint();
  };
  const double first = joint();
  stage(set.size() - 1);
  EXPECT_EQ(ask(), first);
  EXPECT_EQ(block.get("is_refused"), 1.0);
  EXPECT_EQ(block.get("is_changing"), 0.0);
  std::vector<double> another = set_of_another_robot();
  std::swap(set, another);
  stage(set.size());
  EXPECT_EQ(ask(), first);
  EXPECT_EQ(block.get("is_refused"), 1.0);
  std::swap(set, another);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, 0.0}) {
    std::swap(set[3], another[3] = bad);
    stage(set.size());
    EXPECT_EQ(ask(), first);
    EXPECT_EQ(block.get("is_refused"), 1.0) << bad;
    std::swap(set[3], another[3]);
  }
  stage(set.size());
  const double last = drives.commanded(inverse(build(robot, later), pose).joints)(0);
  for (int k = 1; k <= 4; ++k) {
    const double here = k == 1 ? ask() : joint();
    EXPECT_NEAR(here, first + k / 4.0 * (last - first), tolerance()) << k;
    EXPECT_EQ(block.get("is_changing"), k < 4 ? 1.0 : 0.0);
  }
  EXPECT_EQ(block.get("is_refused"), 0.0);
  EXPECT_NEAR(joint(), last, tolerance());
  // A change during a change is refused, and numbers that are written meanwhile spoil the set.
  ask();
  EXPECT_EQ(block.get("is_changing"), 1.0);
  stage(1);
  ask();
  EXPECT_EQ(block.get("is_refused"), 1.0);
  for (int k = 0; k < 4; ++k) joint();
  EXPECT_EQ(block.get("is_changing"), 0.0);
  ask();
  EXPECT_EQ(block.get("is_refused"), 1.0);
}

/// matiec reads every literal as REAL.
TEST_P(StructuredTextLaw, EveryLiteralIsWithinTheRangeOfReal) {
  const std::string text = structured_text(robot, errors, kOrigin, drives);
  const std::regex literal(R"(\b\d+\.\d+(E-?\d+)?)");
  int count = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), literal), end; at != end; ++at, ++count) {
    const double value = std::stod(at->str());
    EXPECT_TRUE(value == 0.0 || (value > 1.2e-38 && value < 3.4e38)) << at->str();
  }
  EXPECT_GT(count, 100);
}

TEST_P(StructuredTextLaw, OneStepIsNearAndFloatIsRefused) {
  ExportOrigin origin = kOrigin;
  origin.variant = ExportVariant::single;
  EXPECT_THROW((void)structured_text(robot, errors, origin, drives), InvalidArgument);
  origin.variant = ExportVariant::one_step;
  CompensatorBlock block(robot, structured_text(robot, errors, origin, drives));
  for (int k = 0; k < 100; ++k) {
    const Pose pose = random.pose(robot);
    const Answer wanted = expected(pose);
    const double worst = worst_of(block.answer_to(pose), wanted);
    EXPECT_LT(worst, 2e-5 * joint_scale(robot));
    EXPECT_EQ(worst > (drives.are_even() ? 1e-14 : 1e-12), parameters().tilts_plate != 0);
  }
}

/// Divisors that are no constants may become 0 somewhere, where no test looks.
TEST_P(StructuredTextLaw, EveryDivisorIsGuarded) {
  const std::string text = structured_text(robot, errors, kOrigin, drives);
  const std::regex division(R"(/ ([a-z]\w*(\[\d+\])?))");
  std::size_t divisions = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), division), end; at != end; ++at) {
    const std::string divisor = at->str(1);
    if (divisor == "x" || divisor == "y" || divisor == "whole") continue;       // of paracal_atan2, and cycles
    if (divisor.starts_with("num") || divisor.starts_with("normal")) continue;  // lengths; guarded in the template
    const std::string guard = fmt::format("IF ABS({0}) < 1.0E-30 THEN held := FALSE; {0} := 1.0; END_IF;", divisor);
    const std::size_t block = text.rfind("FUNCTION_BLOCK paracal", static_cast<std::size_t>(at->position()));
    EXPECT_LT(text.find(guard, block), static_cast<std::size_t>(at->position())) << divisor;
    ++divisions;
  }
  EXPECT_GT(divisions, 0U);
  EXPECT_EQ(text.find("/ ("), std::string::npos);
}

TEST_P(StructuredTextLaw, AnglesAreRightInAllQuadrants) {
  const bool tilts = parameters().tilts_plate != 0;
  const std::string probe =
      "FUNCTION_BLOCK probe\nVAR_INPUT\n  a : LREAL;\n  b : LREAL;\nEND_VAR\nVAR_OUTPUT\n  angle : LREAL;\n"
      "  cosine : LREAL;\n  sine : LREAL;\nEND_VAR\n  angle := paracal_atan2(a, b);\n";
  const std::string turns = "  cosine := paracal_turn_cosine(a);\n  sine := paracal_turn_sine(a);\n";
  FunctionBlock block(
      structured_text(robot, errors, kOrigin, drives) + probe + (tilts ? turns : "") + "END_FUNCTION_BLOCK\n", "probe");
  const std::vector<double> numbers{-3.0, -1.0, -0.2, -0.1, -0.05, 0.0, 0.01, 0.1, 0.11, 1.0, 2.0};
  for (const double a : numbers) {
    for (const double b : numbers) {
      block.set("a", a);
      block.set("b", b);
      block.run();
      EXPECT_NEAR(block.get("angle"), std::atan2(a, b), 1e-15) << a << " " << b;
      if (!tilts) continue;
      EXPECT_NEAR(block.get("cosine"), std::cos(a), 2e-16) << a;
      EXPECT_NEAR(block.get("sine"), std::sin(a), 2e-16) << a;
    }
  }
}

/// What the head says of the work is what is done.
TEST_P(StructuredTextLaw, SaysHowMuchItComputes) {
  if (std::get<1>(GetParam()) == "single") return;  // takes three steps everywhere
  if (!drives.are_even()) return;                   // whose steps vary
  const std::string text = structured_text(robot, errors, kOrigin, drives);
  const std::regex said(R"((\d+) additions, (\d+) multiplications, (\d+) divisions, (\d+) square roots, (\d+) sines)");
  std::smatch counts;
  ASSERT_TRUE(std::regex_search(text, counts, said));
  const bool tilts = parameters().tilts_plate != 0;
  const auto swings = [](const Limb& limb) { return swings_arm(limb.actuator); };
  const auto limbs = std::span(robot.nominal().limbs).first(robot.limb_count());
  CompensatorBlock block(robot, text);
  for (int k = 0; k < 1000; ++k) {
    const StructuredTextWork before = block.block().work();
    ASSERT_EQ(block.answer_to(random.pose(robot)).status, 0);
    if (tilts && block.block().get("count") != 4.0) continue;
    const StructuredTextWork& after = block.block().work();
    // On top come the tests of four steps, two products each, and the quotient of an arctangent.
    const auto arctangents = static_cast<std::size_t>(std::ranges::count_if(limbs, swings));
    EXPECT_EQ(after.multiplications - before.multiplications, std::stoul(counts[2]) + (tilts ? 8 : 0));
    EXPECT_EQ(after.divisions - before.divisions, std::stoul(counts[3]) + arctangents);
    EXPECT_EQ(after.square_roots - before.square_roots, std::stoul(counts[4]));
    EXPECT_EQ(std::stoul(counts[5]) >= arctangents, true);
    EXPECT_TRUE(!robot.is_level() || std::stoul(counts[5]) == arctangents);
    return;
  }
  ADD_FAILURE() << "no pose took four steps";
}

PARACAL_ON_EVERY_EXPORT(StructuredTextLaw);

}  // namespace
}  // namespace paracal::test::export_structured_text_test
