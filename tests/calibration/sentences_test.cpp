// What a calibration says beside its numbers: each sentence in a world that demands it, and not in one beside it that
// does not.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::sentences_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kNoise = 0.017;  // mm

class Sentences : public testing::Test {
 protected:
  /// A machine of the fine stage's poses; sigmas stated if they are above 0.
  Measurements points(double sigma, int repeats = 1, int on_a_circle = 9) const {
    Measurements measured =
        measured_machine(robot, fine_stations(robot, on_a_circle), 3, {.noise = kNoise, .repeats = repeats})
            .measurements;
    if (sigma > 0.0) state_sigma(measured, sigma);
    return measured;
  }
  /// Home to so many points of a machine of which offsets alone are off.
  Measurements distances(int count) const {
    SourceErrors offsets;
    offsets(1, "theta_offset") = to_radians(0.3);
    const Measurements read = measure(robot, offsets, rough_stations(robot, count, 0.3), 1, {.noise = kNoise});
    Measurements measured{.stations = read.stations};
    for (const DistanceReading& one : all_distances(read.series[0])) {
      if (one.from == 0) measured.distances.push_back(one);
    }
    return measured;
  }

  Robot robot = catalogue::rotary_delta();
};

TEST_F(Sentences, AssumedScaleIsThatOfTheOptions) {
  const auto assumed = [&](double scale) { return calibrate(robot, points(kNoise), {.scale_std = scale}).assumed; };
  EXPECT_THAT(assumed(20e-6), Contains(HasSubstr("the scale of the readings is correct within 20 ppm")));
  EXPECT_THAT(assumed(0.0), Not(Contains(HasSubstr("scale"))));
}

/// A bowl of the bed, or the zero of a bar, would be taken for errors of the machine.
TEST_F(Sentences, WhatLengthsAreReadFromIsAssumed) {
  const auto assumed = [&](LengthKind kind, const CalibrationOptions& options) {
    const Measurements at = points(kNoise);
    Measurements plan{.stations = at.stations};
    plan.lengths = {{"read", kind, {}}};
    for (std::size_t k = 0; k < plan.stations.size(); ++k) plan.lengths[0].readings.push_back({.station = k});
    RandomStream random(1);
    return calibrate(robot, simulate(robot, {}, plan, {.noise = kNoise}, random), options).assumed;
  };
  const CalibrationOptions usual{.states_use = false, .diagnose = false};
  CalibrationOptions curved = usual, biased = usual;
  curved.plane_curvature = 1e-6;
  biased.noise.distance_bias = 0.2;
  EXPECT_THAT(assumed(LengthKind::height, usual), Contains(HasSubstr("the surface below the heights of read is flat")));
  EXPECT_THAT(assumed(LengthKind::height, curved), Not(Contains(HasSubstr("flat"))));
  EXPECT_THAT(assumed(LengthKind::ball_bar, usual), Contains(HasSubstr("lengths of read have no common error")));
  EXPECT_THAT(assumed(LengthKind::ball_bar, biased), Not(Contains(HasSubstr("common error"))));
}

TEST_F(Sentences, WhatIsKnownExactlyIsListed) {
  const Calibration fixed = calibrate(robot, points(0.0), {.states_use = false, .fixed = {{"e_x", 1}, {"alpha0", {}}}});
  EXPECT_THAT(fixed.assumed, Contains("known exactly: e_x of limb 2, alpha0 of all limbs"));
  const Calibration open = calibrate(robot, points(0.0), {.states_use = false});
  EXPECT_THAT(open.assumed, Not(Contains(HasSubstr("known exactly"))));
  EXPECT_THAT(open.assumed, Not(Contains(HasSubstr("fixed at nominal"))));
}

TEST_F(Sentences, NoiseThatIsStatedIsToldFromBacklashWithoutRepeats) {
  const auto assumed = [&](double sigma) { return calibrate(robot, points(sigma), {.states_use = false}).assumed; };
  EXPECT_THAT(assumed(0.0), Contains(HasSubstr("no pose was visited twice")));
  EXPECT_THAT(assumed(kNoise), Not(Contains(HasSubstr("no pose was visited twice"))));
}

