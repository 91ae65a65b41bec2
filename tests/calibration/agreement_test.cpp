// Readings of any kind against what a calibration says of its own uncertainty.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::agreement_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNoise = 0.017;  // mm

/// A machine, its calibration, and where it goes at other poses.
class AgreementLaw : public test::EveryRobot {
 protected:
  void calibrate_machine(int number) {
    measured = test::measured_machine(robot, fine_stations(robot, 9), number, {.noise = kNoise, .repeats = 2});
    known = known_errors(calibrate(robot, measured.measurements));
  }

  Measurements points(int number, VirtualInstrument instrument) const {
    return test::measure(robot, measured.errors, validation_stations(robot), 100 + number, std::move(instrument));
  }

  /// Distances from home and heights above a tilted plane at other poses, as they are.
  Measurements distances_and_heights() const {
    Measurements read{.stations = fine_stations(robot, 5), .lengths = {{"bed"}}};
    const std::vector<Eigen::Vector3d> places = places_of(measured.errors, read.stations);
    for (std::size_t k = 0; k < places.size(); ++k) {
      read.lengths[0].readings.push_back({.station = k, .length = above_plane(places[k])});
      if (k > 0) read.distances.push_back({.from = 0, .to = k, .distance = (places[k] - places[0]).norm()});
    }
    return read;
  }

  std::vector<Eigen::Vector3d> places_of(const SourceErrors& errors, const std::vector<Station>& stations) const {
    std::vector<Eigen::Vector3d> places;
    const Machine machine = build(robot, errors);
    for (const Station& station : stations) {
      places.push_back(forward(machine, believed_joints(robot, station)).plate.position);
    }
    return places;
  }

  double above_plane(const Eigen::Vector3d& p) const {
    return p.z() - robot.workspace().top_z - 0.7 - 2e-3 * p.x() + 1e-3 * p.y();
  }

  test::MeasuredMachine measured;
  KnownErrors known;
};
PARACAL_ON_EVERY_ROBOT(AgreementLaw);

/// chi^2 / freedom of 20 machines: their mean lies within 4 standard deviations of 1, below which the uncertainty that
/// Student's k adds may bring it by a tenth; none is told.
TEST_P(AgreementLaw, SoundMachinesAgree) {
  constexpr int kMachines = 20;
  double sum = 0.0, freedom = 0.0;
  for (int number = 0; number < kMachines; ++number) {
    calibrate_machine(number);
    const Validation validation =
        validate(robot, known, points(number, {.noise = kNoise}), {.noise = {.point = kNoise}, .noise_is_known = true});
    ASSERT_TRUE(validation.agreement);
    EXPECT_FALSE(validation.agreement->contradicts()) << "machine " << number;
    EXPECT_TRUE(std::isinf(validation.agreement->noise_dof));
    sum += validation.agreement->chi_square;
    freedom += validation.agreement->freedom;
  }
  const double spread = 4.0 * std::sqrt(2.0 / freedom);
  EXPECT_LT(sum / freedom, 1.0 + spread);
  EXPECT_GT(sum / freedom, 0.9 - spread);
}

/// The same where repeats tell the noise: the chance is spread over all of (0, 1). A sample of 30 without one below, or
/// above, a quarter has a probability of 2e-4.
TEST_P(AgreementLaw, TheChanceIsSpreadWhereRepeatsTellTheNoise) {
  double least = 1.0, most = 0.0;
  for (int number = 0; number < 30; ++number) {
    calibrate_machine(number);
    const Measurements read =
        test::measure(robot, measured.errors, fine_stations(robot, 5), 200 + number, {.noise = kNoise, .repeats = 2});
    const Validation validation = validate(robot, known, read);
    ASSERT_TRUE(validation.agreement);
    EXPECT_FALSE(validation.agreement->contradicts()) << "machine " << number;
    least = std::min(least, validation.agreement->chance);
    most = std::max(most, validation.agreement->chance);
  }
  EXPECT_LT(least, 0.25);
  EXPECT_GT(most, 0.75);
}

