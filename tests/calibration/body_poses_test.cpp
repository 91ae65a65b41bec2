// Full poses: position and orientation of a body somewhere on the plate, as motion capture reads them.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "calibration/fit/observation.hpp"
#include "calibration/fit/sought.hpp"
#include "calibration/readings/body.hpp"
#include "kinematics/turns.hpp"
#include "observation_derivatives.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::body_poses_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

constexpr double kNoise = 0.05;            // mm
constexpr double kTurn = to_radians(0.1);  // of an orientation

NoiseModel known_noise() { return {.body = kNoise, .rotation = kTurn}; }

CalibrationOptions told(ReflectorMount mount) {
  CalibrationOptions options{.noise = known_noise(), .noise_is_known = true, .reflectors = mount};
  options.states_use = options.diagnose = false;
  options.stage = Stage::fine;
  return options;
}

/// Anywhere within some metres, turned anyhow.
RigidMotion random_frame(RandomStream& random) {
  RigidMotion frame = random_body(random);
  frame.translation *= 60.0;
  return frame;
}

VirtualInstrument random_instrument(ReflectorMount mount, RandomStream& random) {
  VirtualInstrument instrument{.noise = kNoise, .rotation_noise = kTurn, .mount = mount};
  instrument.frame = random_frame(random);
  instrument.body = random_body(random);
  return instrument;
}

class BodyPoses : public test::EveryRobot {
 protected:
  Measurements plan(const std::vector<Station>& stations, ReflectorMount mount) const {
    return planned(robot, stations, {.measurand = Measurand::poses, .mount = mount});
  }

  Measurements read(const SourceErrors& errors, ReflectorMount mount, RandomStream& stream, int n = 14) const {
    const VirtualInstrument instrument = random_instrument(mount, stream);
    return simulate(robot, errors, plan(fine_stations(robot, n), mount), instrument, stream);
  }

  SourceErrors drawn(RandomStream& stream) const { return draw_errors(robot, tolerances_of(robot), stream); }

  /// The mounts that differ: a plate without a slide turns nothing.
  std::vector<ReflectorMount> mounts() const {
    if (!robot.slide()) return {ReflectorMount::plate};
    return {kReflectorMounts.begin(), kReflectorMounts.end()};
  }
};
PARACAL_ON_EVERY_ROBOT(BodyPoses);
PARACAL_ON_UNUSUAL_ROBOTS(BodyPoses);

/// By hand, of the nominal machine: a body b away from the centre stands at F (r + Rot(z, phi) b).
TEST_P(BodyPoses, AreWhatTheyAre) {
  RandomStream stream(1);
  for (const ReflectorMount mount : mounts()) {
    VirtualInstrument instrument = random_instrument(mount, stream);
    instrument.noise = instrument.rotation_noise = 0.0;
    const std::vector<Station> stations = fine_stations(robot, 4);
    const Measurements shown = simulate(robot, {}, plan(stations, mount), instrument, stream);
    for (const PointReading& reading : shown.series[0].readings) {
      const Pose& pose = stations[reading.station].commanded;
      const Eigen::Matrix3d turned =
          Eigen::AngleAxisd(turns_per_phi(mount) * pose.rotation, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      const Eigen::Vector3d point = instrument.frame(pose.position + turned * instrument.body.translation);
      EXPECT_LT((reading.point - point).norm(), 1e-6);
      const Eigen::Matrix3d orientation = instrument.frame.rotation * turned * instrument.body.rotation;
      EXPECT_LT((reading.orientation->toRotationMatrix() - orientation).norm(), 1e-8);
    }
  }
}

TEST_P(BodyPoses, DerivativesAreDifferences) {
  RandomStream stream(2);
  for (const ReflectorMount mount : mounts()) {
    const CalibrationOptions options{.reflectors = mount};
    const SourceErrors truth = drawn(stream), other = drawn(stream);
    const Measurements measured = read(truth, mount, stream, 6);
    detail::Observation observation(robot, measured, options, detail::all_with_priors(robot, options), true);
    SourceErrors near = truth;  // a hundredth of a tolerance away, where residuals are not small but derivatives linear
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : all_sources()) near(limb, source) += 0.01 * other(limb, source);
    }
    Eigen::VectorXd unknowns = *observation.start(near);
    unknowns.head(observation.nuisance_count()).array() += 1e-3;  // not where start() left it
    Eigen::MatrixXd block;
    for (const detail::Group& group : observation.groups()) {
      observation.rows(group, *observation.stations(unknowns), unknowns, block);
      EXPECT_EQ(block.rows(), 6);
    }
    EXPECT_TRUE(test::derivatives_are_differences(observation, unknowns));
  }
}

