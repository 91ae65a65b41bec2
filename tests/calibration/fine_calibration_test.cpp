#include <gmock/gmock.h>

#include <boost/math/distributions/binomial.hpp>

#include "paper/published.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::fine_calibration_test {
namespace {

using test::held_out_errors;
using test::machines;
using test::measured_machine;
using test::MeasuredMachine;
using testing::HasSubstr;

constexpr double kNoise = 0.017;  // mm: a third of the published repeatability

/// 2000 machines must lie in 93 to 97 %; of fewer, as far from 95 % as the binomial distribution of so many independent
/// ones allows once in 1000.
void expect_coverage(int covered, int total, int independent, const char* what) {
  const double share = static_cast<double>(covered) / total;
  const boost::math::binomial_distribution<> count(independent, 0.95);
  const double low = std::min(0.93, boost::math::quantile(count, 0.0005) / independent);
  const double high = std::max(0.97, boost::math::quantile(count, 0.9995) / independent);
  EXPECT_GE(share, low) << what;
  EXPECT_LE(share, high) << what;
}

class FineCalibrationLaw : public test::EveryRobot {
 protected:
  std::vector<Station> stations = fine_stations(robot, 9);
};

TEST_P(FineCalibrationLaw, PredictsHeldOutPosesOfANoiselessMachine) {
  const MeasuredMachine machine =
      measured_machine(robot, stations, 1, {.reads_rotation = true, .second = Eigen::Vector3d(20, 10, -150)});
  const Calibration calibration = calibrate(robot, machine.measurements, {.rotation_zero = RotationZero::known});
  ASSERT_TRUE(calibration.accepted()) << calibration.brief();
  const PoseErrorSummary errors =
      held_out_errors(robot, machine.errors, calibration.errors(), validation_stations(robot));
  EXPECT_LT(errors.max_abs_distance, 2e-3);
  EXPECT_LT(errors.max_volumetric_aligned, 2e-3);
  EXPECT_LT(*errors.max_abs_rotation, to_radians(0.02));
}

TEST_P(FineCalibrationLaw, ReadingsInTheRobotsFrameNeedNoAlignment) {
  RandomStream random(3);
  const SourceErrors truth = draw_errors(robot, *robot.tolerances(), random);
  Measurements measurements = simulate(robot, truth, stations, {}, random);
  test::state_sigma(measurements, 1e-5);
  const Calibration calibration = calibrate(robot, measurements, {.frame = Frame::robot});
  ASSERT_TRUE(calibration.accepted()) << calibration.brief();
  EXPECT_LT(held_out_errors(robot, truth, calibration.errors(), validation_stations(robot)).max_abs_distance, 2e-3);
  EXPECT_EQ(calibration.frames[0].frame.translation, Eigen::Vector3d::Zero());
}

/// The instrument may stand anywhere: answers do not depend on its frame.
TEST_P(FineCalibrationLaw, DoesNotDependOnTheInstrumentsFrame) {
  MeasuredMachine machine = measured_machine(robot, stations, 4, {.noise = kNoise});
  const Calibration one = calibrate(robot, machine.measurements);
  for (PointReading& reading : machine.measurements.series[0].readings) {
    reading.point = one.frames[0].frame.inverse()(reading.point) + Eigen::Vector3d(10, -20, 5);
  }
  const Calibration other = calibrate(robot, machine.measurements);
  for (std::size_t k = 0; k < one.parameters.size(); ++k) {
    EXPECT_NEAR(one.parameters[k].value, other.parameters[k].value, 1e-4 * *one.parameters[k].std);
  }
}

/// Of 2000 machines a share is known to 1.5 %. Of 50 it shows intervals that are a quarter too narrow or too wide: the
/// errors of one machine tell at least as much as five independent ones.
TEST_P(FineCalibrationLaw, IntervalsCoverTheTruth) {
  const int count = machines({.claim = 2000, .quick = 50});
  const std::vector<Station> poses{validation_stations(robot)[7], validation_stations(robot)[45],
                                   validation_stations(robot)[118]};
  int revealed = 0, revealed_covered = 0, predicted_covered = 0;
  for (int number = 0; number < count; ++number) {
    MeasuredMachine machine = measured_machine(robot, stations, number, {.noise = kNoise});
    test::state_sigma(machine.measurements, kNoise);
    const Calibration calibration = calibrate(robot, machine.measurements);
    ASSERT_TRUE(calibration.accepted()) << calibration.brief();
    const SourceErrors felt = test::as_felt(robot, machine.errors);
    for (const ParameterEstimate& parameter : calibration.parameters) {
      if (!parameter.identified()) continue;
      ++revealed;
      const double error = parameter.value - felt(parameter.limb, parameter.source);
      revealed_covered += std::abs(error) <= 1.96 * *parameter.std;
    }
    const Machine truth = build(robot, machine.errors);
    const Joints joints = believed_joints(robot, poses[static_cast<std::size_t>(number) % poses.size()]);
    const PredictedPose predicted = predict(robot, known_errors(calibration), joints);
    const Eigen::Vector3d actual = forward(truth, joints).plate.position;
    predicted_covered +=
        std::abs(actual.x() - predicted.pose.position.x()) <= 1.96 * std::sqrt(predicted.covariance(0, 0));
  }
  expect_coverage(revealed_covered, revealed, 5 * count, "parameters that the readings reveal");
  expect_coverage(predicted_covered, count, count, "predicted poses");
}

/// U of the least certain distance to home over the workspace, mm: no frame is in it, so the readings say what it is,
/// not the priors.
double distance_uncertainty(const Robot& robot, const Calibration& calibration) {
  const KnownErrors known = known_errors(calibration);
  const PoseSpread spread(robot, known.errors, known.parameters, validation_stations(robot));
  return kCoverageFactor * spread.uncertainty(known.covariance).max_distance;
}

/// Left out, a gross error moves no distance by more than U; kept, it does. Of every machine: 40 have it at each pose
/// twice, two at home and beside it.
TEST_P(FineCalibrationLaw, NamesAGrossErrorFirstAndLosesLittleByIt) {
  int kept_and_worse = 0;
  const int count = machines({.claim = 40, .quick = 2});
  for (int number = 0; number < count; ++number) {
    MeasuredMachine machine = measured_machine(robot, stations, number, {.noise = kNoise});
    test::state_sigma(machine.measurements, kNoise);
    const Calibration clean = calibrate(robot, machine.measurements);
    const auto spoilt = static_cast<std::size_t>(number) % stations.size();
    machine.measurements.series[0].readings[spoilt].point += Eigen::Vector3d(0.6, -0.64, 0.48);  // 1 mm
    const Calibration calibration = calibrate(robot, machine.measurements);
    ASSERT_TRUE(calibration.accepted());
    EXPECT_THAT(calibration.suspects.front().text, HasSubstr(stations[spoilt].name + " of")) << number;
    EXPECT_TRUE(calibration.suspects.front().excluded);
    EXPECT_THAT(calibration.notes, testing::Contains(HasSubstr("outlier excluded: " + stations[spoilt].name + " of")));
    const auto moved = [&](const Calibration& other) {
      return held_out_errors(robot, clean.errors(), other.errors(), validation_stations(robot)).max_abs_distance;
    };
    const double uncertainty = distance_uncertainty(robot, calibration);
    EXPECT_LT(moved(calibration), uncertainty) << number;
    const double kept = moved(calibrate(robot, machine.measurements, {.exclude_outliers = false, .diagnose = false}));
    kept_and_worse += kept > uncertainty ? 1 : 0;
  }
  EXPECT_EQ(kept_and_worse, count);
}

TEST_P(FineCalibrationLaw, TellsSwappedReadings) {
  MeasuredMachine machine = measured_machine(robot, stations, 5, {.noise = kNoise});
  std::vector<PointReading>& readings = machine.measurements.series[0].readings;
  std::swap(readings[4].point, readings[11].point);
  const Calibration calibration = calibrate(robot, machine.measurements);
  ASSERT_TRUE(calibration.accepted()) << calibration.brief();
  EXPECT_THAT(calibration.notes,
              testing::Contains(testing::AllOf(HasSubstr("outlier excluded: P4"), HasSubstr("swapped with P11"))));
  EXPECT_THAT(calibration.notes,
              testing::Contains(testing::AllOf(HasSubstr("outlier excluded: P11"), HasSubstr("swapped with P4"))));
}

TEST_P(FineCalibrationLaw, SeveralSetUpsEnterOneFit) {
  const std::vector<Station> more = fine_stations(robot, 7, 0.3);
  MeasuredMachine machine = measured_machine(robot, stations, 6, {.noise = kNoise});
  const Calibration one = calibrate(robot, machine.measurements);
  Measurements second = test::measure(robot, machine.errors, more, 77, {.noise = kNoise, .reads_rotation = true});
  const std::size_t shift = machine.measurements.stations.size();
  for (PointReading& reading : second.series[0].readings) {
    reading.station += shift;
    reading.point += Eigen::Vector3d(500, 0, 0);
  }
  for (const Station& station : second.stations) machine.measurements.stations.push_back(station);
  machine.measurements.series.push_back(second.series[0]);
  const Calibration both = calibrate(robot, machine.measurements);
  ASSERT_TRUE(both.accepted()) << both.brief();
  EXPECT_EQ(both.frames.size(), 2u);
  EXPECT_LT(both.use_mean->distance.U, 1.1 * one.use_mean->distance.U);
}

TEST_P(FineCalibrationLaw, PriorsDecideOnlyWhereReadingsAreSilent) {
  const MeasuredMachine machine = measured_machine(robot, stations, 8, {.noise = kNoise});
  const Calibration calibration = calibrate(robot, machine.measurements);
  for (const ParameterEstimate& parameter : calibration.parameters) {
    EXPECT_GE(parameter.data_share, 0.0);
    EXPECT_LE(parameter.data_share, 1.0);
    EXPECT_LE(*parameter.std, *parameter.prior_std * 1.15);  // parts may be worse than their tolerances
  }
  EXPECT_GT(std::ranges::max(calibration.parameters, {}, &ParameterEstimate::data_share).data_share, 0.95);
}

TEST_P(FineCalibrationLaw, CorrelationsAreThoseOfTheCovariance) {
  const Calibration calibration =
      calibrate(robot, measured_machine(robot, stations, 8, {.noise = kNoise}).measurements);
  const auto strong = calibration.correlations(0.5);
  ASSERT_GT(strong.size(), 1u);
  EXPECT_GE(std::abs(strong[0].value), std::abs(strong[1].value));
  for (const Calibration::Correlation& pair : strong) {
    const auto i = static_cast<Eigen::Index>(pair.one), k = static_cast<Eigen::Index>(pair.other);
    EXPECT_LT(i, k);
    EXPECT_NEAR(pair.value * *calibration.parameters[pair.one].std * *calibration.parameters[pair.other].std,
                calibration.covariance(i, k), 1e-12);
    EXPECT_LE(std::abs(pair.value), 1.0 + 1e-9);
  }
}

TEST_P(FineCalibrationLaw, SeveralGrossErrorsDoNotHideEachOther) {
  MeasuredMachine machine = measured_machine(robot, stations, 13, {.noise = kNoise});
  for (const std::size_t spoilt : {2u, 8u, 15u}) {
    machine.measurements.series[0].readings[spoilt].point += Eigen::Vector3d(-0.6, 0.64, 0.48);
  }
  const Calibration calibration = calibrate(robot, machine.measurements);
  ASSERT_TRUE(calibration.accepted()) << calibration.brief();
  std::vector<std::string> excluded;
  for (const Suspect& one : calibration.suspects) {
    if (one.excluded) excluded.push_back(one.text);
  }
  EXPECT_THAT(excluded, testing::UnorderedElementsAre(HasSubstr("P2 of"), HasSubstr("P8 of"), HasSubstr("P15 of")));
}

TEST_P(FineCalibrationLaw, FixedStaysAndFreeHasNoPrior) {
  const MeasuredMachine machine = measured_machine(robot, stations, 9, {.noise = kNoise});
  const Calibration calibration =
      calibrate(robot, machine.measurements, {.fixed = {{"alpha0", {}}, {"e_x", 1}}, .free = {{"rod_mean", 0}}});
  for (const ParameterEstimate& parameter : calibration.parameters) {
    EXPECT_NE(parameter.source, Source("alpha0"));
    EXPECT_FALSE(parameter.source == "e_x" && parameter.limb == 1);
    EXPECT_EQ(parameter.prior_std.has_value(), !(parameter.source == "rod_mean" && parameter.limb == 0));
  }
  EXPECT_EQ(calibration.errors()(0, "alpha0"), 0.0);
}

/// Encoders that were set to zero with care: the rough stage, which seeks nothing else, has nothing to seek.
TEST_P(FineCalibrationLaw, OffsetsMayBeKnownExactly) {
  const MeasuredMachine machine = measured_machine(robot, stations, 9, {.noise = kNoise});
  const Calibration calibration =
      calibrate(robot, machine.measurements, {.fixed = {{"theta_offset", {}}}, .diagnose = false});
  EXPECT_NE(calibration.verdict, Verdict::not_converged) << calibration.brief();
  EXPECT_EQ(calibration.errors()(0, "theta_offset"), 0.0);
}

/// Noise stated, or found from the residuals: the answer is nearly the same, and the estimate is right. A machine tells
/// it to about 12 %: the median of 16 to 4 %, which every fourth degree of freedom lost would show.
TEST_P(FineCalibrationLaw, FindsTheNoiseThatNobodyStated) {
  std::vector<double> noise;
  for (int number = 0; number < machines({.claim = 200, .quick = 16}); ++number) {
    noise.push_back(calibrate(robot, measured_machine(robot, stations, number, {.noise = 0.030}).measurements).noise);
  }
  EXPECT_NEAR(test::quantile(noise, 0.5), 0.030, 0.003);
}

TEST_P(FineCalibrationLaw, SaysWhenReadingsScatterMoreThanStated) {
  MeasuredMachine machine = measured_machine(robot, stations, 10, {.noise = 0.1});
  test::state_sigma(machine.measurements, 0.005);
  const Calibration calibration = calibrate(robot, machine.measurements);
  EXPECT_THAT(calibration.notes, testing::Contains(testing::AnyOf(HasSubstr("times as much as their stated sigmas"),
                                                                  HasSubstr("load or larger noise"))));
}

TEST_P(FineCalibrationLaw, RepeatsNarrowTheAnswer) {
  MeasuredMachine once = measured_machine(robot, stations, 11, {.noise = kNoise});
  MeasuredMachine often = measured_machine(robot, stations, 11, {.noise = kNoise, .repeats = 9});
  test::state_sigma(once.measurements, kNoise);
  test::state_sigma(often.measurements, kNoise);
  const Calibration wide = calibrate(robot, once.measurements), narrow = calibrate(robot, often.measurements);
  double most = 1.0;  // of those that noise limits; others wait for poses that tell them apart
  for (std::size_t k = 0; k < wide.parameters.size(); ++k) {
    EXPECT_LE(*narrow.parameters[k].std, 1.09 * *wide.parameters[k].std);
    most = std::min(most, *narrow.parameters[k].std / *wide.parameters[k].std);
  }
  EXPECT_LT(most, 0.6);
}

TEST_P(FineCalibrationLaw, CompleteDistanceTablesAreAsGoodAsTheirPoints) {
  MeasuredMachine machine = measured_machine(robot, stations, 12, {.noise = kNoise});
  const Calibration points = calibrate(robot, machine.measurements);
  Measurements distances{.stations = machine.measurements.stations,
                         .distances = all_distances(machine.measurements.series[0])};
  const Calibration pairs = calibrate(robot, distances);
  ASSERT_TRUE(pairs.accepted()) << pairs.brief();
  for (std::size_t k = 0; k < points.parameters.size(); ++k) {
    EXPECT_NEAR(pairs.parameters[k].value, points.parameters[k].value, 1e-3 * *points.parameters[k].std);
  }
}

PARACAL_ON_EVERY_ROBOT(FineCalibrationLaw);

/// Median and 95th percentile over machines: distance, aligned position, rotation.
struct Accuracy {
  std::vector<double> distance, aligned, rotation;