/// A machine of which one encoder was knocked after it was calibrated.
TEST_P(AgreementLaw, AChangedMachineIsTold) {
  calibrate_machine(3);
  const Measurements same = points(3, {.noise = kNoise, .repeats = 3});
  EXPECT_FALSE(validate(robot, known, same).agreement->contradicts());
  measured.errors(0, "theta_offset") += robot.actuator() == Actuator::linear ? 0.3 : 1e-3;
  const Validation validation = validate(robot, known, points(3, {.noise = kNoise, .repeats = 3}));
  ASSERT_TRUE(validation.agreement);
  EXPECT_TRUE(validation.agreement->contradicts());
  EXPECT_FALSE(validation.accepted.has_value());
  EXPECT_THAT(validation.reasons, Contains(HasSubstr("differ from the predictions")));
  // Within limits that it keeps for certain it is accepted all the same, and a note says what is wrong.
  const Validation limited =
      validate(robot, known, points(3, {.noise = kNoise, .repeats = 3}), {.limits = {.distance = 50.0}});
  EXPECT_EQ(limited.accepted, true);
  EXPECT_THAT(limited.notes, ElementsAre(HasSubstr("differ from the predictions")));
  if (!robot.slide()) return;
  const Validation turned = validate(robot, known, points(3, {.noise = kNoise, .repeats = 3, .reads_rotation = true}),
                                     {.limits = {.rotation = 1.0}});
  EXPECT_EQ(turned.accepted, false) << "a limit on rotations says nothing of positions";
}

/// Joints that stand elsewhere at each pose contradict a calibration that knows of none, not one that states them.
TEST_P(AgreementLaw, JointsThatStandElsewhereAreToldUnlessStated) {
  calibrate_machine(4);
  test::Random random(4);
  const double backlash = 3e-4 * test::joint_scale(robot);
  Measurements read{.stations = validation_stations(robot), .series = {{"tracker", {}}}};
  for (Station& station : read.stations) {
    const Joints believed = believed_joints(robot, station);
    Joints true_ones = believed;
    for (double& joint : true_ones) joint += random.normal(backlash);
    const Machine machine = build(robot, measured.errors);
    const Eigen::Vector3d place = forward(machine, true_ones).plate.position;
    read.series[0].readings.push_back(
        {.station = static_cast<std::size_t>(&station - read.stations.data()), .point = place, .sigma = kNoise});
    station.believed = believed;
  }
  EXPECT_TRUE(validate(robot, known, read).agreement->contradicts());
  known.joint_std = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(robot.limb_count()), backlash);
  EXPECT_FALSE(validate(robot, known, read).agreement->contradicts());
}

/// Repeats estimate noise that nobody stated; neither: nobody can tell.
TEST_P(AgreementLaw, NoiseComesFromRepeatsOrNobodyCanTell) {
  calibrate_machine(5);
  const Validation once = validate(robot, known, points(5, {.noise = 5.0 * kNoise}));
  EXPECT_FALSE(once.agreement);
  EXPECT_THAT(once.notes, ElementsAre(HasSubstr("cannot check the uncertainty"), HasSubstr("is a typical")));
  const Validation thrice = validate(robot, known, points(5, {.noise = 5.0 * kNoise, .repeats = 3}));
  ASSERT_TRUE(thrice.agreement);
  EXPECT_EQ(thrice.agreement->noise_dof, 2.0 * 3.0 * static_cast<double>(validation_stations(robot).size()));
  EXPECT_FALSE(thrice.agreement->contradicts());
  EXPECT_THAT(thrice.notes, IsEmpty());
  const Validation wrong = validate(robot, known, points(5, {.noise = 5.0 * kNoise, .repeats = 3}),
                                    {.noise = {.point = kNoise}, .noise_is_known = true});
  EXPECT_THAT(wrong.notes,
              ElementsAre(testing::MatchesRegex(
                  "repeated visits of a pose scatter [45]\\.[0-9] times as much as the stated noise: check.*")));
  EXPECT_FALSE(wrong.agreement->contradicts());
}

