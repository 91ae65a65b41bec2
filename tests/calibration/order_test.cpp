// What goes with the order of the readings: when each was taken, from which side joints came, what drifts.

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calibration/fit/sought.hpp"
#include "calibration/variances/order_effects.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::order_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

constexpr double kNoise = 0.017;  // mm

/// Where the visits of each pose stand together, time may be that of the rows or that of passes over the poses.
struct Visit {
  std::size_t station = 0;
  double time = 0.0;  ///< from 0 to 1, as it was
};

class Order : public testing::Test {
 protected:
  static std::vector<Visit> in_passes(std::size_t poses, std::size_t visits) {
    std::vector<Visit> all;
    for (std::size_t k = 0; k < poses * visits; ++k) {
      all.push_back({k % poses, static_cast<double>(k) / static_cast<double>(poses * visits - 1)});
    }
    return all;
  }
  static std::vector<Visit> sorted_by_pose(std::vector<Visit> all) {
    std::ranges::stable_sort(all, {}, &Visit::station);
    return all;
  }
  detail::StageFit fit(const Measurements& measured) const {
    detail::StageFit stage(robot, measured, options, detail::all_with_priors(robot, options), {});
    stage.settle();
    return stage;
  }
  /// Reads a machine that changes with time: machine(time), then reading(point, time).
  template <typename MachineAt, typename JointsAt>
  Measurements read(const std::vector<Visit>& visits, int number, MachineAt&& machine, JointsAt&& moved) const {
    Measurements measured{.stations = stations, .series = {{"tracker", {}}}};
    RandomStream random(23, static_cast<std::uint64_t>(number));
    for (std::size_t k = 0; k < visits.size(); ++k) {
      const Visit& one = visits[k];
      const Joints joints = moved(one.station, k == 0 ? one.station : visits[k - 1].station);
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      measured.series.front().readings.push_back(
          {.station = one.station, .point = forward(machine(one.time), joints).plate.position + kNoise * noise});
    }
    return measured;
  }
  Measurements with_warming(const std::vector<Visit>& visits, int number, Source source, double by) const {
    const SourceErrors errors = measured_machine(robot, stations, number, {}).errors;
    return read(
        visits, number,
        [&](double time) {
          SourceErrors now = errors;
          now(1, source) += by * time;
          return build(robot, now);
        },
        [&](std::size_t to, std::size_t) { return believed_joints(robot, stations[to]); });
  }

  Robot robot = catalogue::rotary_delta();
  std::vector<Station> stations = fine_stations(robot, 16);
  CalibrationOptions options{.states_use = false, .diagnose = false};
};

TEST_F(Order, IsThatOfTheRowsAndOfPassesWhereTheyDiffer) {
  const auto machine = [&](double) { return build(robot, {}); };
  const auto joints = [&](std::size_t to, std::size_t) { return believed_joints(robot, stations[to]); };
  const auto orders_of = [&](const std::vector<Visit>& visits) {
    return detail::reading_orders(fit(read(visits, 1, machine, joints)).observation());
  };
  ASSERT_EQ(orders_of(in_passes(stations.size(), 3)).size(), 1U);
  const auto both = orders_of(sorted_by_pose(in_passes(stations.size(), 3)));
  ASSERT_EQ(both.size(), 2U);
  const Eigen::VectorXd rows = both[0]->drift.col(0), passes = both[1]->drift.col(0);
  EXPECT_NEAR(rows(1) - rows(0), 2.0 / static_cast<double>(rows.size() - 1), 1e-12);
  EXPECT_NEAR(passes(1) - passes(0),
              2.0 * static_cast<double>(stations.size()) / static_cast<double>(passes.size() - 1), 1e-12);
  EXPECT_LT(std::abs(rows.sum()), 1e-12);
  EXPECT_FALSE(both[0]->tells_drift);
  EXPECT_TRUE(both[1]->tells_drift);
  EXPECT_LT(both[1]->drift.colwise().sum().cwiseAbs().maxCoeff(), 1e-12);
}

/// Only poses that are visited again, later, tell drift from errors of parts: else the result says what it takes for
/// granted.
TEST_F(Order, NoPoseAgainIsAnAssumption) {
  const auto machine = [&](double) { return build(robot, {}); };
  const auto joints = [&](std::size_t to, std::size_t) { return believed_joints(robot, stations[to]); };
  const auto assumed = [&](const std::vector<Visit>& visits) {
    return calibrate(robot, read(visits, 1, machine, joints), options).assumed;
  };
  EXPECT_THAT(assumed(in_passes(stations.size(), 2)), Each(Not(HasSubstr("nothing drifted"))));
  EXPECT_THAT(assumed(sorted_by_pose(in_passes(stations.size(), 2))), Contains(HasSubstr("nothing drifted")));
}

