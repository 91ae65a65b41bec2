#include "paracal/mechanism/robot.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "paracal/error.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::robot_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Nonsense {
  const char* name;
  std::function<void(RobotDescription&)> spoil;
  const char* quantity;
  const char* limit;
};

class RefusedRobot : public ::testing::TestWithParam<Nonsense> {};

TEST_P(RefusedRobot, NamesQuantityAndLimit) {
  RobotDescription description = catalogue::huang2016().description();
  try {
    GetParam().spoil(description);
    const Robot robot(description);
    FAIL() << "was accepted";
  } catch (const InvalidArgument& refusal) {
    EXPECT_THAT(refusal.what(), testing::StartsWith(GetParam().quantity));
    EXPECT_THAT(refusal.what(), testing::HasSubstr(GetParam().limit));
  }
}

const Nonsense kNonsense[] = {
    {"NoName", [](auto& r) { r.name = ""; }, "name", "expected a name"},
    {"NegativeArm", [](auto& r) { test::redimension(r, [](auto& d) { d.arm = -375; }); }, "geometry.arm_mm",
     "above 0 mm, got -375 mm"},
    {"ZeroRod", [](auto& r) { test::redimension(r, [](auto& d) { d.rod = 0; }); }, "geometry.rod_mm",
     "above 0 mm, got 0 mm"},
    {"NanWidth", [](auto& r) { test::redimension(r, [](auto& d) { d.parallelogram_width = kNan; }); },
     "geometry.parallelogram_width_mm", "nan"},
    {"InfiniteBase", [](auto& r) { test::redimension(r, [](auto& d) { d.base_radius = 1 / 0.0; }); },
     "geometry.base_radius_mm", "inf"},
    {"NegativePlate", [](auto& r) { test::redimension(r, [](auto& d) { d.plate_radius = -1; }); },
     "geometry.plate_radius_mm", "above 0 mm"},
    {"TwoLimbsAtOneAzimuth",
     [](auto& r) { test::redimension(r, [](auto& d) { d.limb_azimuth[2] = d.limb_azimuth[0] + to_radians(360); }); },
     "geometry.limb_azimuth_deg", "limbs 1 and 3"},
    {"NanAzimuth", [](auto& r) { test::redimension(r, [](auto& d) { d.limb_azimuth[1] = kNan; }); },
     "geometry.limb_azimuth_deg", "limb 2"},
    {"ThreeLimbsAndASlide", [](auto& r) { r.limbs.pop_back(); }, "limb", "expected 4 to 8 limbs"},
    {"NoSlideDirection", [](auto& r) { r.slide->axis.setZero(); }, "plate.slide_axis", "direction"},
    {"SlideSignOfTwo", [](auto& r) { r.slide->sign[0] = 2; }, "plate.slide_sign", "+1 or -1, got 2"},
    {"ThreeSlideSigns", [](auto& r) { r.slide->sign.pop_back(); }, "plate.slide_sign", "(4), got 3"},
    {"OneSlideSignForAll",
     [](auto& r) {
       r.slide->sign = {1, 1, 1, 1};
     },
     "plate.slide_sign", "both signs"},
    {"NegativePinion", [](auto& r) { r.slide->pinion_radius = -12; }, "plate.pinion_radius_mm", "above 0 mm"},
    {"FlatWorkspace", [](auto& r) { r.workspace.height = 0; }, "workspace.height_mm", "above 0 mm"},
    {"RotationTheWrongWayRound", [](auto& r) { r.workspace.min_rotation = 4; }, "workspace.rotation_deg",
     "[smallest, largest]"},
    {"WorkspaceTooDeep", [](auto& r) { r.workspace.top_z = -1200; }, "workspace: limb", "its rod_mm is 950"},
    {"WorkspaceTooWide", [](auto& r) { r.workspace.radius = 900; }, "workspace: limb", "cannot reach"},
    {"NegativeTolerance", [](auto& r) { (*r.tolerances)["alpha2"] = -1; }, "tolerances.alpha2", "at least 0"},
};

INSTANTIATE_TEST_SUITE_P(Geometry, RefusedRobot, ::testing::ValuesIn(kNonsense),
                         [](const auto& nonsense) { return nonsense.param.name; });

TEST(Robot, RigidPlateDoesNotTurn) {
  RobotDescription description = catalogue::rotary_delta().description();
  description.workspace.max_rotation = 1.0;
  EXPECT_THROW(Robot{description}, InvalidArgument);
}

TEST(Robot, RailsThatAreTooFarAwayAreNamed) {
  RobotDescription description = catalogue::linear_delta().description();
  test::redimension(description, [](auto& shared) { shared.arm = 0.0; });  // the elbows run on the rails themselves
  EXPECT_NO_THROW(Robot{description});
  test::redimension(description, [](auto& shared) { shared.base_radius = 230.0; });
  EXPECT_THAT([&] { Robot{description}; },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("its rail needs a rod of at least 3")));
}