TEST_P(AgreementLaw, DistancesAndHeightsAreTrueAgainstPredicted) {
  calibrate_machine(6);
  const Measurements read = distances_and_heights();
  const Validation validation = validate(robot, known, read);
  const auto nominal = places_of({}, read.stations), predicted = places_of(known.errors, read.stations);
  ASSERT_EQ(validation.readings.size(), read.distances.size() + read.lengths[0].readings.size());
  for (std::size_t k = 0; k < read.distances.size(); ++k) {
    const CheckedReading& one = validation.readings[k];
    const std::size_t to = read.distances[k].to;
    EXPECT_FALSE(one.length);
    EXPECT_NEAR(one.before, read.distances[k].distance - (nominal[to] - nominal[0]).norm(), 1e-6);
    EXPECT_NEAR(one.after, read.distances[k].distance - (predicted[to] - predicted[0]).norm(), 1e-6);
    EXPECT_LT(std::abs(one.after), one.U);
    EXPECT_EQ(one.sigma, NoiseModel{}.distance);
    EXPECT_GT(one.U, 2.0 * one.sigma);
    EXPECT_LT(one.U, 2.2 * one.sigma);  // the calibration is known better than the reading
  }
  // Heights scatter about the plane that fits them best as those of the predicted places do.
  double squares = 0.0, count = 0.0;
  for (const CheckedReading& one : validation.readings) {
    if (!one.length) continue;
    squares += one.after * one.after;
    ++count;
    EXPECT_LT(std::abs(one.after), one.U);
    EXPECT_LT(one.U, 2.2 * one.sigma);  // how high the whole robot stands is taken up by the plane
  }
  ASSERT_TRUE(validation.after.rms_lengths.contains(LengthKind::height));
  EXPECT_NEAR(validation.after.rms_lengths.at(LengthKind::height), std::sqrt(squares / count), 1e-12);
  EXPECT_LT(validation.after.rms_lengths.at(LengthKind::height), 0.05);
  EXPECT_GT(validation.before.rms_lengths.at(LengthKind::height),
            3.0 * validation.after.rms_lengths.at(LengthKind::height));
  EXPECT_TRUE(validation.after.reads_distances);
}

/// The uncertainty of a distance by hand: sigma, and the calibration's by differences of the predicted distance.
TEST_P(AgreementLaw, UncertaintyOfADistanceByHand) {
  calibrate_machine(7);
  Measurements read = distances_and_heights();
  read.lengths.clear();
  for (DistanceReading& one : read.distances) one.distance_sigma = 0.01;
  known.covariance *= 100.0;
  known.noise_covariance *= 100.0;
  constexpr double kScale = 3e-5;
  std::erase_if(known.parameters, [](const SoughtSource& one) { return one.knot.has_value(); });  // parts alone
  known.covariance = known.covariance.topLeftCorner(std::ssize(known.parameters), std::ssize(known.parameters)).eval();
  known.joint_std = known.visit_std = {};
  const Validation validation = validate(robot, known, read, {.scale_std = kScale});
  const std::size_t to = read.distances[2].to;
  const auto length = [&](const SourceErrors& errors) {
    const auto places = places_of(errors, read.stations);
    return (places[to] - places[0]).norm();
  };
  Eigen::RowVectorXd row(std::ssize(known.parameters));
  for (std::size_t k = 0; k < known.parameters.size(); ++k) {
    SourceErrors up = known.errors, down = known.errors;
    up(known.parameters[k].limb, known.parameters[k].source) += 1e-5;
    down(known.parameters[k].limb, known.parameters[k].source) -= 1e-5;
    row(static_cast<Eigen::Index>(k)) = (length(up) - length(down)) / 2e-5;
  }
  const double variance = (row * known.expanded_covariance() * row.transpose())(0);
  EXPECT_GT(variance, 1e-5);
  const double by_scale = kScale * length(known.errors);
  const double by_hand = 2.0 * std::sqrt(0.01 * 0.01 + variance + by_scale * by_scale);
  // Four limbs neglect a curvature (exact_jacobian.hpp): some 1e-6 of the result, and 1e-3 at most.
  EXPECT_NEAR(validation.readings[2].U, by_hand, 1e-5 * by_hand);
}