  void add(const PoseErrorSummary& errors) {
    distance.push_back(errors.max_abs_distance);
    aligned.push_back(errors.max_volumetric_aligned);
    rotation.push_back(*errors.max_abs_rotation);
  }
};

/// The same machines, measured at the same 19 poses. 95th percentiles want a thousand; of 16 they are the second
/// largest, and still as far apart as the methods.
TEST(CalibrationMethods, BestBeatsThePapers) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Station> stations = fine_stations(robot, 9), held_out = validation_stations(robot);
  Accuracy best, paper;
  for (int number = 0; number < machines({.claim = 1000, .quick = 16}); ++number) {
    const MeasuredMachine machine = measured_machine(robot, stations, number, {.noise = kNoise});
    best.add(held_out_errors(robot, machine.errors,
                             calibrate(robot, machine.measurements, {.states_use = false}).errors(), held_out));
    paper.add(held_out_errors(
        robot, machine.errors,
        calibrate(robot, machine.measurements, {.method = Method::paper, .states_use = false}).errors(), held_out));
  }
  for (const double share : {0.5, 0.95}) {
    EXPECT_LT(test::quantile(best.distance, share), test::quantile(paper.distance, share));
    EXPECT_LT(test::quantile(best.aligned, share), test::quantile(paper.aligned, share));
    EXPECT_LT(test::quantile(best.rotation, share), test::quantile(paper.rotation, share));
  }
}