/// Readings without noise give the machine back, from a set-up that nobody knows: what they show of it, to what is left
/// of its tolerances.
TEST_P(BodyPoses, WithoutNoiseGiveTheErrorsBack) {
  for (const ReflectorMount mount : mounts()) {
    RandomStream stream(3);
    const SourceErrors truth = drawn(stream);
    VirtualInstrument instrument = random_instrument(mount, stream);
    instrument.noise = instrument.rotation_noise = 0.0;
    const Measurements exact = simulate(robot, truth, plan(fine_stations(robot, 20), mount), instrument, stream);
    CalibrationOptions options = told(mount);
    options.noise.body = 1e-3;  // far above where the kinematics end
    options.noise.rotation = 1e-5;
    options.scale_std = 0.0;
    const Calibration found = calibrate(robot, exact, options);
    ASSERT_TRUE(found.accepted()) << found.brief();
    const PoseErrorSummary left = test::held_out_errors(robot, truth, found.errors(), workspace_stations(robot));
    EXPECT_LT(left.max_volumetric_aligned, 0.02) << name(mount);
    for (const ParameterEstimate& one : found.parameters) {
      if (one.held || one.data_share < 0.999) continue;
      EXPECT_NEAR(one.value, truth(one.limb, one.source), 0.1 * *one.prior_std) << name(one.source) << name(mount);
    }
    EXPECT_LT(*found.after.max_orientation, 1e-4);
    for (const PointResidual& one : found.points) {
      EXPECT_LT(one.after.norm(), 0.01);
      EXPECT_LT(one.orientation_after->norm(), 1e-4);
    }
  }
}

/// What became of the intervals of identified errors, and of U in use.
struct Shares {
  int accepted = 0, errors = 0, errors_held = 0, used = 0;

  double errors_share() const { return static_cast<double>(errors_held) / std::max(errors, 1); }
  double used_share() const { return static_cast<double>(used) / std::max(accepted, 1); }
};

void judge(const Robot& robot, const SourceErrors& truth, const Calibration& found, Shares& shares) {
  EXPECT_TRUE(found.accepted()) << found.brief();
  if (!found.accepted()) return;
  ++shares.accepted;
  for (const ParameterEstimate& one : found.parameters) {
    if (!one.identified() || !one.std) continue;
    ++shares.errors;
    shares.errors_held += std::abs(one.value - truth(one.limb, one.source)) <= one.coverage() * *one.std ? 1 : 0;
  }
  const PoseErrorSummary in_use = test::held_out_errors(robot, truth, found.errors(), workspace_stations(robot));
  shares.used += in_use.max_volumetric_aligned <= found.use->aligned.U ? 1 : 0;
}

/// The law that a calibration is held to, written down before: of 160 machines, each with its set-up anywhere and
/// turned anyhow, 95 % intervals of identified errors hold the truth in 93 to 97 % (as much more as shares scatter more
/// where fewer are tried; of 32 by 4.5 %, which still tells intervals that are a third too narrow or too wide), and U
/// in use holds in 90 % and more. Nobody states the noise; positions scatter a sixth and orientations a third as much
/// as is assumed where nobody does, so that both levels have to be found.
TEST_P(BodyPoses, IntervalsHoldTheTruth) {
  const test::Machines wanted{.claim = 160, .quick = 32};
  const int machines = test::machines(wanted);
  for (const ReflectorMount mount : mounts()) {
    if (mount == ReflectorMount::end_effector_reversed) continue;
    Shares shares;
    for (int number = 0; number < machines; ++number) {
      RandomStream stream(number, 21);
      const SourceErrors truth = drawn(stream);
      CalibrationOptions options{.reflectors = mount};
      options.diagnose = false;
      judge(robot, truth, calibrate(robot, read(truth, mount, stream), options), shares);
    }
    SCOPED_TRACE(name(mount));
    RecordProperty(std::string("shares_") + std::string(name(mount)),
                   fmt::format("{} of {} errors: {:.4f}; in use {:.3f}; accepted {} of {}", shares.errors_held,
                               shares.errors, shares.errors_share(), shares.used_share(), shares.accepted, machines));
    EXPECT_NEAR(shares.errors_share(), 0.95, 0.02 * test::looser(wanted));
    EXPECT_GE(shares.used_share(), 0.90 - 3.0 * std::sqrt(0.09 / machines));
  }
}