TEST_F(Order, ShowsFromWhichSideEachJointCame) {
  const auto machine = [&](double) { return build(robot, {}); };
  const auto joints = [&](std::size_t to, std::size_t) { return believed_joints(robot, stations[to]); };
  const Measurements measured = read(in_passes(stations.size(), 2), 1, machine, joints);
  const auto orders = detail::reading_orders(fit(measured).observation());
  const Eigen::MatrixXd& sides = orders.front()->sides;
  EXPECT_TRUE(sides.row(0).isZero());
  const Joints first = believed_joints(robot, stations[0]), second = believed_joints(robot, stations[1]);
  for (Eigen::Index k = 0; k < first.size(); ++k) EXPECT_EQ(sides(1, k), second(k) > first(k) ? 1.0 : -1.0);
  EXPECT_EQ(sides.row(std::ssize(stations) + 1), sides.row(1));  // the same way in the second pass
}

/// A correction is what a reading that is less by as much would do, whatever the factor of its noise.
TEST_F(Order, WhatIsTakenOffAReadingIsGone) {
  const auto machine = [&](double) { return build(robot, {}); };
  const auto joints = [&](std::size_t to, std::size_t) { return believed_joints(robot, stations[to]); };
  const Measurements measured = read(in_passes(stations.size(), 3), 2, machine, joints);
  detail::StageFit stage = fit(measured);
  detail::Observation& observation = stage.observation_to_change();
  observation.noise().front().unstated = 2.5;
  const Eigen::VectorXd unknowns = stage.fit().parameters;
  const auto rows_of = [&](std::size_t place) {
    Eigen::MatrixXd rows;
    observation.rows(observation.groups()[place], *observation.stations(unknowns), unknowns, rows);
    return Eigen::VectorXd(rows.rightCols<1>());
  };
  const Eigen::VectorXd before = rows_of(5), other = rows_of(6);
  const Eigen::Vector3d off(0.3, -0.2, 0.1);
  observation.take_off(5, off);
  observation.take_off(5, off);
  EXPECT_LT((rows_of(5) - before - 2.0 * off).norm(), 1e-12);
  EXPECT_EQ(rows_of(6), other);
}

TEST_F(Order, AnArmThatWarmsIsNamedWhicheverWayTheVisitsAreListed) {
  for (const bool sorted : {false, true}) {
    const std::vector<Visit> passes = in_passes(stations.size(), 3);
    const Calibration found =
        calibrate(robot, with_warming(sorted ? sorted_by_pose(passes) : passes, 3, "arm_length", 0.15), options);
    EXPECT_THAT(found.notes, Contains(AllOf(HasSubstr("arm_length of limb 2"), HasSubstr("drifts along the order"))));
    EXPECT_THAT(found.notes, Each(Not(HasSubstr("does not repeat"))));
    EXPECT_NEAR(found.noise, kNoise, 0.15 * kNoise);
    // The machine of the mean time, and a U that reaches to both ends.
    const ParameterEstimate& arm = *std::ranges::find_if(found.parameters, [](const ParameterEstimate& one) {
      return one.limb == 1 && one.source == Source("arm_length");
    });
    EXPECT_GT(*arm.std, 0.15 / std::sqrt(12.0));
  }
}

/// Backlash by direction is told from joints that stop anywhere, and only a single visit is worse for it.
TEST_F(Order, BacklashByDirectionIsMeasured) {
  const double half = to_radians(0.01);
  Joints sides = Joints::Zero(3);
  const SourceErrors errors = measured_machine(robot, stations, 4, {}).errors;
  const Machine machine = build(robot, errors);
  const Measurements measured = read(
      in_passes(stations.size(), 3), 4, [&](double) { return machine; },
      [&](std::size_t to, std::size_t from) {
        const Joints there = believed_joints(robot, stations[to]), here = believed_joints(robot, stations[from]);
        if (to != from) sides(1) = there(1) > here(1) ? -half : half;
        return Joints(there + sides);
      });
  const Calibration found = calibrate(robot, measured, options);
  EXPECT_THAT(found.notes, Contains(AllOf(HasSubstr("the joint of limb 2 stops elsewhere by the direction"),
                                          HasSubstr("backlash 0.0"))));
  EXPECT_NEAR(found.visit_std(1), half, 0.15 * half);
  EXPECT_LT(std::max(found.visit_std(0), found.visit_std(2)), 0.2 * half);
  EXPECT_LT(found.joint_std.maxCoeff(), 0.2 * half);
}

}  // namespace
}  // namespace paracal::test::order_test