/// The published machine: 95 % of its virtual twins must be better than half of what the paper measured after
/// calibration, 0.126 mm and 0.8 deg. 1000 twins tell the percentile to 5 %; of 40 it is the third largest, which a
/// plan or a fit that is a third worse lifts above. As good a plan takes 500 candidates; the best one takes all.
TEST(CalibrationMethods, SelectedPosesHalveThePublishedErrors) {
  const Robot robot = catalogue::huang2016();
  const Selection plan =
      select_stations(robot, candidate_stations(robot, machines({.claim = 10000, .quick = 500}), 1), {.poses = 20});
  Accuracy best;
  for (int number = 0; number < machines({.claim = 1000, .quick = 40}); ++number) {
    const SourceErrors truth = test::table4_machine(robot, number);
    const Measurements measurements = test::measure(robot, truth, plan.stations, number, {.noise = kNoise});
    best.add(held_out_errors(robot, truth, calibrate(robot, measurements, {.states_use = false}).errors(),
                             validation_stations(robot)));
  }
  EXPECT_LE(test::quantile(best.distance, 0.95), 0.126 / 2);
  EXPECT_LE(test::quantile(best.rotation, 0.95), to_radians(0.82 / 2));
}

/// Tilt errors are found with a second reflector, and their part in the position with them.
TEST(CalibrationMethods, SecondReflectorFindsTilt) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Station> stations = fine_stations(robot, 9);
  const MeasuredMachine machine =
      measured_machine(robot, stations, 20, {.noise = 0.002, .second = Eigen::Vector3d(30, 0, -150)});
  const Calibration calibration = calibrate(robot, machine.measurements);
  ASSERT_TRUE(calibration.accepted());
  // A small turn of the frame and a constant tilt look alike, so the lever is known to about 150 mm times 1e-3.
  EXPECT_LT((*calibration.frames[0].second - Eigen::Vector3d(30, 0, -150)).norm(), 0.5);
  const Machine truth = build(robot, machine.errors), found = build(robot, calibration.errors());
  double before = 0.0, after = 0.0;
  PlateState home_truth, home_found;
  for (const Station& station : validation_stations(robot)) {
    const Joints joints = believed_joints(robot, station);
    const PlateState is = forward(truth, joints).plate, predicted = forward(found, joints).plate;
    if (station.name == "P0") {
      home_truth = is;
      home_found = predicted;
    }
    // Tilt about x and y relative to home: the frame of the instrument hides a constant one.
    const Eigen::Vector2d tilt = (is.tilt - home_truth.tilt).head<2>();
    before = std::max(before, tilt.norm());
    after = std::max(after, (tilt - (predicted.tilt - home_found.tilt).head<2>()).norm());
  }
  EXPECT_LT(after, 0.25 * before);
}

