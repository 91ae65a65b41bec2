#include "paracal/tolerance/sensitivity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "paracal/error.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/tolerance/response.hpp"
#include "support/robots.hpp"
#include "tolerance/workspace_search.hpp"

namespace paracal::sensitivity_test {
namespace {

std::vector<Characteristic> all_characteristics(const Robot& robot) {
  std::vector<Characteristic> list;
  for (const Quantity quantity : kQuantities) {
    for (const bool compensated : {false, true}) {
      const Characteristic what{quantity, compensated};
      if (why_not_asked(robot, what).empty()) list.push_back(what);
    }
  }
  return list;
}

class SensitivityLaw : public test::EveryRobot {};
PARACAL_ON_EVERY_ROBOT(SensitivityLaw);
PARACAL_ON_HEXAPODS(SensitivityLaw);

/// Every row of the linear model against the exact machine, by central differences, each source of each limb.
TEST_P(SensitivityLaw, RowsAreTheDerivativeOfTheExactComponents) {
  test::Random random(1);
  const std::vector<Characteristic> characteristics = all_characteristics(robot);
  const Response response(robot, characteristics, {random.pose(robot), random.pose(robot)});
  for (Eigen::Index column = 0; column < response.linear().cols(); ++column) {
    const auto& [source, limb, unit, lever, tolerance, as_joint_zero, number] =
        robot.parameters()[static_cast<std::size_t>(column)];
    const double step = unit == Unit::mm ? 1e-3 : 1e-5;
    SourceErrors plus, minus;
    plus(limb, source) = step;
    minus(limb, source) = -step;
    Eigen::VectorXd ahead(response.rows()), behind(response.rows());
    ASSERT_TRUE(response.exact(plus, ahead) && response.exact(minus, behind));
    const Eigen::VectorXd difference = (ahead - behind) / (2.0 * step);
    const double scale = std::max(response.linear().col(column).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_LT((difference - response.linear().col(column)).cwiseAbs().maxCoeff(), 2e-4 * scale)
        << name(source) << " of limb " << limb + 1;
  }
}

TEST_P(SensitivityLaw, ContributorsAddUpToAll) {
  test::Random random(2);
  const LinearModel model(robot);
  for (const Characteristic what : all_characteristics(robot)) {
    const std::vector<Contributor> list =
        contributors(robot, model.rows(random.pose(robot), what), *robot.tolerances());
    double sum = 0.0;
    for (const Contributor& one : list) {
      sum += one.share;
      if (!what.compensated || tilts_plate(one.source)) continue;
      EXPECT_EQ(one.share, 0.0) << name(what);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12) << name(what);
  }
}

TEST_P(SensitivityLaw, NoPoseIsWorseThanTheWorst) {
  test::Random random(3);
  const LinearModel model(robot);
  const Tolerances& tolerances = *robot.tolerances();
  for (const Characteristic what : all_characteristics(robot)) {
    for (const Spread criterion : {Spread::statistical, Spread::worst_case}) {
      const ValueAtPose worst = worst_spread(robot, what, tolerances, criterion);
      EXPECT_NEAR(spread_at(robot, model.rows(worst.pose, what), tolerances, criterion), worst.value,
                  1e-12 * worst.value);
      for (int k = 0; k < 200; ++k) {
        const double value = spread_at(robot, model.rows(random.pose(robot), what), tolerances, criterion);
        ASSERT_LE(value, worst.value * (1.0 + 1e-6)) << name(what) << ", " << name(criterion);
      }
    }
  }
}

/// Of several tops the highest need not have the best point of the grid: generous tolerances, distances of huang2016.
TEST(Sensitivity, TheWorstIsTheHighestTop) {
  const Robot robot = catalogue::huang2016();
  const Tolerances tolerances = tolerances_of(robot);
  const Characteristic distance{Quantity::distance};
  const Pose far{{-396.68, 304.38, -1013.0}, -std::numbers::pi};
  const double there = spread_at(robot, LinearModel(robot).rows(far, distance), tolerances, Spread::statistical);
  EXPECT_GT(there, 9.1);
  EXPECT_GE(worst_spread(robot, distance, tolerances, Spread::statistical).value, there * (1.0 - 1e-6));
}

/// A broad top that holds the grid's best points, and a higher one that is narrow and lies between its points.
TEST(Sensitivity, StartsOfTheSearchAreApart) {
  const Robot robot = catalogue::huang2016();
  const Eigen::Vector3d broad(300.0, 0.0, -888.0), narrow(-396.7, 304.4, -1013.0);
  const auto value = [&](const Pose& pose) {
    return std::max(1.0 - std::pow((pose.position - broad).norm() / 300.0, 2),
                    1.2 - std::pow((pose.position - narrow).norm() / 60.0, 2));
  };
  const ValueAtPose found = detail::largest_in_workspace(robot, value);
  EXPECT_NEAR(found.value, 1.2, 1e-4);
  EXPECT_LT((found.pose.position - narrow).norm(), 1.0);
}

/// The worst pose is refined from the grid that finds it: no step away from it, within the workspace, is worse.
TEST_P(SensitivityLaw, TheWorstIsAPeak) {
  test::Random random(4);
  const LinearModel model(robot);
  const Workspace& workspace = robot.workspace();
  for (const Characteristic what : all_characteristics(robot)) {
    const ValueAtPose worst = worst_spread(robot, what, *robot.tolerances(), Spread::statistical);
    for (int k = 0; k < 200; ++k) {
      Pose near = worst.pose;
      near.position += 0.1 * random.within(workspace.radius);
      const double reach = near.position.head<2>().norm() / workspace.radius;
      near.position.head<2>() /= std::max(reach, 1.0);
      near.position.z() = std::clamp(near.position.z(), workspace.top_z - workspace.height, workspace.top_z);
      near.tilt += 0.1 * random.within(workspace.max_tilt);
      near.tilt = near.tilt.cwiseMin(workspace.max_tilt).cwiseMax(-workspace.max_tilt);
      ASSERT_LE(spread_at(robot, model.rows(near, what), *robot.tolerances(), Spread::statistical),
                worst.value * (1.0 + 1e-4))
          << name(what);
    }
  }
}

/// The rule integrates polynomials of the cylinder exactly.
TEST_P(SensitivityLaw, RuleIntegratesOverTheCylinder) {
  const Workspace& workspace = robot.workspace();
  double all = 0.0, radius2 = 0.0, x2 = 0.0, z = 0.0, phi2 = 0.0;
  Eigen::Vector3d tilt2 = Eigen::Vector3d::Zero();
  for (const WeightedPose& point : volume_rule(robot, 0, true)) {
    all += point.weight;
    radius2 += point.weight * point.pose.position.head<2>().squaredNorm();
    x2 += point.weight * std::pow(point.pose.position.x(), 2);
    z += point.weight * point.pose.position.z();
    phi2 += point.weight * std::pow(point.pose.rotation, 2);
    tilt2 += point.weight * point.pose.tilt.cwiseAbs2();
  }
  EXPECT_NEAR(all, 1.0, 1e-12);
  EXPECT_NEAR(radius2, 0.5 * std::pow(workspace.radius, 2), 1e-6);
  EXPECT_NEAR(x2, 0.25 * std::pow(workspace.radius, 2), 1e-6);
  EXPECT_NEAR(z, workspace.centre().z(), 1e-9);
  EXPECT_NEAR(phi2, std::pow(workspace.max_rotation - workspace.min_rotation, 2) / 12.0, 1e-9);
  for (const double one : tilt2) EXPECT_NEAR(one, std::pow(workspace.max_tilt, 2) / 3.0, 1e-9);
}

/// The stated error of the quadrature holds against a rule with four times the points.
TEST(GlobalSensitivity, StatesItsError) {
  const Robot robot = catalogue::huang2016();
  const GlobalSensitivity stated =
      global_sensitivity(robot, {Quantity::tilt}, {.relative_error = 1e-2, .max_level = 2});
  const GlobalSensitivity fine = mean_sensitivity(robot, {Quantity::tilt}, volume_rule(robot, 3, false));
  for (const Source source : sources_of(robot.actuator()).last(ErrorModel::kTilt)) {
    const Eigen::Index k = place(source);
    EXPECT_LE(std::abs(stated.mean(k) - fine.mean(k)), std::max(stated.error(k), 1e-9 * fine.mean(k)));
  }
}

/// [huang2016, Fig. 5]: the order, and values of an independent program (mean over the cylinder at phi = 0).
TEST(GlobalSensitivity, IsThePapers) {
  const Robot robot = catalogue::huang2016();
  const PerSource mean = (global_sensitivity(robot, {Quantity::tilt}).mean * paper_units(robot)).eval();
  const auto of = [&](Source source) { return mean(place(source)); };
  EXPECT_NEAR(of("rod_difference"), 1.258, 1e-3);
  EXPECT_NEAR(of("width_difference"), 0.323, 1e-3);
  EXPECT_NEAR(of("alpha03"), 1.094, 1e-3);
  EXPECT_NEAR(of("beta03"), 0.516, 1e-3);
  EXPECT_NEAR(of("alpha2"), 1.155, 1e-3);
  EXPECT_NEAR(of("beta2"), 0.313, 2e-3);
  for (const Source source : sources_of(robot.actuator()).first(ErrorModel::kPosition)) EXPECT_EQ(of(source), 0.0);
}

TEST(GlobalSensitivity, RotationNeedsASlide) {
  EXPECT_THROW(global_sensitivity(catalogue::rotary_delta(), {Quantity::rotation}), InvalidArgument);
}

/// Largest length over every corner of the tolerance box, one by one.
double brute_force(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances) {
  std::vector<Eigen::VectorXd> generators;
  for (Eigen::Index column = 0; column < rows.cols(); ++column) {
    const double half_width = tolerances[robot.parameters()[static_cast<std::size_t>(column)].source];
    if (half_width > 0.0) generators.emplace_back(half_width * rows.col(column));
  }
  double largest = 0.0;
  for (std::uint32_t corner = 0; corner < (1U << generators.size()); ++corner) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(rows.rows());
    for (std::size_t k = 0; k < generators.size(); ++k) sum += (corner >> k & 1U ? 1.0 : -1.0) * generators[k];
    largest = std::max(largest, sum.norm());
  }
  return largest;
}

TEST_P(SensitivityLaw, WorstCaseIsTheWorstCorner) {
  test::Random random(4);
  const LinearModel model(robot);
  for (const Characteristic what : all_characteristics(robot)) {
    for (int draw = 0; draw < 3; ++draw) {
      Tolerances tolerances;  // few enough for all corners
      for (const Source source : {Source("rod_difference"), Source("alpha2"), Source("beta03")})
        tolerances[source] = random.uniform(0.0, 1.0);
      const SourceRows rows = model.rows(random.pose(robot), what);
      const WorstCase worst = worst_case(robot, rows, tolerances);
      EXPECT_NEAR(worst.value, brute_force(robot, rows, tolerances), 1e-9 * worst.value) << name(what);
      EXPECT_NEAR((worst_case_weights(robot, rows, worst.direction) * half_widths(tolerances)).sum(), worst.value,
                  1e-9 * worst.value);
    }
  }
}

TEST(Characteristics, NamesReadBack) {
  for (const Quantity quantity : kQuantities) {
    for (const bool compensated : {false, true}) {
      EXPECT_EQ(characteristic_named(name({quantity, compensated})), (Characteristic{quantity, compensated}));
    }
  }
  EXPECT_FALSE(characteristic_named("speed"));
}

/// A model outlives the robot that it was made from.
TEST(LinearModel, KeepsItsRobot) {
  const LinearModel model(catalogue::huang2016());
  const std::vector<std::string> others(100, std::string(200, 'x'));  // take the memory of the temporary
  const Robot robot = catalogue::huang2016();
  const Pose pose{robot.workspace().centre() + Eigen::Vector3d(100, 50, 0), 0.2};
  EXPECT_EQ(model.rows(pose, {Quantity::rotation}), LinearModel(robot).rows(pose, {Quantity::rotation}));
}

}  // namespace
}  // namespace paracal::sensitivity_test
