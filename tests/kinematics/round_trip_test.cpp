// The joints of a pose lead back to it, whatever the robot and wherever its frame begins.

#include "paracal/kinematics/round_trip.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "paracal/error.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "support/robots.hpp"

namespace paracal::round_trip_test {
namespace {

using test::Random;
using testing::AllOf, testing::HasSubstr, testing::ThrowsMessage;

Robot robot_of(const std::string& text) { return io::read_robot({"robot.toml", text}); }

/// Largest distance of a pose from where its joints lead, mm or rad; of nominal machines, or with errors.
double off(const Robot& robot, int poses, double errors_mm = 0.0) {
  Random random;
  double worst = 0.0;
  for (int k = 0; k < poses; ++k) {
    const Machine machine = build(robot, random.errors(robot, errors_mm, 0.005 * errors_mm));
    const Pose pose = random.pose(robot);
    const InverseResult joints = inverse(machine, pose);
    EXPECT_TRUE(joints.ok());
    const ForwardResult back = forward(machine, joints.joints);
    EXPECT_TRUE(back.ok()) << why_no_pose(machine, back);
    worst = std::max({worst, (back.plate.position - pose.position).norm(),
                      robot.commands_tilt() ? (back.plate.tilt - pose.tilt).norm() : 0.0});
  }
  return worst;
}

/// Limbs hung from points 4 m above the floor, or standing on it, and a base frame that begins at any height.
std::string six_struts(double base_z, double top_z) {
  return fmt::format(R"(name = "six"
[[limb]]
kind = "strut"
repeat = 3
mirrored = true
base_joint_mm = [3000, 0, {}]
plate_joint_mm = [500, 866, 0]
length_at_zero_mm = 3500
[workspace]
radius_mm = 400
height_mm = 600
top_z_mm = {}
tilt_deg = 5
)",
                     base_z, top_z);
}

TEST(RoundTrip, IsOnTheSideOfTheWorkspaceWhereverTheFrameBegins) {
  for (const double base : {4000.0, 0.0, -7000.0, 1300.0}) {
    for (const double below : {-2400.0, 3000.0}) {  // hung, standing
      EXPECT_LT(off(robot_of(six_struts(base, base + below)), 100), 1e-9) << base << " " << below;
    }
  }
}

constexpr const char* kThreeArms = R"([[limb]]
kind = "arm"
repeat = 3
base_joint_mm = [200, 0, 0]
plate_joint_mm = [50, 0, 0]
arm_mm = 200
axis = [0, -1, 0]
arm_at_zero = [1, 0, 0]
rod_mm = 450
parallelogram_width_mm = 80
)";

/// A point on three lines, hung as above; and a Delta with its plate above the arms, or on a wall.
TEST(RoundTrip, IsThatOfAnyMountedRobot) {
  for (const double floor : {0.0, 3000.0, -5000.0}) {
    const std::string lines = fmt::format(R"(name = "lines"
[plate]
freedoms = ["x", "y", "z"]
[[limb]]
kind = "strut"
repeat = 3
base_joint_mm = [2000, 0, {}]
plate_joint_mm = [0, 0, 0]
length_at_zero_mm = 2500
[workspace]
radius_mm = 500
height_mm = 800
top_z_mm = {}
)",
                                          floor + 3000.0, floor + 1500.0);
    EXPECT_LT(off(robot_of(lines), 100), 1e-9) << floor;
  }
  const std::string standing = std::string(R"(name = "standing"
[plate]
freedoms = ["x", "y", "z"]
)") + kThreeArms + R"([workspace]
radius_mm = 120
height_mm = 120
top_z_mm = 450
)";
  EXPECT_LT(off(robot_of(standing), 100, 0.3), 1e-9);
  std::string wall = "name = \"wall\"\n[plate]\nfreedoms = [\"x\", \"y\", \"z\"]\n";
  for (const double turn : {0.0, 2.0, 4.0}) {
    const double c = std::cos(turn * std::numbers::pi / 3.0), s = std::sin(turn * std::numbers::pi / 3.0);
    wall += fmt::format(
        "[[limb]]\nkind = \"arm\"\nbase_joint_mm = [0, {}, {}]\nplate_joint_mm = [0, {}, {}]\narm_mm = 200\n"
        "axis = [0, {}, {}]\narm_at_zero = [0, {}, {}]\nrod_mm = 450\nparallelogram_width_mm = 80\n",
        200 * c, 200 * s, 50 * c, 50 * s, s, -c, c, s);
  }
  wall += "[workspace]\nx_mm = [330, 450]\ny_mm = [-80, 80]\nz_mm = [-80, 80]\n";
  EXPECT_LT(off(robot_of(wall), 100, 0.3), 1e-9);
}