/// A drive that stands still, or goes backward, is none; a gain of a metre in a metre is no error.
TEST(Robot, DrivesGoForward) {
  for (const char* name : {"linear_delta", "hexapod", "6-pss"}) {
    const Robot robot = test::robot_named(name);
    RobotDescription description = robot.description();
    description.limbs[1].gain = -999.0;
    EXPECT_NO_THROW(build(description, SourceErrors{})) << name;
    SourceErrors errors;
    errors(1, "gain") = -999.0;
    EXPECT_EQ(implausible(robot, errors), std::nullopt) << name;
    errors(1, "gain") = -1000.0;
    EXPECT_THAT(*implausible(robot, errors), testing::HasSubstr("gain of limb 2 within 1000 mm/m")) << name;
    description.limbs[1].gain = -1000.0;
    EXPECT_THAT([&] { Robot{description}; }, testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr(
                                                 "drive of limb 2 to move in the direction of its joint")))
        << name;
  }
}

class NominalErrors : public test::EveryRobot {};

/// Errors of the position group move a limb alike whether they are of the machine or of the design.
TEST_P(NominalErrors, AreErrorsOfTheMachine) {
  test::Random random;
  const SourceErrors nominal = without_tilt_group(random.errors(robot, 2.0, 0.02)),
                     more = random.errors(robot, 1.0, 0.01);
  RobotDescription design = robot.description();
  design.limbs = with_errors(design.limbs, nominal);
  const Machine one = build(design, more), other = build(robot, nominal + more);
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    const Limb &a = one.limbs[i], &b = other.limbs[i];
    EXPECT_LT((as_eigen(a.base) - as_eigen(b.base)).norm() + (as_eigen(a.plate) - as_eigen(b.plate)).norm(), 1e-12);
    EXPECT_LT(std::abs(a.rod[0] - b.rod[0]) + std::abs(a.rod[1] - b.rod[1]) + std::abs(a.arm - b.arm), 1e-12);
    EXPECT_LT(std::abs(a.joint_offset - b.joint_offset) + std::abs(a.gain() - b.gain()), 1e-12);
    EXPECT_LT((as_eigen(a.plate_half) - as_eigen(b.plate_half)).norm(), 1e-12);
    if (a.is_strut()) continue;  // its frame is a name for directions: nothing of its closure
    EXPECT_LT((a.frame() - b.frame()).norm(), 1e-14);
  }
}

PARACAL_ON_EVERY_ROBOT(NominalErrors);
PARACAL_ON_UNUSUAL_ROBOTS(NominalErrors);
PARACAL_ON_ROBOT_TEMPLATES(NominalErrors);

/// Which way is outward of an upright rail does not follow its foot.
TEST(Limbs, AnUprightRailKeepsItsNormalWhereItsFootIsMoved) {
  LimbDescription rail;
  rail.kind = Actuator::carriage;
  rail.base = {200.0, 0.0, 0.0};
  rail.axis = Eigen::Vector3d::UnitZ();
  SourceErrors errors;
  errors(0, "across") = 5.0;
  const LimbDescription moved = with_errors({rail}, errors).front();
  EXPECT_NEAR(moved.base.y(), -5.0, 1e-12);
  EXPECT_LT((frame_of(moved) - frame_of(rail)).norm(), 1e-15);
}

/// Sines and cosines round; what a file states comes back as it was stated.
TEST(Limbs, TheShortFormComesBackToTheLastDigit) {
  for (int k = 0; k < 100; ++k) {
    SharedDimensions stated{.base_radius = 187.3 + 0.1 * k,
                            .plate_radius = 41.7,
                            .arm = 301.9,
                            .rod = 711.3,
                            .parallelogram_width = 50.0,
                            .limb_azimuth = {0.1 * k, 0.1 * k + 2.0, 0.1 * k - 2.1}};
    stated.base_radius = std::round(10.0 * stated.base_radius) / 10.0;
    const SharedDimensions found = *shared_dimensions(limbs_of(stated));
    EXPECT_EQ(found.base_radius, stated.base_radius);
    EXPECT_EQ(found.plate_radius, stated.plate_radius);
    EXPECT_EQ(found.rod, stated.rod);
    EXPECT_EQ(found.limb_azimuth, stated.limb_azimuth);
    for (const Source source : all_sources()) EXPECT_EQ(found.differences(1, source), 0.0) << name(source);
  }
}

TEST(Robot, HuangsDimensionsAreTable1) {
  const Robot robot = catalogue::huang2016();
  const SharedDimensions g = *shared_dimensions(robot.limbs());
  EXPECT_EQ(g.base_radius, 200.0);
  EXPECT_EQ(g.plate_radius, 75.0);
  EXPECT_EQ(g.arm, 375.0);
  EXPECT_EQ(g.rod, 950.0);
  EXPECT_EQ(g.parallelogram_width, 100.0);
  EXPECT_EQ(robot.slide()->pinion_radius, 12.0);
  EXPECT_EQ(robot.workspace().radius, 500.0);
  EXPECT_EQ(robot.workspace().centre(), Eigen::Vector3d(0, 0, -888));
}

TEST(Catalogue, UnknownNameListsTheKnownOnes) {
  EXPECT_THAT([] { return catalogue::find("stewart"); },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("huang2016, rotary_delta, linear_delta")));
}

}  // namespace
}  // namespace paracal::robot_test