TEST_P(AgreementLaw, LimitsNeedReadingsOfTheirKind) {
  calibrate_machine(8);
  Measurements heights = distances_and_heights(), distances = heights;
  heights.distances.clear();
  distances.lengths.clear();
  const ValidationOptions limits{.limits = {.distance = 0.5, .volumetric = 0.5}};
  EXPECT_THAT(validate(robot, known, heights, limits).reasons,
              ElementsAre(HasSubstr("got only heights"), HasSubstr("expected points")));
  EXPECT_THAT(validate(robot, known, distances, limits).reasons, ElementsAre(HasSubstr("expected points")));
  const Validation kept = validate(robot, known, distances, {.scale_std = 0.0, .limits = {.distance = 0.5}});
  EXPECT_EQ(kept.accepted, true);
  EXPECT_EQ(kept.checks[0].uncertainty, 2.0 * NoiseModel{}.distance);
  // The instrument may count the longest longer or shorter, and all of them by as much.
  const double longest = std::ranges::max(distances.distances, {}, &DistanceReading::distance).distance;
  const ValidationOptions doubtful{.noise = {.distance_bias = 0.3}, .scale_std = 2e-4, .limits = {.distance = 2.0}};
  EXPECT_NEAR(validate(robot, known, distances, doubtful).checks[0].uncertainty,
              2.0 * std::hypot(NoiseModel{}.distance, 2e-4 * longest, 0.3), 1e-12);
  const ValidationOptions tight{.limits = {.distance = 0.15}};
  EXPECT_EQ(validate(robot, known, distances, tight).checks[0].conformity, Conformity::conforming);
  EXPECT_EQ(validate(robot, known, distances, {.limits = {.distance = 0.09}}).checks[0].conformity,
            Conformity::undecided);
}

/// A rotation that an encoder read with a distance is one, with U of that reading.
TEST_P(AgreementLaw, RotationsReadWithDistancesCount) {
  if (!robot.slide()) return;
  calibrate_machine(8);
  Measurements read = distances_and_heights();
  const Machine machine = build(robot, measured.errors);
  const auto phi = [&](std::size_t k) {
    return machine.rotation_of(forward(machine, believed_joints(robot, read.stations[k])).plate.slide);
  };
  for (DistanceReading& one : read.distances) one.rotation = phi(one.to) - phi(one.from);
  const Validation validation =
      validate(robot, known, read, {.noise = {.rotation = 2e-3}, .limits = {.rotation = 0.05}});
  ASSERT_TRUE(validation.before.max_abs_rotation && validation.after.max_abs_rotation);
  EXPECT_GT(*validation.before.max_abs_rotation, 10.0 * *validation.after.max_abs_rotation);
  ASSERT_EQ(validation.checks.size(), 1u);
  EXPECT_EQ(validation.checks[0].uncertainty, 2.0 * 2e-3);
  EXPECT_EQ(validation.accepted, true);
}

TEST_P(AgreementLaw, WithoutLimitsTheGainMustBeMeasurable) {
  calibrate_machine(9);
  Measurements read = distances_and_heights();
  EXPECT_THAT(validate(robot, known, read).reasons, IsEmpty());
  EXPECT_THAT(validate(robot, {}, read).reasons, ElementsAre(HasSubstr("the largest distance error changed from")));
  Measurements metres = read;
  for (DistanceReading& one : metres.distances) one.distance *= 1e-3;
  metres.lengths.clear();
  metres.distances.resize(2);
  EXPECT_THAT(validate(robot, known, metres).reasons, ElementsAre(HasSubstr("not significant")));
  read.distances.clear();
  EXPECT_THAT(validate(robot, known, read).reasons, IsEmpty());
  EXPECT_THAT(validate(robot, {}, read).reasons, ElementsAre(HasSubstr("the largest height error changed from")));
  read.lengths[0].readings.resize(3);
  EXPECT_THAT([&] { (void)validate(robot, known, read); },
              testing::ThrowsMessage<InvalidArgument>(HasSubstr("more readings than unknowns of their setup")));
}

}  // namespace
}  // namespace paracal::agreement_test