/// Cables of 100 m hold a cabin of 4 m: the way it is assembled is decided by less than its own size.
constexpr const char* kCabin = R"(name = "cabin"
[[limb]]
kind = "strut"
repeat = 3
mirrored = true
base_joint_mm = [86603, 50000, 0]
plate_joint_mm = [1100, 1900, 0]
length_at_zero_mm = 100000
[workspace]
radius_mm = 20000
height_mm = 10000
top_z_mm = -36000
tilt_deg = 5
)";

/// Far below the workspace: the mirror image above the carriages lies inside of it, and is not meant.
TEST(RoundTrip, HoldsFarOutsideOfTheWorkspaceOfRails) {
  const Machine& machine = catalogue::linear_delta().nominal();
  for (double z = -150.0; z > -1500.0; z -= 50.0) {
    const Pose pose{{20.0, -10.0, z}, 0.0};
    const InverseResult joints = inverse(machine, pose);
    ASSERT_TRUE(joints.ok());
    const ForwardResult found = forward(machine, joints.joints);
    EXPECT_TRUE(found.ok()) << z;
    EXPECT_LT((found.plate.position - pose.position).norm(), 1e-9) << z;
  }
}

TEST(RoundTrip, IsInTheModeOfTheWorkspace) { EXPECT_LT(off(robot_of(kCabin), 120), 1e-9); }

/// A plate that tilts on parallelograms: as long as their bars are parallel to its axis closed form is exact, and with
/// bars that lean it is not, although every error is one of position.
TEST(RoundTrip, HoldsWhereParallelogramsLeanUnderATiltedPlate) {
  const Robot robot = test::robot_named("mixed_limbs");
  Random random;
  for (int k = 0; k < 100; ++k) {
    SourceErrors errors = random.errors(robot, 1.0, 0.01);
    for (const Parameter& one : robot.parameters()) {
      if (tilts_plate(one.source)) errors(one.limb, one.source) = 0.0;
    }
    const Machine machine = build(robot, errors);
    const Pose pose = random.pose(robot);
    const ForwardResult back = forward(machine, inverse(machine, pose).joints);
    ASSERT_TRUE(back.ok());
    EXPECT_LT((back.plate.position - pose.position).norm(), 1e-9);
  }
}

/// Three parallelograms and a single rod: the bars are parallel to the arms' axes, so that nothing turns about z.
TEST(RoundTrip, OfTiltsThatParallelogramsCannotFollowIsRefused) {
  const std::string yaw = std::string(R"(name = "yaw"
[plate]
freedoms = ["x", "y", "z", "tilt_z"]
)") + kThreeArms + R"([[limb]]
kind = "arm"
base_joint_mm = [180, 120, 0]
plate_joint_mm = [10, 60, 0]
arm_mm = 200
axis = [1, 0, 0]
arm_at_zero = [0, 1, 0]
rod_mm = 450
[workspace]
radius_mm = 60
height_mm = 80
top_z_mm = -330
tilt_deg = 15
)";
  EXPECT_THAT([&] { (void)robot_of(yaw); },
              ThrowsMessage<InputFileError>(HasSubstr("expected no tilt_z for limb 1 with two rods")));
}

/// A 4-RRR: four arms hold three degrees of freedom, and with errors their joints disagree.
constexpr const char* kSpare = R"(name = "spare"
[plate]
freedoms = ["x", "y", "tilt_z"]
[[limb]]
kind = "arm"
repeat = 4
base_joint_mm = [300, 0, 0]
plate_joint_mm = [50, 20, 0]
arm_mm = 180
axis = [0, 0, 1]
arm_at_zero = [0.2, 1, 0]
rod_mm = 260
[workspace]
radius_mm = 40
tilt_deg = 8
)";

/// Rods that miss by a millimetre still have a least-squares pose, and it is found in a few steps.
TEST(RoundTrip, OfSpareLimbsThatDisagreeIsTheLeastSquaresPose) {
  const Robot robot = robot_of(kSpare);
  Random random;
  double most = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Machine machine = build(robot, random.errors(robot, 1.0, 0.01));
    const Pose pose = random.pose(robot);
    const ForwardResult back = forward(machine, inverse(robot.nominal(), pose).joints);
    ASSERT_TRUE(back.ok()) << why_no_pose(machine, back);
    EXPECT_LT(back.gradient, 1e-9);
    EXPECT_LT(back.iterations, 25);  // half of what it may take
    most = std::max(most, back.residual);
  }
  EXPECT_GT(most, 0.5);
}

TEST(RoundTrip, IsCheckedForEveryRobotAndNamesThePose) {
  const Robot robot = test::robot_named("hexapod");
  EXPECT_NO_THROW(check_round_trip(robot));
  EXPECT_THAT([&] { check_round_trip(robot, {.tolerance = 1e-16}); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("workspace: expected that the joints of each pose lead"),
                                                   HasSubstr("(0, 0, "), HasSubstr("they lead to"))));
}

}  // namespace
}  // namespace paracal::round_trip_test
