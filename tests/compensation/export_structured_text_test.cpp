// The exported Structured Text on every robot, in an interpreter that stops where a controller might.

#include <regex>

#include "export_law.hpp"
#include "support/structured_text/program.hpp"

namespace paracal::test::export_structured_text_test {
namespace {

using StructuredTextLaw = ExportLaw;

std::string joint_name(const Robot& robot, std::size_t limb) {
  return fmt::format("joint_{}_{}", limb + 1, robot.actuator() == Actuator::linear ? "mm" : "rad");
}

/// The compensator of an exported text.
class CompensatorBlock {
 public:
  CompensatorBlock(const Robot& robot, const std::string& text) : robot_(robot), block_(text, "paracal_compensator") {}

  Answer answer_to(const CompensatorPose<double>& pose) {
    block_.set("x_mm", pose.x);
    block_.set("y_mm", pose.y);
    block_.set("z_mm", pose.z);
    block_.set("phi_rad", pose.phi);
    block_.run();
    Answer answer{.status = static_cast<int>(block_.get("status")), .joints = {}, .tilt = {}};
    for (std::size_t i = 0; i < robot_.limb_count(); ++i) answer.joints[i] = block_.get(joint_name(robot_, i));
    answer.tilt = {block_.get("tilt_x_rad"), block_.get("tilt_y_rad")};
    return answer;
  }

  const FunctionBlock& block() const { return block_; }

 private:
  const Robot& robot_;
  FunctionBlock block_;
};

TEST_P(StructuredTextLaw, GivesTheLibrarysJoints) {
  CompensatorBlock block(robot, structured_text(robot, errors, kOrigin));
  const auto answer_to = [&](const CompensatorPose<double>& pose) { return block.answer_to(pose); };
  hold_to_the_library(answer_to);
  survive_bad_poses(answer_to);
  judge_poses_anywhere(answer_to);
}

TEST_P(StructuredTextLaw, PassesItsSelfTestAPoseACall) {
  const std::string text = structured_text(robot, errors, kOrigin);
  const auto failed = [](const std::string& program) {
    FunctionBlock block(program, "paracal_self_test");
    int calls = 0;
    for (; block.get("done") == 0.0; ++calls) block.run();
    EXPECT_EQ(calls, 19);
    block.run();
    return static_cast<int>(block.get("failed"));
  };
  EXPECT_EQ(failed(text), 0);
  const std::string arm = "limb_2_arm : LREAL := ";  // the first is the compensator's
  std::string damaged = text;
  damaged.insert(damaged.find(arm) + arm.size(), "1");
  EXPECT_EQ(failed(damaged), 1);
}

TEST_P(StructuredTextLaw, FindsTheWayBack) {
  const std::string text = structured_text(robot, errors, kOrigin);
  FunctionBlock forward(text, "paracal_forward");
  const auto give = [&](const CompensatorJoints<double>& joints) {
    for (std::size_t i = 0; i < robot.limb_count(); ++i) forward.set(joint_name(robot, i), joints[i]);
    forward.run();
    return static_cast<int>(forward.get("status"));
  };
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Pose pose = random.pose(robot);
    ASSERT_EQ(give(expected(compensator_pose(pose)).joints), 0) << k;
    const Eigen::Vector3d found(forward.get("x_mm"), forward.get("y_mm"), forward.get("z_mm"));
    worst = std::max(worst, (found - pose.position).norm());
    EXPECT_NEAR(forward.get("phi_rad"), pose.rotation, 1e-9);
  }
  EXPECT_LT(worst, 1e-8);
  const double last = forward.get("x_mm");
  EXPECT_EQ(give({std::nan(""), 0.0, 0.0, 0.0}), 2);
  const double far = robot.actuator() == Actuator::linear ? 5000.0 : 3.0;
  EXPECT_NE(give({far, -far, far, -far}), 0);
  EXPECT_EQ(forward.get("x_mm"), last);
}

/// Divisors that are no constants may become 0 somewhere, where no test looks.
TEST_P(StructuredTextLaw, EveryDivisorIsGuarded) {
  const std::string text = structured_text(robot, errors, kOrigin);
  const std::regex division(R"(/ ([a-z]\w*(\[\d+\])?))");
  std::size_t divisions = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), division), end; at != end; ++at) {
    const std::string divisor = at->str(1);
    if (divisor == "x" || divisor == "y" || divisor.starts_with("limb_")) continue;  // of paracal_atan2; lengths
    const std::string guard = fmt::format("IF ABS({0}) < 1.0E-60 THEN held := FALSE; {0} := 1.0; END_IF;", divisor);
    const std::size_t block = text.rfind("FUNCTION_BLOCK paracal", static_cast<std::size_t>(at->position()));
    EXPECT_LT(text.find(guard, block), static_cast<std::size_t>(at->position())) << divisor;
    ++divisions;
  }
  EXPECT_GT(divisions, robot.limb_count());
  EXPECT_EQ(text.find("/ ("), std::string::npos);
}

TEST_P(StructuredTextLaw, AnglesAreRightInAllQuadrants) {
  const bool tilts = parameters().tilts_plate != 0;
  const std::string probe =
      "FUNCTION_BLOCK probe\nVAR_INPUT\n  a : LREAL;\n  b : LREAL;\nEND_VAR\nVAR_OUTPUT\n  angle : LREAL;\n"
      "  cosine : LREAL;\n  sine : LREAL;\nEND_VAR\n  angle := paracal_atan2(a, b);\n";
  const std::string turns = "  cosine := paracal_turn_cosine(a);\n  sine := paracal_turn_sine(a);\n";
  FunctionBlock block(structured_text(robot, errors, kOrigin) + probe + (tilts ? turns : "") + "END_FUNCTION_BLOCK\n",
                      "probe");
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
  const std::string text = structured_text(robot, errors, kOrigin);
  const std::regex said(
      R"((\d+) additions, (\d+) multiplications, (\d+) divisions, (\d+) square roots, (\d+) arctangents)");
  std::smatch counts;
  ASSERT_TRUE(std::regex_search(text, counts, said));
  const bool tilts = parameters().tilts_plate != 0;
  const bool on_rails = robot.actuator() == Actuator::linear;
  CompensatorBlock block(robot, text);
  for (int k = 0; k < 1000; ++k) {
    const StructuredTextWork before = block.block().work();
    ASSERT_EQ(block.answer_to(compensator_pose(random.pose(robot))).status, 0);
    if (tilts && block.block().get("count") != 4.0) continue;
    const StructuredTextWork& after = block.block().work();
    // On top come the tests of four steps, two products each, and the quotient of an arctangent.
    const std::size_t arctangents = on_rails ? 0 : robot.limb_count();
    EXPECT_EQ(after.multiplications - before.multiplications, std::stoul(counts[2]) + (tilts ? 8 : 0));
    EXPECT_EQ(after.divisions - before.divisions, std::stoul(counts[3]) + arctangents);
    EXPECT_EQ(after.square_roots - before.square_roots, std::stoul(counts[4]));
    EXPECT_EQ(std::stoul(counts[5]), arctangents);
    return;
  }
  ADD_FAILURE() << "no pose took four steps";
}

PARACAL_ON_EVERY_EXPORT(StructuredTextLaw);

}  // namespace
}  // namespace paracal::test::export_structured_text_test