/// The scatter of 400 machines is known to 4 %, that of 40 to 11 %: correlations that nobody counted make it twice as
/// large.
TEST(CalibrationMethods, PaperStatesTheUncertaintyOfCorrelatedDistances) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Station> stations = fine_stations(robot, 9);
  SourceErrors truth;
  truth(0, "arm_length") = 0.1;
  std::vector<double> found, claimed;
  for (int number = 0; number < machines({.claim = 400, .quick = 40}); ++number) {
    const Calibration calibration =
        calibrate(robot, test::measure(robot, truth, stations, number, {.noise = kNoise}), {.method = Method::paper});
    for (std::size_t k = 0; k < calibration.parameters.size(); ++k) {
      const ParameterEstimate& parameter = calibration.parameters[k];
      if (parameter.source != "arm_length" || parameter.limb != 0) continue;
      found.push_back(parameter.value);
      const auto at = static_cast<Eigen::Index>(k);
      claimed.push_back(std::sqrt(calibration.noise_covariance(at, at)));  // tolerances do not scatter in one machine
    }
  }
  double mean = 0.0, variance = 0.0;
  for (const double value : found) mean += value / static_cast<double>(found.size());
  for (const double value : found) variance += std::pow(value - mean, 2) / static_cast<double>(found.size() - 1);
  const double tolerance = 3.4 / std::sqrt(2.0 * static_cast<double>(found.size()));
  EXPECT_NEAR(test::quantile(claimed, 0.5) / std::sqrt(variance), 1.0, tolerance);
}

