#include "paracal/calibration/plan.hpp"

#include <gtest/gtest.h>

#include "paracal/error.hpp"
#include "support/robots.hpp"

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

PARACAL_ON_EVERY_ROBOT(PlanLaw);

}  // namespace
}  // namespace paracal::plan_test
