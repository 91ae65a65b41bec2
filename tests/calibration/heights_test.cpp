// Heights above a plane, distances with a bias, errors that limbs share.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "calibration/fit/observation.hpp"
#include "calibration/fit/sought.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/differences.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::heights_test {
namespace {

constexpr double kPlane = 0.7, kSlopeX = 2e-3, kSlopeY = -1e-3,
                 kBias = 0.15;  // mm; the plane's height above the bottom

class HeightsLaw : public test::EveryRobot {
 protected:
  /// What a probe and a calliper show of a machine: heights above a tilted plane, distances that are all too long.
  Measurements measured(const SourceErrors& errors, double noise) {
    Measurements measurements{.stations = fine_stations(robot, 9)};
    const Machine machine = build(robot, errors);
    std::vector<Eigen::Vector3d> places;
    for (const Station& station : measurements.stations) {
      places.push_back(forward(machine, believed_joints(robot, station)).plate.position);
    }
    measurements.lengths.push_back({"bed"});
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Eigen::Vector3d& p = places[k];
      const double plane =
          robot.workspace().top_z + kPlane + kSlopeX * p.x() + kSlopeY * p.y() + curvature * p.head<2>().squaredNorm();
      measurements.lengths[0].readings.push_back({.station = k, .length = p.z() - plane + random.normal(noise)});
    }
    for (std::size_t from = 0; from < places.size(); ++from) {
      for (std::size_t to = from + 1; to < places.size(); ++to) {
        const double length = (places[to] - places[from]).norm();
        measurements.distances.push_back({.from = from, .to = to, .distance = length + kBias + random.normal(noise)});
      }
    }
    return measurements;
  }

  double curvature = 0.0;  ///< of what the heights are read above, 1/mm
  test::Random random;
};
PARACAL_ON_EVERY_ROBOT(HeightsLaw);

/// Rows of every reading against differences, nuisance included: the curvature's over 1e4 mm^2, as large as the others.
TEST_P(HeightsLaw, RowsAreDerivatives) {
  CalibrationOptions options;
  options.plane_curvature = 1e-5;
  options.noise.distance_bias = 0.1;
  const SourceErrors errors = random.realistic_errors(robot);
  const Measurements measurements = measured(errors, 0.01);
  detail::Observation observation(robot, measurements, options, detail::all_with_priors(robot, options));
  const auto start = observation.start(errors);
  ASSERT_TRUE(start);
  Eigen::VectorXd at = *start;
  constexpr Eigen::Index kCurvature = 3;
  at.head(observation.nuisance_count()) += Eigen::Vector<double, 5>(0.3, 1e-3, -2e-3, 2e-5, 0.05);
  const auto residuals = [&](const Eigen::VectorXd& unknowns) {
    const auto stations = observation.stations(unknowns);
    Eigen::VectorXd all(static_cast<Eigen::Index>(observation.groups().size()));
    Eigen::MatrixXd block;
    for (std::size_t g = 0; g < observation.groups().size(); ++g) {
      observation.rows(observation.groups()[g], *stations, unknowns, block);
      all(static_cast<Eigen::Index>(g)) = block(0, observation.unknown_count());
    }
    return all;
  };
  Eigen::MatrixXd ours(static_cast<Eigen::Index>(observation.groups().size()), observation.unknown_count());
  Eigen::MatrixXd block;
  for (std::size_t g = 0; g < observation.groups().size(); ++g) {
    observation.rows(observation.groups()[g], *observation.stations(at), at, block);
    ours.row(static_cast<Eigen::Index>(g)) = block.row(0).head(observation.unknown_count());
  }
  const Eigen::VectorXd step = Eigen::VectorXd::Constant(observation.unknown_count(), 1e-4);
  Eigen::MatrixXd differences = test::central_differences(residuals, at, step);
  ours.col(kCurvature) *= 1e-4;
  differences.col(kCurvature) *= 1e-4;
  EXPECT_LT((ours - differences).norm() / ours.norm(), robot.limb_count() == 3 ? 1e-6 : 1e-3);
}

TEST_P(HeightsLaw, FindPlaneBiasAndMachine) {
  CalibrationOptions options;
  options.stage = Stage::fine;
  options.noise = {.distance = 0.01, .height = 0.01, .distance_bias = 1.0};
  options.noise_is_known = true;
  const SourceErrors errors = random.realistic_errors(robot);
  const Calibration calibration = calibrate(robot, measured(errors, 1e-4), options);
  ASSERT_NE(calibration.verdict, Verdict::not_converged) << calibration.brief();
  EXPECT_NEAR(*calibration.distance_bias, kBias, 5e-3);
  ASSERT_EQ(calibration.set_ups.size(), 1u);
  EXPECT_LT(calibration.after.rms_lengths.at(LengthKind::height), 2e-3);
  EXPECT_EQ(calibration.lengths.size(), calibration.set_ups.size() * fine_stations(robot, 9).size());
  EXPECT_LT(
      test::held_out_errors(robot, errors, calibration.errors(), validation_stations(robot)).max_volumetric_aligned,
      0.1);
}