/// With readings of another kind: distances between positions of the plate centre, which a body does not show.
TEST_P(BodyPoses, MixWithDistances) {
  RandomStream stream(13);
  const SourceErrors truth = drawn(stream);
  const std::vector<Station> stations = fine_stations(robot, 8);
  Measurements measured = read(truth, ReflectorMount::plate, stream, 8);
  CalibrationOptions options;
  options.diagnose = false;
  options.noise.distance = 0.01;
  const Calibration alone = calibrate(robot, measured, options);
  measured.distances = simulate(robot, truth, planned(robot, stations, {.measurand = Measurand::home_distances}),
                                {.noise = 0.01}, stream)
                           .distances;
  const Calibration mixed = calibrate(robot, measured, options);
  ASSERT_TRUE(mixed.accepted()) << mixed.brief();
  EXPECT_EQ(mixed.readings, 2 * stations.size() - 1);
  // Noise of two kinds that nobody stated: the fit gives them one factor, and U holds what that costs.
  EXPECT_LT(mixed.use->distance.U, 2.0 * alone.use->distance.U);
  EXPECT_NEAR(mixed.noise, kNoise, 0.3 * kNoise);  // a sixth of what is assumed, orientations a third: each by itself
  EXPECT_NEAR(*mixed.orientation_noise, kTurn, 0.3 * kTurn);
}

/// q and -q turn alike.
TEST_P(BodyPoses, TheSignOfAQuaternionSaysNothing) {
  RandomStream stream(4);
  const SourceErrors truth = drawn(stream);
  const Measurements given = read(truth, ReflectorMount::plate, stream);
  Measurements changed = given;
  for (std::size_t k = 0; k < changed.series[0].readings.size(); k += 3) {
    Quaternion& q = *changed.series[0].readings[k].orientation;
    q.coeffs() = -q.coeffs();
  }
  const CalibrationOptions options = told(ReflectorMount::plate);
  const Calibration one = calibrate(robot, given, options), other = calibrate(robot, changed, options);
  for (std::size_t k = 0; k < one.parameters.size(); ++k) {
    EXPECT_NEAR(one.parameters[k].value, other.parameters[k].value, 1e-6 * *one.parameters[k].std);
  }
}

/// Whichever way a body is turned, half a turn included, and with numbers of four digits.
TEST_P(BodyPoses, ABodyMayStandOnItsHead) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d::UnitX().eval(), Eigen::Vector3d::UnitZ().eval()}) {
    RandomStream stream(5);
    const SourceErrors truth = drawn(stream);
    const ReflectorMount mount = mounts().back();
    VirtualInstrument instrument = random_instrument(mount, stream);
    instrument.body = {Eigen::AngleAxisd(std::numbers::pi, axis).toRotationMatrix(), {80.0, -60.0, 40.0}};
    instrument.frame.rotation = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
    Measurements measured = simulate(robot, truth, plan(fine_stations(robot, 14), mount), instrument, stream);
    for (PointReading& reading : measured.series[0].readings) {
      for (double& number : reading.orientation->coeffs()) number = std::round(1e4 * number) / 1e4;
    }
    CalibrationOptions options = told(mount);
    options.states_use = true;
    const Calibration found = calibrate(robot, measured, options);
    ASSERT_TRUE(found.accepted()) << found.brief();
    const RigidMotion body = found.frames.at(0).body.value();
    EXPECT_LT(detail::turn_of(body.rotation.transpose() * instrument.body.rotation).norm(),
              to_radians(3.0));  // the zero of phi
    if (mount != ReflectorMount::plate) {
      EXPECT_LT((body.translation - instrument.body.translation).head<2>().norm(), 5.0);
    }
  }
}

