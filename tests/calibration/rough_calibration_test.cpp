#include <gmock/gmock.h>

#include <boost/math/distributions/binomial.hpp>

#include "paper/published.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::rough_calibration_test {
namespace {

using test::Random;

struct VirtualMeasurement {
  double distance_sigma = 0.0;  ///< mm
  bool all_pairs = false;       ///< every pair of points, or home to each point
  bool rotations = false;
};

/// What a machine with these errors shows when its controller believes the nominal robot.
Measurements measure(const Robot& robot, const SourceErrors& errors, std::vector<Station> stations,
                     const VirtualMeasurement& how, Random& random) {
  const Machine machine = build(robot, errors);
  std::vector<PlateState> plates;
  for (const Station& station : stations) {
    plates.push_back(forward(machine, inverse(robot.nominal(), station.commanded).joints).plate);
  }
  Measurements measurements{.stations = std::move(stations), .distances = {}, .files = {}};
  for (std::size_t from = 0; from < (how.all_pairs ? plates.size() : 1); ++from) {
    for (std::size_t to = from + 1; to < plates.size(); ++to) {
      DistanceReading reading{.from = from, .to = to};
      reading.distance = (plates[to].position - plates[from].position).norm() + random.normal(how.distance_sigma);
      if (how.rotations) reading.rotation = machine.rotation_of(plates[to].slide - plates[from].slide);
      measurements.distances.push_back(reading);
    }
  }
  return measurements;
}

/// @param largest  deg; on rails as far as turns the rods by that.
SourceErrors random_offsets(const Robot& robot, double largest, Random& random) {
  SourceErrors errors;
  const double unit_size =
      to_radians(1.0) * (joint_unit(robot.actuator()) == Unit::mm ? sizes_of(robot.limbs()).rod : 1.0);
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    errors(limb, "theta_offset") = unit_size * random.uniform(-largest, largest);
  }
  return errors;
}

TEST(RoughCalibration, RecoversThePublishedOffsetsFromThePublishedDistances) {
  const io::PublishedHuang2016 published = io::published_huang2016();
  const Calibration calibration = calibrate(catalogue::huang2016(), published.rough);
  ASSERT_TRUE(calibration.accepted()) << calibration.brief();
  // An independent program found these from the same six numbers.
  const std::array<double, 4> independent{0.206, 0.839, 0.879, 0.348};
  for (std::size_t limb = 0; limb < 4; ++limb) {
    const double offset = to_degrees(calibration.errors()(limb, "theta_offset"));
    EXPECT_NEAR(offset, independent[limb], 6e-4);
    EXPECT_NEAR(offset, to_degrees(published.offsets(limb, "theta_offset")), 0.04);
  }
  EXPECT_EQ(calibration.degrees_of_freedom, 2);
  EXPECT_NEAR(calibration.before.max_abs_distance, 2.332, 1e-9);
  EXPECT_LT(calibration.after.max_abs_distance, 0.03);
}

class RoughCalibrationLaw : public test::EveryRobot {
 protected:
  /// The offsets of rails together are also a shift of the robot, which distances do not see.
  int unseen() const { return robot.actuator() == Actuator::linear ? 1 : 0; }
  int offsets_seen() const { return static_cast<int>(robot.limb_count()) - unseen(); }

  /// What 1e-10 rad is in the unit of offsets.
  double exactly() const { return joint_unit(robot.actuator()) == Unit::mm ? 4e-8 : 1e-10; }

  /// Offset of a limb as far as distances tell.
  double seen(const SourceErrors& errors, std::size_t limb) const {
    double mean = 0.0;
    for (std::size_t i = 0; i < robot.limb_count(); ++i) mean += errors(i, "theta_offset");
    return errors(limb, "theta_offset") - (unseen() > 0 ? mean / static_cast<double>(robot.limb_count()) : 0.0);
  }
};