/// Eq. (19) knows no weights, whatever sigmas the distances state.
TEST(CalibrationMethods, PaperWeighsAllDistancesAlike) {
  const Robot robot = catalogue::huang2016();
  Measurements stated = io::published_huang2016().rough;
  stated.distances[1].distance_sigma = 1e-3;
  stated.distances[4].distance_sigma = 10.0;
  const auto offsets = [&](const Measurements& measurements) {
    return calibrate(robot, measurements, {.method = Method::paper, .stage = Stage::rough}).parameters;
  };
  const auto alike = offsets(io::published_huang2016().rough), weighed = offsets(stated);
  for (std::size_t k = 0; k < alike.size(); ++k) EXPECT_EQ(alike[k].value, weighed[k].value);
}

/// The chance of a suspect is that of the worst of all readings: a tenth of sound machines have one below 0.1.
TEST(CalibrationMethods, TheWorstOfManyReadingsIsJudgedAsThat) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Station> stations = fine_stations(robot, 9);
  int below = 0;
  constexpr int kMachines = 40, kAtMost = 12;  // 4 are expected; 13 in one of 10,000 runs
  for (int number = 0; number < kMachines; ++number) {
    const MeasuredMachine machine = measured_machine(robot, stations, number, {.noise = kNoise, .repeats = 3});
    const Calibration calibration =
        calibrate(robot, machine.measurements, {.states_use = false, .exclude_outliers = false});
    below += calibration.suspects.front().chance < 0.1;
  }
  EXPECT_LE(below, kAtMost);
  EXPECT_GT(below, 0);
}