/// Where the body sits nobody sees on a plate that does not turn: the frame takes it up, the fit is not singular, and
/// what was taken for granted instead is said. On one that turns only the height is left open.
TEST_P(BodyPoses, WhatThePlateDoesNotShowIsAssumed) {
  for (const ReflectorMount mount : mounts()) {
    RandomStream stream(6);
    const SourceErrors truth = drawn(stream);
    const Calibration found = calibrate(robot, read(truth, mount, stream), told(mount));
    ASSERT_TRUE(found.accepted()) << found.brief();
    EXPECT_THAT(found.assumed, Contains("the body of poses has its origin within about 100 mm of the plate centre "
                                        "(standard deviation per axis): the plate rotates too little to determine it"));
    EXPECT_LT(found.frames.at(0).body->translation.norm(), 1000.0);
  }
}

/// Not where the frame is the robot's: then every position shows the body.
TEST_P(BodyPoses, AKnownFrameShowsTheBody) {
  RandomStream stream(7);
  const SourceErrors truth = drawn(stream);
  VirtualInstrument instrument = random_instrument(ReflectorMount::plate, stream);
  instrument.frame = {};
  const Measurements measured =
      simulate(robot, truth, plan(fine_stations(robot, 14), ReflectorMount::plate), instrument, stream);
  CalibrationOptions options = told(ReflectorMount::plate);
  options.frame = Frame::robot;
  const Calibration found = calibrate(robot, measured, options);
  ASSERT_TRUE(found.accepted()) << found.brief();
  EXPECT_THAT(found.assumed, Not(Contains(HasSubstr("the body of"))));
  EXPECT_LT((found.frames.at(0).body->translation - instrument.body.translation).norm(), 3.0);
}

/// Readings of positions, orientations and noise that states are all used: an orientation tells tilt errors that points
/// alone do not.
TEST_P(BodyPoses, ShowTheTilt) {
  const CalibrationOptions options = told(ReflectorMount::plate);
  const std::vector<Station> stations = fine_stations(robot, 14);
  const Identifiability poses = identifiability(robot, plan(stations, ReflectorMount::plate), options);
  const Identifiability seconds = identifiability(robot, planned(robot, stations, {.second = true}), options);
  EXPECT_EQ(poses.rows, 6 * std::ssize(stations));
  EXPECT_EQ(poses.nuisance, 12);
  EXPECT_EQ(poses.parameters.size(), seconds.parameters.size());
  EXPECT_GE(poses.rank, seconds.rank);
  // More readings, and as exact, show no less: not even what a set-up would swallow that nothing holds.
  CalibrationOptions alike = options;
  alike.noise.point = alike.noise.body;
  const std::vector<SoughtSource> position = detail::position_group(robot, alike);
  const Eigen::VectorXd of_poses =
      identifiability(robot, plan(stations, ReflectorMount::plate), alike, position).singular_values;
  const Eigen::VectorXd of_points = identifiability(robot, planned(robot, stations), alike, position).singular_values;
  EXPECT_GE((of_poses - of_points).minCoeff(), -1e-6 * of_points(0)) << of_poses.transpose() << of_points.transpose();
  const Selection chosen = select_stations(robot, candidate_stations(robot, 200, 3),
                                           {.poses = 8, .readings = {.measurand = Measurand::poses}});
  EXPECT_EQ(chosen.stations.size(), 8u);
  EXPECT_LT(chosen.uncertainty.rms_aligned, chosen.curve.front().rms_aligned);
}

/// 5 mm in a position, 5 deg in an orientation: left out by name.
TEST_P(BodyPoses, AGrossReadingIsLeftOut) {
  for (const bool turned : {false, true}) {
    RandomStream stream(8);
    const SourceErrors truth = drawn(stream);
    Measurements measured = read(truth, ReflectorMount::plate, stream);
    PointReading& gross = measured.series[0].readings[9];
    if (turned) {
      gross.orientation = *gross.orientation * Quaternion(Eigen::AngleAxisd(to_radians(5.0), Eigen::Vector3d::UnitX()));
    } else {
      gross.point.x() += 5.0;
    }
    CalibrationOptions options;
    options.states_use = options.diagnose = false;
    const Calibration found = calibrate(robot, measured, options);
    for (std::size_t k = 0; k < found.points.size(); ++k) EXPECT_EQ(found.points[k].excluded, k == 9) << k << turned;
    EXPECT_EQ(found.suspects.front().text, "P9 of poses");
  }
}