TEST_F(Sentences, ReadingsThatLeaveNothingToTellTheirNoiseBy) {
  const auto assumed = [&](int count) {
    return calibrate(robot, distances(count), {.stage = Stage::rough, .states_use = false, .diagnose = false}).assumed;
  };
  EXPECT_THAT(assumed(3), Contains(HasSubstr("the noise is 0.05 mm: too few readings determine it")));
  EXPECT_THAT(assumed(5), Not(Contains(HasSubstr("too few readings determine it"))));
}

TEST_F(Sentences, EveryLimitRefusesByItsNumbers) {
  robot = catalogue::huang2016();
  const Measurements measured = points(kNoise);
  const Calibration open = calibrate(robot, measured);
  ASSERT_TRUE(open.accepted() && open.use && open.use->rotation);
  const auto refusal = [&](AcceptanceLimits limits) {
    const Calibration limited = calibrate(robot, measured, {.limits = limits});
    EXPECT_EQ(limited.accepted(), limited.reasons.empty());
    return limited.accepted() ? "" : limited.reasons.front();
  };
  const double aligned = open.use->aligned.U, rotation = open.use->rotation->U;
  EXPECT_EQ(refusal({.volumetric = 1.01 * aligned, .rotation = 1.01 * rotation}), "");
  EXPECT_THAT(refusal({.volumetric = 0.9 * aligned}),
              HasSubstr(fmt::format("U of aligned positions over the workspace is {:.3g} mm, above the limit of "
                                    "{:.3g} mm",
                                    aligned, 0.9 * aligned)));
  EXPECT_THAT(refusal({.rotation = 0.9 * rotation}),
              HasSubstr(fmt::format("U of rotations over the workspace is {:.3g} deg, above the limit of {:.3g} deg",
                                    to_degrees(rotation), to_degrees(0.9 * rotation))));
}

TEST_F(Sentences, ALimitOnRotationNeedsAPlateThatTurns) {
  const Calibration calibration = calibrate(robot, points(kNoise), {.limits = {.rotation = 1.0}});
  EXPECT_EQ(calibration.verdict, Verdict::rejected);
  EXPECT_THAT(calibration.reasons,
              ElementsAre(HasSubstr("the limit on rotation does not apply to a plate that does not turn")));
}

/// Readings that scatter three times as much as they say: a note, or where nothing is worth one, what was assumed.
TEST_F(Sentences, AComponentIsANoteOrAnAssumption) {
  const Measurements measured = points(kNoise / 3.0, 2, 4);
  const auto said = [&](double largest_doubt) {
    return calibrate(robot, measured, {.stage = Stage::fine, .largest_doubt = largest_doubt, .states_use = false});
  };
  const Calibration told = said(0.05), untold = said(0.0);
  EXPECT_THAT(told.notes, Contains(HasSubstr("times as much as their stated sigmas (probability ")));
  EXPECT_THAT(told.assumed, Not(Contains(HasSubstr("stated sigmas"))));
  EXPECT_THAT(untold.notes, Not(Contains(HasSubstr("stated sigmas"))));
  EXPECT_THAT(untold.assumed,
              Contains(testing::ContainsRegex("^possibly, .* times as much as their stated sigmas \\(probability ")));
}

/// Stated three times too large, or right, or three times too small.
TEST_F(Sentences, NoiseBelowWhatWasStatedIsTold) {
  const auto notes = [&](double factor) {
    return calibrate(robot, points(factor * kNoise), {.states_use = false}).notes;
  };
  EXPECT_THAT(notes(3.0), Contains(HasSubstr("the readings scatter only 0.3")));
  EXPECT_THAT(notes(1.0), Not(Contains(HasSubstr("the readings scatter only"))));
  EXPECT_THAT(notes(1.0 / 3.0), Not(Contains(HasSubstr("the readings scatter only"))));
}