/// As far as the machine's own errors leave it.
TEST_P(HeightsLaw, FindCurvature) {
  curvature = 1e-4;
  CalibrationOptions options;
  options.stage = Stage::fine;
  options.noise = {.distance = 0.01, .height = 0.01, .distance_bias = 1.0};
  options.noise_is_known = true;
  options.plane_curvature = 1e-4;
  const Calibration calibration = calibrate(robot, measured(random.realistic_errors(robot), 1e-4), options);
  ASSERT_NE(calibration.verdict, Verdict::not_converged) << calibration.brief();
  const FoundSetUp& bed = calibration.set_ups.front();
  ASSERT_EQ(bed.unknowns.size(), 4);
  EXPECT_LT(std::sqrt(bed.covariance(3, 3)), 0.5e-4);
  EXPECT_NEAR(bed.unknowns(3), curvature, 4.0 * std::sqrt(bed.covariance(3, 3)));
}

/// Rods of one wrong length: the shared prior lets them all move, the tight tolerance of each keeps them alike, and
/// nothing is wrong. Without it the robot file is.
TEST_P(HeightsLaw, CommonErrorsMoveLimbsTogether) {
  SourceErrors errors;
  CommonError rods{.text = "rods", .direction = {}, .std = 2.0};
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    errors(limb, "rod_mean") = 1.5;
    rods.direction(limb, "rod_mean") = 1.0;
  }
  Tolerances tolerances = *robot.tolerances();
  tolerances["rod_mean"] = 0.03;
  CalibrationOptions options;
  options.stage = Stage::fine;
  options.tolerances = tolerances;
  options.noise = {.distance = 0.01, .height = 0.01, .distance_bias = 1.0};
  const Measurements measurements = measured(errors, 1e-4);
  const auto largest_spread = [&](const Calibration& calibration) {
    const SourceErrors found = calibration.errors();
    double low = found(0, "rod_mean"), high = low;
    for (std::size_t limb = 1; limb < robot.limb_count(); ++limb) {
      low = std::min(low, found(limb, "rod_mean"));
      high = std::max(high, found(limb, "rod_mean"));
    }
    return std::pair(low, high);
  };
  const Calibration alone = calibrate(robot, measurements, options);
  EXPECT_THAT(alone.brief(), testing::HasSubstr("the readings fit a robot file with rod_mm = "));
  options.common = {rods};
  const Calibration shared = calibrate(robot, measurements, options);
  EXPECT_TRUE(shared.components.empty()) << shared.brief();
  const auto [low, high] = largest_spread(shared);
  EXPECT_GT(low, 1.0);
  EXPECT_LT(high - low, 0.1);
}

TEST(Heights, NonsenseIsRefused) {
  const Robot robot = catalogue::linear_delta();
  Measurements measurements{.stations = fine_stations(robot, 3)};
  measurements.lengths = {{"bed", LengthKind::height, {{.station = 99, .length = 1.0}}}};
  EXPECT_THROW((void)calibrate(robot, measurements), InvalidArgument);
  measurements.lengths = {{"bed", LengthKind::height, {{.station = 0, .length = 1.0, .sigma = -1.0}}}};
  EXPECT_THROW((void)calibrate(robot, measurements), InvalidArgument);
}

/// Rotary Deltas whose axes and parallelograms are wrong: offsets, radius and azimuths alone (e_x, e_y and
/// theta_offset) leave three times the shape error at least, in the median. Ratios scatter by a third: the median of 9
/// tells three from two, that of 40 from two and a half.
TEST(RotaryDelta, AllErrorsBeatOffsetsRadiusAndAngles) {
  const Robot robot = catalogue::rotary_delta();
  Tolerances tolerances = *robot.tolerances();
  for (const Source source : all_sources()) {
    if (tilts_plate(source)) tolerances[source] *= 5.0;
  }
  CalibrationOptions all, few;
  all.tolerances = few.tolerances = tolerances;
  all.stage = few.stage = Stage::fine;
  for (const Source source : all_sources()) {
    const bool kept = source == "theta_offset" || source == "e_x" || source == "e_y";
    if (!kept) few.fixed.push_back({source, {}});
  }
  const int count = test::machines({.claim = 40, .quick = 9});
  std::vector<double> ratios;
  for (int number = 0; number < count; ++number) {
    RandomStream random(7, static_cast<std::uint64_t>(number));
    const SourceErrors truth = draw_errors(robot, tolerances, random);
    const Measurements measurements = simulate(robot, truth, fine_stations(robot, 9), {.noise = 0.02}, random);
    const auto shape = [&](const CalibrationOptions& options) {
      const SourceErrors found = calibrate(robot, measurements, options).errors();
      return test::held_out_errors(robot, truth, found, validation_stations(robot)).max_volumetric_aligned;
    };
    ratios.push_back(shape(few) / shape(all));
  }
  EXPECT_GE(test::quantile(ratios, 0.5), 3.0);
}

}  // namespace
}  // namespace paracal::heights_test