/// A calibration holds at poses that it has not seen, by another set-up; as long as nobody bends the machine.
TEST_P(BodyPoses, Validate) {
  for (const ReflectorMount mount : mounts()) {
    RandomStream stream(9);
    const SourceErrors truth = drawn(stream);
    CalibrationOptions options = told(mount);
    const Calibration found = calibrate(robot, read(truth, mount, stream), options);
    const ValidationOptions how{.noise = known_noise(), .noise_is_known = true, .reflectors = mount};
    const Measurements others = read(truth, mount, stream, 6);
    const Validation seen = validate(robot, known_errors(found), others, how);
    ASSERT_TRUE(seen.agreement);
    EXPECT_FALSE(seen.agreement->contradicts()) << seen.agreement->chance;
    EXPECT_THAT(seen.reasons, testing::IsEmpty());
    EXPECT_LT(seen.after.max_volumetric_aligned, 0.5 * seen.before.max_volumetric_aligned);
    EXPECT_LT(seen.after.max_volumetric_aligned, 6.0 * kNoise);
    EXPECT_LT(*seen.after.max_orientation, 6.0 * kTurn);
    EXPECT_GT(*seen.before.max_orientation, 0.0);
    EXPECT_EQ(seen.after.max_abs_rotation.has_value(), mount != ReflectorMount::plate);
    EXPECT_LT(seen.after.max_abs_rotation.value_or(0.0), 6.0 * kTurn);
    Measurements turned = others;
    for (std::size_t k = 0; k < 3; ++k) {
      Quaternion& q = *turned.series[0].readings[k].orientation;
      q = q * Quaternion(Eigen::AngleAxisd(to_radians(1.0), Eigen::Vector3d::UnitX()));
    }
    EXPECT_TRUE(validate(robot, known_errors(found), turned, how).agreement->contradicts());
    EXPECT_THAT(seen.reasons, Not(Contains(HasSubstr("--reflectors"))));
    Measurements knocked = others;  // out of its place on the way: no mount is to blame
    for (std::size_t k = 3; k < knocked.series[0].readings.size(); ++k) {
      Quaternion& q = *knocked.series[0].readings[k].orientation;
      q = q * Quaternion(Eigen::AngleAxisd(to_radians(20.0), Eigen::Vector3d::UnitX()));
    }
    const Validation after_knock = validate(robot, known_errors(found), knocked, how);
    EXPECT_GT(*after_knock.after.max_orientation, to_radians(5.0));
    EXPECT_FALSE(after_knock.reasons.empty() && !after_knock.agreement->contradicts());
    EXPECT_THAT(after_knock.reasons, Not(Contains(HasSubstr("--reflectors"))));
    for (const ReflectorMount other : mounts()) {
      ValidationOptions wrong = how;
      wrong.reflectors = other;
      const Validation mistaken = validate(robot, known_errors(found), others, wrong);
      EXPECT_EQ(mistaken.reasons.empty(), other == mount);
      if (other == mount) continue;
      EXPECT_EQ(mistaken.reasons.front(),
                fmt::format("the readings match a body with --reflectors {}: use that option", name(mount)));
    }
  }
}