TEST_F(Sentences, TheFineStageIsPromisedWhereItWouldKnowMore) {
  const auto promise = testing::Contains(HasSubstr("only the encoder offsets were estimated"));
  const Calibration rough = calibrate(robot, points(0.0), {.stage = Stage::rough});
  ASSERT_TRUE(rough.use);
  EXPECT_THAT(rough.notes, promise);
  EXPECT_THAT(rough.notes,
              Contains(HasSubstr(fmt::format("U of distances is {:.2g} mm. The fine", rough.use->distance.U))));
  EXPECT_THAT(calibrate(robot, points(0.0), {.stage = Stage::fine}).notes, Not(promise));
  // Nothing but offsets is off, and the readings repeat far better than the noise that is expected of them.
  CalibrationOptions options{.stage = Stage::rough, .scale_std = 0.0};
  for (const Source source : all_sources()) {
    if (source != "theta_offset") options.fixed.push_back({source, {}});
  }
  SourceErrors offsets;
  offsets(1, "theta_offset") = to_radians(0.3);
  const Calibration alone =
      calibrate(robot, measure(robot, offsets, fine_stations(robot, 9), 1, {.noise = 1e-4}), options);
  EXPECT_TRUE(alone.use);
  EXPECT_THAT(alone.notes, Not(promise));
}

/// The rods are too short for the workspace's rim, and nothing else is: measured near its middle.
TEST_F(Sentences, AMachineThatDoesNotReachItsWorkspaceHasNoUse) {
  RobotDescription description = robot.description();
  description.workspace.radius *= 0.3;
  const Robot small(description);
  SourceErrors errors;
  Tolerances tolerances = *robot.tolerances();
  tolerances["rod_mean"] = 1000.0;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) errors(limb, "rod_mean") = -408.0;
  const Measurements measured = measure(small, errors, fine_stations(small, 9), 1, {.noise = kNoise});
  const Calibration calibration = calibrate(robot, measured, {.tolerances = tolerances, .diagnose = false});
  EXPECT_FALSE(calibration.use) << calibration.brief();
  EXPECT_THAT(calibration.notes, Contains(HasSubstr("the calibrated machine cannot reach its whole workspace")));
}

TEST_F(Sentences, AMachineThatDoesNotCloseIsToldFromAFitThatDidNotSettle) {
  robot = catalogue::linear_delta();
  Measurements measured = points(0.0);
  measured.stations[2].believed = Eigen::Vector3d(0.0, 0.0, 10.0 * sizes_of(robot.limbs()).rod);
  const Calibration calibration = calibrate(robot, measured, {.stage = Stage::fine, .diagnose = false});
  EXPECT_EQ(calibration.verdict, Verdict::not_converged);
  EXPECT_THAT(calibration.reasons, ElementsAre(HasSubstr("cannot reach every station, or a reading is impossible")));
}

TEST_F(Sentences, ThoseOfTheVerdict) {
  CalibrationOptions options{.stage = Stage::rough, .states_use = false, .diagnose = false};
  const Calibration few = calibrate(robot, distances(2), options);
  EXPECT_EQ(few.verdict, Verdict::not_identifiable);
  EXPECT_THAT(few.reasons, ElementsAre("the readings determine 2 of 3 parameters: measure more poses"));
  const Calibration enough = calibrate(robot, distances(6), options);
  EXPECT_TRUE(enough.accepted());
  options.largest_chance = 0.5 * *enough.chance;
  const Calibration chance = calibrate(robot, distances(6), options);
  EXPECT_EQ(chance.verdict, Verdict::rejected);
  EXPECT_THAT(chance.reasons, ElementsAre(HasSubstr("the improvement is not significant")));
  options.largest_chance = 1.1 * *enough.chance;
  EXPECT_TRUE(calibrate(robot, distances(6), options).accepted());
}

}  // namespace
}  // namespace paracal::test::sentences_test