TEST(CalibrationMethods, AutomaticStageGoesAsFarAsTheReadingsCarry) {
  const Robot robot = catalogue::huang2016();
  const auto stages = [&](const std::vector<Station>& stations) {
    const MeasuredMachine machine = measured_machine(robot, stations, 30, {.noise = kNoise});
    return calibrate(robot, machine.measurements).stages.size();
  };
  EXPECT_EQ(stages(rough_stations(robot, 6)), 1u);
  EXPECT_EQ(stages(fine_stations(robot, 9)), 2u);
}

/// A twentieth is accepted by chance, and without the test all: 20 tell these apart, 200 whether it is a twentieth.
TEST(CalibrationMethods, NoisyNothingIsNotAccepted) {
  const Robot robot = catalogue::huang2016();
  int accepted = 0;
  const int count = machines({.claim = 200, .quick = 20});
  for (int number = 0; number < count; ++number) {
    Measurements measurements = test::measure(robot, {}, fine_stations(robot, 9), number, {.noise = kNoise});
    test::state_sigma(measurements, kNoise);
    accepted += calibrate(robot, measurements).accepted();
  }
  EXPECT_LE(accepted, boost::math::quantile(boost::math::binomial_distribution<>(count, 0.05), 0.999));
}

TEST(CalibrationMethods, NonsensePointsAreRefused) {
  const Robot robot = catalogue::huang2016();
  const auto refusal = [&](auto spoil) {
    Measurements measurements = measured_machine(robot, fine_stations(robot, 4), 1, {}).measurements;
    spoil(measurements.series[0].readings[2]);
    try {
      (void)calibrate(robot, measurements);
    } catch (const Error& complaint) {
      return std::string(complaint.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal([](auto& r) { r.station = 99; }), HasSubstr("reading 3: expected a station"));
  EXPECT_THAT(refusal([](auto& r) { r.point.x() = NAN; }), HasSubstr("reading 3: expected a finite point"));
  EXPECT_THAT(refusal([](auto& r) { r.sigma = 0.0; }), HasSubstr("sigma above 0 mm"));
  EXPECT_THAT(refusal([](auto& r) { r.rotation = INFINITY; }), HasSubstr("finite rotation"));
  EXPECT_THAT(refusal([](auto& r) { r.second = Eigen::Vector3d(0, 0, NAN); }), HasSubstr("finite second point"));
}

}  // namespace
}  // namespace paracal::fine_calibration_test
