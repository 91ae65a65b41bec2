// Drives that are uneven along their stroke: where they predict omitted poses they belong to the machine.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <ostream>

#include "numerics/dense.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/compensation/pose_correction.hpp"
#include "paracal/io/json.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/units.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::drives_test {
namespace {

constexpr double kNoise = 0.017;  // mm a coordinate

/// A machine whose joints are off by three harmonics of their stroke.
class UnevenMachine {
 public:
  /// @param off  rad, root mean square; of a carriage what an angle is at the end of a rod.
  UnevenMachine(const Robot& robot, double off, int number)
      : robot_(robot), random_(41, static_cast<std::uint64_t>(number)) {
    errors_ = draw_errors(robot, tolerances_of(robot), random_);
    const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
    low_ = Joints::Constant(limbs, 1e300);
    Joints high = -low_;
    for (const Station& station : workspace_stations(robot)) {
      low_ = low_.cwiseMin(believed_joints(robot, station));
      high = high.cwiseMax(believed_joints(robot, station));
    }
    stroke_ = high - low_;
    const double lever = swings_arm(robot.actuator()) ? 1.0 : robot.nominal().limbs[0].mean_rod();
    waves_ = Eigen::MatrixXd::NullaryExpr(6, limbs, [&] { return lever * off / std::sqrt(3.0) * random_.normal(); });
  }

  Joints actual(Joints joints) const {
    for (Eigen::Index k = 0; k < joints.size(); ++k) {
      const double turn = 2.0 * std::numbers::pi * (joints(k) - low_(k)) / stroke_(k);
      for (int n = 1; n <= 3; ++n) {
        joints(k) += waves_(2 * n - 2, k) * std::sin(n * turn) + waves_(2 * n - 1, k) * std::cos(n * turn);
      }
    }
    return joints;
  }

  Pose at(const Joints& commanded, const Pose& near) const {
    const Machine machine = build(robot_, errors_);
    return pose_of(machine, forward(machine, actual(commanded), {.start = plate_at(machine, near)}).plate);
  }

  Measurements read(const std::vector<Station>& stations, int visits = 3) {
    Measurements plan{.stations = stations, .series = {{"tracker", {}}}};
    for (Station& one : plan.stations) one.believed = actual(believed_joints(robot_, one));
    for (std::size_t k = 0; k < stations.size(); ++k) {
      const PointReading of_pose{.station = k, .point = Eigen::Vector3d::Zero()};
      plan.series.front().readings.insert(plan.series.front().readings.end(), static_cast<std::size_t>(visits),
                                          of_pose);
    }
    Measurements read = simulate(robot_, errors_, plan, {.noise = kNoise}, random_);
    read.stations = stations;  // what the controller believes
    return read;
  }