TEST_P(RoughCalibrationLaw, RecoversKnownOffsetsExactlyWithoutNoise) {
  Random random;
  for (int machine = 0; machine < test::machines({.claim = 50, .quick = 8}); ++machine) {  // one would do
    const SourceErrors truth = random_offsets(robot, 3.0, random);
    const Measurements measurements = measure(robot, truth, rough_stations(robot, 6), {}, random);
    const Calibration calibration = calibrate(robot, measurements);
    ASSERT_TRUE(calibration.accepted()) << calibration.brief();
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      EXPECT_NEAR(seen(calibration.errors(), limb), seen(truth, limb), exactly());
    }
    EXPECT_LT(calibration.after.rms_distance, 1e-8);
  }
}

TEST_P(RoughCalibrationLaw, UsesRotationsWhereTheyWereRead) {
  Random random;
  const SourceErrors truth = random_offsets(robot, 1.0, random);
  const Measurements measurements = measure(robot, truth, rough_stations(robot, 6), {.rotations = true}, random);
  const Calibration with = calibrate(robot, measurements);
  ASSERT_TRUE(with.accepted());
  EXPECT_EQ(with.degrees_of_freedom, 12 - offsets_seen());
  EXPECT_LT(*with.after.max_abs_rotation, 1e-8);
}

/// 95 % intervals from one fit each must contain the truth in 95 % of machines, within what 400 machines can tell, or
/// 100: 87 % would be intervals that are a quarter too narrow.
TEST_P(RoughCalibrationLaw, IntervalsCoverTheTruth) {
  Random random;
  const int count = test::machines({.claim = 400, .quick = 100});
  int covered = 0, intervals = 0;
  CalibrationOptions options{.scale_std = 0.0};  // offsets alone are off, and nothing else may be
  for (const Source source : all_sources()) {
    if (source != "theta_offset") options.fixed.push_back({source, {}});
  }
  for (int machine = 0; machine < count; ++machine) {
    const SourceErrors truth = random_offsets(robot, 1.0, random);
    const Measurements measurements =
        measure(robot, truth, rough_stations(robot, 6), {.distance_sigma = 0.02, .all_pairs = true}, random);
    const Calibration calibration = calibrate(robot, measurements, options);
    ASSERT_TRUE(calibration.accepted()) << calibration.brief();
    for (std::size_t k = 0; k < calibration.parameters.size(); ++k) {
      const ParameterEstimate& parameter = calibration.parameters[k];
      // Of the noise alone: what distances do not see of rails is as good as the tolerance, and is not asked for here.
      const double std =
          std::sqrt(calibration.noise_covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)));
      covered += std::abs(seen(calibration.errors(), parameter.limb) - seen(truth, parameter.limb)) <=
                 coverage_factor(calibration.noise_dof) * std;
      ++intervals;
    }
  }
  // Offsets of one machine are correlated, so count machines, not intervals, in the binomial bound (99.9 %).
  const boost::math::binomial_distribution<> machines(count, 0.95);
  const double share = static_cast<double>(covered) / intervals;
  EXPECT_GE(share, boost::math::quantile(machines, 0.0005) / count);
  EXPECT_LE(share, boost::math::quantile(machines, 0.9995) / count);
}

TEST_P(RoughCalibrationLaw, TooFewDistancesAreNotIdentifiable) {
  Random random;
  const SourceErrors truth = random_offsets(robot, 1.0, random);
  const int points = offsets_seen() - 1;
  const Calibration calibration =
      calibrate(robot, measure(robot, truth, rough_stations(robot, points, 0.3), {}, random));
  EXPECT_EQ(calibration.verdict, Verdict::not_identifiable);
  EXPECT_EQ(calibration.rank, points);
  ASSERT_EQ(calibration.null_space.size(), static_cast<std::size_t>(1 + unseen()));
  EXPECT_THAT(calibration.null_space.back().text, testing::HasSubstr("theta_offset of limb"));
  EXPECT_FALSE(calibration.parameters[0].std);
}