/// Refused before any fit.
TEST_P(BodyPoses, RefuseWhatMakesNoSense) {
  RandomStream stream(10);
  const Measurements good = read({}, ReflectorMount::plate, stream, 4);
  const auto refused = [&](const auto& change, const std::string& message) {
    Measurements bad = good;
    change(bad.series[0].readings[2]);
    EXPECT_THAT([&] { check(bad, robot.limb_count()); },
                ThrowsMessage<InvalidArgument>("poses, reading 3: " + message));
  };
  EXPECT_NO_THROW(check(good, robot.limb_count()));
  refused([](PointReading& one) { one.orientation->coeffs() *= 1.01; },
          "expected a quaternion of length 1, got one of 1.01");
  refused([](PointReading& one) { one.orientation->w() = NAN; }, "expected a quaternion of length 1, got one of nan");
  refused([](PointReading& one) { one.orientation.reset(); },
          "expected an orientation, as other readings of the series have one");
  refused([](PointReading& one) { one.second = one.point; }, "expected an orientation or a second point, got both");
  refused([](PointReading& one) { one.orientation_sigma = 0.0; }, "expected a sigma of the orientation above 0");
  EXPECT_THAT([&] { (void)calibrate(robot, good, {.method = Method::paper}); },
              ThrowsMessage<InvalidArgument>(
                  "method paper: expected points of the plate centre or distances, got poses of a body"));
  EXPECT_THAT(
      [&] { (void)planned(robot, good.stations, {.measurand = Measurand::poses, .rotation = true}); },
      ThrowsMessage<InvalidArgument>("plan: expected poses without rotation readings, since poses include them"));
}

/// What programs of motion capture disagree on, and a body that does not turn with what it was said to, are told.
TEST(BodyMistakes, AreTold) {
  const Robot robot = catalogue::huang2016();
  const auto told_of = [&](const std::function<void(PointReading&)>& mistake, ReflectorMount said) {
    RandomStream stream(11);
    const SourceErrors truth = draw_errors(robot, tolerances_of(robot), stream);
    const VirtualInstrument instrument = random_instrument(ReflectorMount::end_effector, stream);
    const PlannedReadings what{.measurand = Measurand::poses, .mount = ReflectorMount::end_effector};
    Measurements measured = simulate(robot, truth, planned(robot, fine_stations(robot, 8), what), instrument, stream);
    for (PointReading& reading : measured.series[0].readings) mistake(reading);
    const Calibration found = calibrate(robot, measured, {.reflectors = said});
    EXPECT_FALSE(found.accepted());
    return found.reasons.empty() ? std::string() : found.reasons.front();
  };
  const ReflectorMount turns = ReflectorMount::end_effector;
  EXPECT_THAT(told_of([](PointReading& one) { one.orientation = one.orientation->conjugate(); }, turns),
              HasSubstr("the quaternions are inverted: they rotate from the instrument's frame to the body's"));
  EXPECT_THAT(told_of(
                  [](PointReading& one) {
                    const Quaternion q = *one.orientation;
                    one.orientation = Quaternion(q.x(), q.y(), q.z(), q.w());
                  },
                  turns),
              HasSubstr("the quaternions have w last: the columns are qx, qy, qz, qw"));
  EXPECT_THAT(told_of(
                  [](PointReading& one) {
                    one.point.z() = -one.point.z();
                    one.orientation->x() *= -1.0;
                    one.orientation->y() *= -1.0;
                  },
                  turns),
              HasSubstr("the frame of the readings, orientations included, is left-handed"));
  EXPECT_THAT(told_of([](PointReading& one) { one.point.y() = -one.point.y(); }, turns),
              HasSubstr("x, y, z of the positions are x, -y, z of the orientations"));
  EXPECT_THAT(told_of([](PointReading&) {}, ReflectorMount::plate),
              HasSubstr("the body turns with phi (--reflectors end-effector)"));
}

/// Frame and body from nothing, a fifth of the poses gross.
TEST(PlaceBody, FromNothing) {
  RandomStream stream(12);
  const RigidMotion frame = random_frame(stream), body = random_body(stream);
  std::vector<RigidMotion> carriers, read;
  for (int k = 0; k < 40; ++k) {
    RigidMotion carrier = random_body(stream);
    carrier.translation *= 5.0;
    RigidMotion one{frame.rotation * carrier.rotation * body.rotation,
                    frame(carrier.translation + carrier.rotation * body.translation)};
    if (k % 5 == 2) one = random_frame(stream);
    carriers.push_back(carrier);
    read.push_back(one);
  }
  const detail::BodySetUp found = detail::place_body(carriers, read, true);
  EXPECT_LT((found.frame.translation - frame.translation).norm(), 0.1);
  EXPECT_LT((found.body.translation - body.translation).norm(), 0.1);
  EXPECT_LT((found.frame.rotation - frame.rotation).norm(), 1e-3);
  EXPECT_LT((found.body.rotation - body.rotation).norm(), 1e-3);
}

}  // namespace
}  // namespace paracal::body_poses_test
