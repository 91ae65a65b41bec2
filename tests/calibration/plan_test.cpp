#include "paracal/calibration/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "paracal/calibration/pose_selection.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::plan_test {
namespace {

const CurvePoint& at(const PaperPlan& plan, int n) {
  for (const CurvePoint& point : plan.curve) {
    if (point.n == n) return point;
  }
  throw InvalidArgument("no such n");
}

/// Changes of O2 as an independent program gives them.
TEST(PaperPlan, RoughStageSettlesAtSixPoints) {
  const PaperPlan plan = paper_plan(catalogue::huang2016(), Stage::rough);
  EXPECT_EQ(plan.n, 6);
  EXPECT_EQ(plan.stations.size(), 7u);
  EXPECT_NEAR(at(plan, 4).change, 0.0243, 1e-4);
  EXPECT_NEAR(at(plan, 5).change, 0.112, 5e-4);
  EXPECT_NEAR(at(plan, 6).change, 0.0021, 1e-4);
}

TEST(PaperPlan, FineStageSettlesAtNinePoints) {
  for (const double start : {45.0, 270.0}) {
    const PaperPlan plan = paper_plan(catalogue::huang2016(), Stage::fine, to_radians(start));
    EXPECT_EQ(plan.n, 9) << start;
    EXPECT_EQ(plan.stations.size(), 19u);
  }
}

TEST(PaperPlan, SaysWhenNothingSettles) {
  const PaperPlan plan = paper_plan(catalogue::huang2016(), Stage::rough, kStartAzimuth, 1e-9);
  EXPECT_EQ(plan.n, 0);
  EXPECT_TRUE(plan.stations.empty());
  EXPECT_EQ(plan.curve.back().n, PaperPlan::kLargest);
}

TEST(PaperPlan, StageMustBeOneOfThePapers) {
  EXPECT_THROW((void)paper_plan(catalogue::huang2016(), Stage::automatic), InvalidArgument);
}

class PlanLaw : public test::EveryRobot {};

TEST_P(PlanLaw, SchemesStayInTheWorkspace) {
  const Workspace& workspace = robot.workspace();
  EXPECT_EQ(validation_stations(robot).size(), 121u);
  for (const std::vector<Station>& stations :
       {rough_stations(robot, 7), fine_stations(robot, 7), validation_stations(robot)}) {
    EXPECT_EQ(stations.front().commanded.position, workspace.centre());
    for (const Station& station : stations) {
      const Eigen::Vector3d& r = station.commanded.position;
      EXPECT_LE(r.head<2>().norm(), workspace.radius + 1e-5);
      EXPECT_LE(r.z(), workspace.top_z);
      EXPECT_GE(r.z(), workspace.top_z - workspace.height);
      EXPECT_NO_THROW((void)believed_joints(robot, station));
    }
  }
}

TEST_P(PlanLaw, BothSchemesSettleSomewhere) {
  EXPECT_GT(paper_plan(robot, Stage::rough, kStartAzimuth, 0.1).n, 0);
  EXPECT_GT(paper_plan(robot, Stage::fine, kStartAzimuth, 0.1).n, 0);
}

TEST_P(PlanLaw, CirclesAreThoseOfTheWorkspaceWhereReachIsFarBeyond) {
  EXPECT_NEAR(fine_stations(robot, 9)[1].commanded.position.head<2>().norm(), robot.workspace().radius, 1e-5);
}

PARACAL_ON_EVERY_ROBOT(PlanLaw);

/// The same with a workspace as wide as it can be, to a thousandth.
Robot as_wide_as_it_can_be(const Robot& robot) {
  Robot widest = robot;
  double low = robot.workspace().radius, high = 10.0 * low;
  while (high - low > 1e-3 * low) {
    RobotDescription wide = robot.description();
    wide.workspace.radius = 0.5 * (low + high);
    try {
      widest = Robot(wide);
      low = wide.workspace.radius;
    } catch (const InvalidArgument&) {
      high = wide.workspace.radius;
    }
  }
  return widest;
}

/// The machine gets to all of them, by its own joints and by those of the nominal one.
bool reaches(const Robot& robot, const SourceErrors& errors, const std::vector<Station>& stations) {
  const Machine machine = build(robot, errors);
  return std::ranges::all_of(stations, [&](const Station& station) {
    const Pose& pose = station.commanded;
    const ForwardOptions from{.start = plate_at(machine, pose)};
    return inverse(machine, pose).ok() && forward(machine, inverse(robot.nominal(), pose).joints, from).ok();
  });
}

double share_that_reaches(const Robot& robot, const std::vector<Station>& stations) {
  const int machines = test::machines({.claim = 10'000, .quick = 500});
  int all = 0;
  for (int number = 0; number < machines; ++number) {
    RandomStream random(77, static_cast<std::uint64_t>(number));
    all += reaches(robot, draw_errors(robot, tolerances_of(robot), random), stations) ? 1 : 0;
  }
  return static_cast<double>(all) / machines;
}

/// At least 99 % of the machines get to all poses of a plan, where many do not reach the whole workspace.
TEST(Plan, MachinesWithinTheTolerancesReachIt) {
  double least = 1.0;
  for (const char* name : {"rotary_delta", "linear_delta", "huang2016", "6-rss", "6-pss", "five-bar", "planar-rails"}) {
    const Robot robot = as_wide_as_it_can_be(test::robot_named(name));
    EXPECT_GE(share_that_reaches(robot, candidate_stations(robot, 200, 1)), 0.99) << name;
    if (!robot.is_level()) continue;
    EXPECT_GE(share_that_reaches(robot, fine_stations(robot, 9)), 0.99) << name;
    EXPECT_GE(share_that_reaches(robot, rough_stations(robot, 9)), 0.99) << name;
    least = std::min(least, share_that_reaches(robot, validation_stations(robot)));
  }
  EXPECT_LT(least, 0.5);
}

}  // namespace
}  // namespace paracal::plan_test