TEST_P(RoughCalibrationLaw, NothingToSpareIsRejectedUnlessSigmasAreStated) {
  Random random;
  const SourceErrors truth = random_offsets(robot, 1.0, random);
  Measurements measurements = measure(robot, truth, rough_stations(robot, offsets_seen(), 0.3), {}, random);
  const Calibration unchecked = calibrate(robot, measurements);
  EXPECT_EQ(unchecked.verdict, Verdict::rejected);
  EXPECT_THAT(unchecked.reasons, testing::ElementsAre(testing::HasSubstr("no degrees of freedom to check the fit")));
  for (DistanceReading& reading : measurements.distances) reading.distance_sigma = 0.02;
  const Calibration stated = calibrate(robot, measurements);
  EXPECT_TRUE(stated.accepted()) << stated.brief();
  EXPECT_TRUE(stated.parameters[0].std);
}

/// A twentieth is accepted by chance, and without the test all: 30 tell these apart, 200 whether it is a twentieth.
TEST_P(RoughCalibrationLaw, NoiseAloneIsRarelyAccepted) {
  Random random;
  const int count = test::machines({.claim = 200, .quick = 30});
  int accepted = 0;
  for (int machine = 0; machine < count; ++machine) {
    const Measurements measurements =
        measure(robot, {}, rough_stations(robot, 6), {.distance_sigma = 0.05, .all_pairs = true}, random);
    accepted += calibrate(robot, measurements).accepted();
  }
  // largest_chance is 5 %: the count is binomial.
  EXPECT_LE(accepted, boost::math::quantile(boost::math::binomial_distribution<>(count, 0.05), 0.999));
}

TEST_P(RoughCalibrationLaw, TakesTheJointsThatTheControllerBelievedWhereTheyAreKnown) {
  Random random;
  const SourceErrors truth = random_offsets(robot, 1.0, random);
  Measurements measurements = measure(robot, truth, rough_stations(robot, 6), {}, random);
  for (Station& station : measurements.stations) {
    station.believed = inverse(robot.nominal(), station.commanded).joints;
    station.commanded.position.z() += 20.0;  // where it was sent no longer matters
  }
  const Calibration calibration = calibrate(robot, measurements);
  EXPECT_NEAR(seen(calibration.errors(), 0), seen(truth, 0), exactly());
}

PARACAL_ON_EVERY_ROBOT(RoughCalibrationLaw);

TEST(RoughCalibration, NonsenseReadingsAreRefusedByNumber) {
  const Robot robot = catalogue::huang2016();
  const Measurements good = io::published_huang2016().rough;
  const auto refusal = [&](auto spoil) {
    Measurements spoilt = good;
    spoil(spoilt);
    try {
      (void)calibrate(robot, spoilt);
    } catch (const Error& complaint) {
      return std::string(complaint.what());
    }
    return std::string("accepted");
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal([](auto& m) { m.distances[2].to = 99; }), HasSubstr("distance 3"));
  EXPECT_THAT(refusal([](auto& m) { m.distances[2].to = 0; }), HasSubstr("two different stations"));
  EXPECT_THAT(refusal([](auto& m) { m.distances[1].distance = -5; }), HasSubstr("above 0 mm, got -5"));
  EXPECT_THAT(refusal([](auto& m) { m.distances[1].distance_sigma = 0; }), HasSubstr("sigma above 0 mm"));
  EXPECT_THAT(refusal([](auto& m) { m.distances[5] = m.distances[0]; }), HasSubstr("same two stations as distance 1"));
  EXPECT_THAT(refusal([](auto& m) { m.stations[3].commanded.position.z() = -5000; }), HasSubstr("cannot reach"));
  EXPECT_THAT(refusal([](auto& m) { m.stations[3].commanded.position.z() = NAN; }), HasSubstr("finite commanded pose"));
  EXPECT_THAT(refusal([](auto& m) { m.stations[0].believed = Joints::Zero(3); }), HasSubstr("4 finite joint"));
  EXPECT_THAT(refusal([](auto& m) { m.distances.clear(); }), HasSubstr("at least one reading"));
}

}  // namespace
}  // namespace paracal::rough_calibration_test