 private:
  const Robot& robot_;
  RandomStream random_;
  SourceErrors errors_;
  Joints low_, stroke_;
  Eigen::MatrixXd waves_;
};

/// Errors of distances to home that are left at poses that were not measured, root mean square, mm.
double left(const Robot& robot, const KnownErrors& known, const UnevenMachine& machine) {
  const std::vector<Station> others = candidate_stations(robot, 60, 77);
  std::vector<PosePair> pairs;
  double sum = 0.0;
  for (const Station& station : others) {
    const Joints joints = believed_joints(robot, station);
    pairs.push_back({predict(robot, known, joints).pose, machine.at(joints, station.commanded)});
    sum += std::pow(error_relative_to(pairs.front(), pairs.back()).distance, 2);
  }
  return std::sqrt(sum / static_cast<double>(pairs.size() - 1));
}

struct Left {
  int chosen = 0, accepted = 0;
  double rigid = 0.0, now = 0.0;
};

/// Of some machines measured at 40 poses; root mean squares over all.
Left left_by(const Robot& robot, double off, int machines) {
  const std::vector<Station> stations = candidate_stations(robot, 40, 5);
  Left all;
  for (int number = 0; number < machines; ++number) {
    UnevenMachine machine(robot, off, number);
    CalibrationOptions options;
    options.states_use = false;
    const Calibration found = calibrate(robot, machine.read(stations), options);
    all.chosen += found.drive_sizes.size() > 0 ? 1 : 0;
    all.accepted += found.accepted() ? 1 : 0;
    all.rigid += std::pow(left(robot, rigid_errors(found), machine), 2) / machines;
    all.now += std::pow(left(robot, known_errors(found), machine), 2) / machines;
  }
  all.rigid = std::sqrt(all.rigid);
  all.now = std::sqrt(all.now);
  return all;
}

/// How uneven drives of a robot are, and what they must gain.
struct Uneven {
  const char* robot;
  double off_deg;
  int quick;       ///< machines that still fail where what is tested is broken
  double at_most;  ///< of the errors that a rigid machine leaves
};

void PrintTo(const Uneven& one, std::ostream* out) { *out << one.robot << " uneven by " << one.off_deg << " deg"; }

class UnevenDrives : public testing::TestWithParam<Uneven> {};

/// The table of docs/judgement.md, with all machines. Limits as they were written down before: half of what the
/// prototype gained.
TEST_P(UnevenDrives, AreTakenWhereTheyPredictOmittedPoses) {
  const auto [robot, off, quick, at_most] = GetParam();
  const int machines = test::machines({.claim = 16, .quick = quick});
  const Left all = left_by(catalogue::find(robot), to_radians(off), machines);
  RecordProperty("left",
                 fmt::format("chosen {} of {}, rigid {:.4f}, now {:.4f} mm", all.chosen, machines, all.rigid, all.now));
  EXPECT_LT(all.now, at_most * all.rigid);
  EXPECT_EQ(all.accepted, machines);  // no mistake in the input is blamed for the drives
  if (off > 0.003) {
    EXPECT_EQ(all.chosen, machines);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, UnevenDrives,
                         testing::Values(Uneven{"rotary_delta", 0.0, 4, 1.1}, Uneven{"rotary_delta", 0.0015, 3, 0.75},
                                         Uneven{"rotary_delta", 0.004, 3, 0.55}, Uneven{"linear_delta", 0.0, 3, 1.1},
                                         Uneven{"linear_delta", 0.0015, 6, 0.85},
                                         Uneven{"linear_delta", 0.004, 3, 0.55}, Uneven{"huang2016", 0.0, 3, 1.1},
                                         Uneven{"huang2016", 0.0015, 4, 0.9}, Uneven{"huang2016", 0.004, 3, 0.6}));

class Found : public testing::Test {
 protected:
  Robot robot = catalogue::rotary_delta();
  std::vector<Station> stations = candidate_stations(robot, 40, 5);
  UnevenMachine machine{robot, to_radians(0.004), 1};
  Calibration found = calibrate(robot, machine.read(stations));
  KnownErrors known = known_errors(found), rigid = rigid_errors(found);
};

/// The curves bring the plate where errors of joints' zeros of that size bring it, to first order.
TEST_F(Found, CurvesActAsZerosDo) {
  ASSERT_FALSE(known.drives().are_even());
  const auto built = differentiable(robot, known.errors);
  const Joints joints = believed_joints(robot, stations[7]);
  const ForwardResult even = forward(built, joints), uneven = forward(built, known.drives().actual(joints));
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(std::ssize(known.parameters));
  sizes.tail(known.drive_sizes.size()) = known.drive_sizes;
  const Eigen::VectorXd linear = plate_jacobian(built, even.plate, joints, known.parameters) * sizes;
  EXPECT_GT(linear.head<3>().norm(), 0.01);
  EXPECT_LT((uneven.plate.position - even.plate.position - linear.head<3>()).norm(), 1e-3 * linear.head<3>().norm());
}

TEST_F(Found, CommandedJointsInvertActualOnes) {
  const DriveCurves drives = known.drives();
  for (const Station& station : stations) {
    const Joints joints = believed_joints(robot, station);
    EXPECT_LT((drives.commanded(drives.actual(joints)) - joints).cwiseAbs().maxCoeff(), 1e-12);
  }
}

/// Mean squares about the rigid machine, variances about this one.
TEST_F(Found, VariancesAreSmallerThanMeanSquares) {
  const Eigen::MatrixXd less = rigid.covariance - known.covariance;
  const Eigen::VectorXd eigenvalues = detail::symmetric_eigenvalues(less);
  EXPECT_GT(eigenvalues.tail(1)(0), 0.0);
  EXPECT_LT(eigenvalues.head(eigenvalues.size() - 1).cwiseAbs().maxCoeff(), 1e-9 * eigenvalues.tail(1)(0));
  EXPECT_GT(known.covariance.diagonal().minCoeff(), 0.0);
  ASSERT_TRUE(found.use);
  const Use before = use_over_workspace(robot, rigid).any;
  EXPECT_LT(found.use->distance.U, 0.5 * before.distance.U);
}

/// U over the workspace holds the distances that are left.
TEST_F(Found, UHoldsWhatIsLeft) {
  ASSERT_TRUE(found.use_mean);
  EXPECT_LT(2.0 * left(robot, known, machine), found.use_mean->distance.U);
}

TEST_F(Found, AFileHoldsBothMachines) {
  ASSERT_TRUE(found.accepted()) << found.brief();
  const io::JsonFile file(io::TextFile{"c.json", io::to_json(found, 0).dump()});
  const io::CalibratedMachine read = io::read_calibration(file, robot);
  const KnownErrors both[] = {read.known(), read.rigid()}, wanted[] = {known, rigid};
  for (int k = 0; k < 2; ++k) {
    EXPECT_LT((both[k].covariance - wanted[k].covariance).cwiseAbs().maxCoeff(),
              1e-9 * wanted[k].covariance.cwiseAbs().maxCoeff());
    EXPECT_EQ(both[k].drive_sizes.size(), wanted[k].drive_sizes.size());
    for (const Station& station : stations) {
      const Joints joints = believed_joints(robot, station);
      EXPECT_LT(
          (predict(robot, both[k], joints).pose.position - predict(robot, wanted[k], joints).pose.position).norm(),
          1e-9);
    }
  }
}

TEST_F(Found, CompensatedPosesAreReached) {
  const PoseCorrector corrector = pose_corrector(robot, known);
  for (const Station& station : stations) {
    const CorrectedPose corrected = corrector(station.commanded);
    ASSERT_EQ(corrected.status, CompensationStatus::ok);
    EXPECT_LT((predict(robot, known, corrected.joints).pose.position - station.commanded.position).norm(), 1e-8);
  }
  EXPECT_NEAR(loss_without_drives(robot, known, rigid.errors), 0.15, 0.12);
  EXPECT_EQ(loss_without_drives(robot, rigid, rigid.errors), 0.0);
}

/// A calibration with drives is confirmed by other poses; the rigid one is off by far more than it.
TEST_F(Found, ValidationUsesTheDrives) {
  const Measurements check = machine.read(candidate_stations(robot, 25, 99), 2);
  const ValidationOptions limited{.limits = {.distance = 0.2}};
  const Validation with = validate(robot, known, check, limited), without = validate(robot, rigid, check, limited);
  EXPECT_TRUE(with.accepted.value()) << testing::PrintToString(with.reasons);
  EXPECT_LT(with.after.max_volumetric_aligned, 0.5 * without.after.max_volumetric_aligned);
  ASSERT_TRUE(with.agreement);
  EXPECT_FALSE(with.agreement->contradicts());
}

}  // namespace
}  // namespace paracal::test::drives_test
