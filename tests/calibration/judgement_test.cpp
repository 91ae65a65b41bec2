// What a calibration says of itself, on machines whose truth the model does not hold. Every limit was written down
// before its outcome was known: it is that of 200 machines in docs/judgement.md, less what so few machines can be off
// by.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"
#include "support/worlds.hpp"

namespace paracal::test::judgement_test {
namespace {

using testing::HasSubstr;

const Bench& bench(const std::string& name) {
  constexpr int kCandidates = 200;
  if (name == "huang2016") {
    static const Bench kHuang = bench_of(catalogue::huang2016(), kCandidates);
    return kHuang;
  }
  if (name == "linear_delta") {
    static const Bench kRails = bench_of(catalogue::linear_delta(), kCandidates);
    return kRails;
  }
  static const Bench kDelta = bench_of(catalogue::rotary_delta(), kCandidates);
  return kDelta;
}

World world_named(const std::string& name) {
  for (const World& one : wrong_worlds()) {
    if (one.name == name) return one;
  }
  throw std::logic_error("no world " + name);
}

int notes_with(const Judgement& all, const std::string& text) {
  return static_cast<int>(
      std::ranges::count_if(all.notes, [&](const std::string& note) { return note.find(text) != std::string::npos; }));
}

class Judged : public testing::TestWithParam<std::string> {
 protected:
  /// Of 6 machines, in which a note or an interval that is lost is lost in all, limits are wider by what they scatter.
  Judgement in(const std::string& world, Machines wanted = {.claim = 30, .quick = 6}, bool with_oracle = false) const {
    return judge_world(bench(GetParam()), world_named(world), 500, machines(wanted), with_oracle);
  }
  /// A row of the table of faults in docs/judgement.md.
  static void record_fault(const std::string& world, const Judgement& all) {
    std::string key = world;
    std::ranges::replace_if(
        key, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    RecordProperty(key, fmt::format("accepted {}, named {}, or listed {}, something else named {}, median U {:.3f} mm",
                                    all.accepted, all.named, all.listed, all.blamed, quantile(all.largest_U, 0.5)));
  }
  /// By how much a share of machines may fall short by chance: errors of one machine go together.
  static double lack(const Judgement& all, double share) {
    return 3.0 * std::sqrt(share * (1.0 - share) / std::max(all.accepted, 1));
  }
  /// A tenth, and two standard deviations.
  static double exceeded_at_most(const Judgement& all) {
    const double expected = 0.1 * all.accepted;
    return std::max(1.0, expected + 2.0 * std::sqrt(0.9 * expected));
  }
  /// Errors of one machine go together: as many independent ones as there are machines.
  static void holds(const Judgement& all, double share) {
    const double spread = 3.0 * std::sqrt(share * (1.0 - share) / std::max(all.accepted, 1));
    EXPECT_GE(all.distance_coverage(), share - spread);
    EXPECT_GE(all.error_coverage(), share - spread);
    for (const int exceeded : all.use_exceeded)
      EXPECT_LE(exceeded, std::max(1.0, all.accepted * (1.0 - share + spread)));
  }
};

TEST_P(Judged, CleanMachinesAreAcceptedWithoutANoteAndWithNoMoreUncertaintyThanTheyHave) {
  const Judgement all = in("clean", {.claim = 100, .quick = 12}, true);
  EXPECT_EQ(all.accepted, all.machines);
  EXPECT_LE(all.noted, std::max(1, all.machines / 50));
  // What it costs that joints may do what nobody knows: of linear_delta, a quarter as large as the others, more.
  const bool small = GetParam() == "linear_delta";
  EXPECT_LE(quantile(all.U_over_oracle, 0.5), small ? 1.5 : 1.25);
  EXPECT_LE(quantile(all.use_over_oracle, 0.5), small ? 1.8 : 1.35);
  holds(all, 0.95);
}

/// One joint stops elsewhere at each visit: a single visit is worth as much less, and the note says why.
TEST_P(Judged, AJointThatDoesNotRepeatWidensASingleVisit) {
  for (const char* world : {"loose 0.02 deg", "loose 0.02 deg, noise known"}) {
    SCOPED_TRACE(world);
    const Judgement all = in(world, {.claim = 60, .quick = 4});
    EXPECT_GE(notes_with(all, "does not repeat"), 0.95 * all.machines);
    EXPECT_LE(all.visit_exceeded[0], exceeded_at_most(all));
    EXPECT_GE(1.0 * all.visits_held, (0.95 - lack(all, 0.95)) * all.distances);
    EXPECT_GE(all.distance_coverage(), 0.9 - lack(all, 0.9));
  }
}

/// Each pose visited once and no noise stated: noise and a loose joint look alike, and a single visit is worth what it
/// is with the worse of them. Of clean machines none has a note of joints.
TEST_P(Judged, WithoutASecondVisitASingleVisitIsWorthWhatALooseJointLeaves) {
  const Judgement loose = in("one visit, loose 0.02 deg", {.claim = 60, .quick = 6});
  for (const int exceeded : loose.visit_exceeded) EXPECT_LE(exceeded, exceeded_at_most(loose));
  EXPECT_GE(1.0 * loose.visits_held, (0.95 - lack(loose, 0.95)) * loose.distances);
  const Judgement clean = in("one visit", {.claim = 100, .quick = 6});
  EXPECT_EQ(clean.accepted, clean.machines);
  EXPECT_EQ(notes_with(clean, "the poses differ from the model by"), 0);
}

/// Whether a note says so or not: U holds, of the mean place and of a single visit. Single errors may not: nothing
/// tells uneven drives from them, as `assumed` says.
TEST_P(Judged, WhatTheGeometryDoesNotDoWidensU) {
  for (const std::string world : {"drives uneven 0.0015 deg", "compliance 0.05 mm", "drift 0.05 mm", "17-bit encoders",
                                  "guides 0.03 mm aside", "axes wobble 0.01 deg"}) {
    SCOPED_TRACE(world);
    // Of carriages, what leans a rod's end at both sides moves it by far more.
    if (world.starts_with("axes") && GetParam() == "linear_delta") continue;
    const Judgement all = in(world, {.claim = 60, .quick = 6});
    EXPECT_GE(all.distance_coverage(), 0.9 - lack(all, 0.9));
    EXPECT_GE(1.0 * all.visits_held, (0.9 - lack(all, 0.9)) * all.distances);
    for (const int exceeded : all.use_exceeded) EXPECT_LE(exceeded, exceeded_at_most(all));
    for (const int exceeded : all.visit_exceeded) EXPECT_LE(exceeded, exceeded_at_most(all));
  }
}

TEST_P(Judged, APoseThatWasAnotherIsNamedAndCostsNothing) {
  const Judgement all = in("one pose off 0.5 mm", {.claim = 60, .quick = 4}, true);
  EXPECT_GE(notes_with(all, "all readings of pose"), 0.95 * all.machines);
  EXPECT_LE(quantile(all.U_over_oracle, 0.5), GetParam() == "linear_delta" ? 1.6 : 1.35);
  holds(all, 0.95);
}

TEST_P(Judged, ThinReadingsCountWhatTheyDoNotSeek) {
  for (const char* world : {"six distances", "seven points", "13 heights", "13 heights, 3 distances"}) {
    SCOPED_TRACE(world);
    holds(in(world), 0.95);
  }
}

/// Each such fit takes half a second: of 2 machines, as of 20, all must say so.
TEST_P(Judged, BacklashIsToldFromNoiseByVisitsThatRepeat) {
  for (const char* world : {"backlash 0.02 deg", "backlash 0.02 deg, noise known"}) {
    SCOPED_TRACE(world);
    const Judgement all = in(world, {.claim = 20, .quick = 2});
    holds(all, 0.95);
    EXPECT_GE(notes_with(all, "the poses differ from the model by"), 0.9 * all.machines);
    EXPECT_GE(notes_with(all, "(repeatability 0.01"), 0.9 * all.machines) << all.notes.front();
  }
}

TEST_P(Judged, PartsWorseThanTheirTolerancesWidenThem) {
  const Machines wanted{.claim = 30, .quick = 4};  // three worlds of slow fits
  const Judgement all = in("all errors x 3", wanted), position = in("position errors x 3", wanted),
                  tilt = in("tilt errors x 3", wanted);
  for (const Judgement* one : {&all, &position, &tilt}) holds(*one, 0.93);
  EXPECT_GE(notes_with(all, "times as large as the tolerances"), 0.95 * all.machines);
  EXPECT_GE(notes_with(position, "times as large as the tolerances"), 0.95 * position.machines);
  // The bars of linear_delta are so short that points hardly show what tilts its plate.
  if (GetParam() == "linear_delta") return;
  EXPECT_GE(notes_with(tilt, "times as large as the tolerances"), std::floor(0.1 * tilt.machines));  // of 4 none
}

/// As one part where the readings tell which; else as parts of a kind or a group.
TEST_P(Judged, AWrongPartIsToldAndItsIntervalsHold) {
  const Judgement all = in("one wrong part");
  record_fault("one wrong part", all);
  holds(all, 0.95);
  EXPECT_EQ(all.noted, all.accepted);
  EXPECT_GE(notes_with(all, "check the part and the tolerance"), 0.3 * all.machines);
}

/// Poses, an instrument, a reflector: not the joints, and U stays what it is without the fault.
TEST_P(Judged, FaultsOfTheReadingsAreNamedAndCostNoUncertainty) {
  for (const char* name : {"two poses off 0.5 mm", "three poses off 0.5 mm", "reflector 0.5 mm off",
                           "ball bar at 5 times its noise", "tracker at 5 times its noise"}) {
    SCOPED_TRACE(name);
    const World world = world_named(name);
    World sound = world;
    sound.wrong_pose = sound.reflector_off = 0.0;
    sound.last_series_factor = 1.0;
    const int count = machines({.claim = 24, .quick = 3});
    const Judgement all = judge_world(bench(GetParam()), world, 0, count),
                    other = judge_world(bench(GetParam()), sound, 0, count);
    record_fault(name, all);
    ASSERT_GE(all.accepted, 0.9 * count);
    EXPECT_GE(all.named, 0.9 * count);
    EXPECT_LE(all.blamed, std::max(0, count / 24));
    EXPECT_LE(quantile(all.largest_U, 0.5), 1.5 * quantile(other.largest_U, 0.5));
  }
}

/// A rod that warms against its twin, joints that stop by the direction of their motion: not play, not friction. The
/// machine that is warm at the end, and the mean of both directions, are within U.
TEST_P(Judged, WhatGoesWithTheOrderOfTheReadingsIsNamed) {
  for (const char* name : {"one rod warms by 0.1 mm", "backlash 0.005 deg by direction"}) {
    SCOPED_TRACE(name);
    const Judgement all = in(name, {.claim = 24, .quick = 6}, true);
    record_fault(name, all);
    EXPECT_EQ(all.accepted, all.machines);
    EXPECT_GE(all.named, 0.9 * all.machines);
    EXPECT_LE(all.blamed, all.machines / 12);
    EXPECT_GE(all.distance_coverage(), 0.9 - lack(all, 0.9));
    for (const int exceeded : all.use_exceeded) EXPECT_LE(exceeded, exceeded_at_most(all));
    for (const int exceeded : all.visit_exceeded) EXPECT_LE(exceeded, exceeded_at_most(all));
    // Of the mean of both directions; a rod that is 0.1 mm longer at the end is in U.
    const bool drifts = std::string(name).find("warms") != std::string::npos;
    EXPECT_LE(quantile(all.U_over_oracle, 0.5), drifts ? 6.0 : 2.0);
  }
}

/// One visit of ten: not a joint that scatters at each visit, whose standard deviation is a third of what it then
/// stands off. One machine in ten sticks fewer than three times.
TEST_P(Judged, AJointThatSticksNowAndThenIsNamedAndAnyVisitIsWithinU) {
  for (const char* name : {"sticks 0.02 deg at one visit of ten", "sticks 0.1 deg at one visit of ten"}) {
    SCOPED_TRACE(name);
    const Judgement all = in(name, {.claim = 24, .quick = 6});
    record_fault(name, all);
    EXPECT_EQ(all.accepted, all.machines);
    EXPECT_GE(notes_with(all, " sticks: "), 0.8 * all.machines - 1.0);
    for (const int exceeded : all.visit_exceeded) EXPECT_LE(exceeded, exceeded_at_most(all));
  }
  const Judgement loose = in("loose 0.02 deg", {.claim = 24, .quick = 6});
  EXPECT_EQ(notes_with(loose, " sticks: "), 0);
}

/// Where readings tell which parts: e_y of two limbs of huang2016 whose rods are parallel may each be the other's. Then
/// both are listed.
TEST_P(Judged, TwoWrongPartsAreNamedOrListed) {
  const Judgement all =
      judge_world(bench(GetParam()), world_named("two wrong parts"), 0, machines({.claim = 24, .quick = 4}));
  record_fault("two wrong parts", all);
  EXPECT_EQ(all.accepted, all.machines);
  EXPECT_GE(all.listed, 0.9 * all.machines);
  EXPECT_GE(all.named, 0.6 * all.machines);
  EXPECT_LE(all.blamed, std::max(0, all.machines / 12));
  holds(all, 0.95);
}

TEST_P(Judged, StatedNoiseThatIsWrongIsToldInBothDirections) {
  const Judgement large = in("noise 3 times the stated"), small = in("noise a third of the stated");
  holds(large, 0.93);
  holds(small, 0.95);
  EXPECT_GE(notes_with(large, "times as much as their stated sigmas"), 0.95 * large.machines);
  EXPECT_GE(notes_with(small, "the readings scatter only 0.3"), 0.95 * small.machines);
}

TEST_P(Judged, WhatImitatesGeometryLeavesPredictionsRight) {
  for (const char* world : {"encoder 0.01 deg a turn", "arms warm up 1e-4", "sag 0.05 mm", "scale 20 ppm"}) {
    SCOPED_TRACE(world);
    // Carriages that warm up half way: the readings tell the mean of cold and warm, and U holds three quarters.
    if (GetParam() == "linear_delta" && std::string(world) == "arms warm up 1e-4") continue;
    const Judgement all = in(world);
    EXPECT_GE(all.distance_coverage(), 0.93 - 3.0 * std::sqrt(0.93 * 0.07 / all.accepted));
  }
}

TEST_P(Judged, NoiseThatIsNotNormalIsCovered) {
  for (const char* world : {"Student t3", "10 % at 5 sigma"}) {
    SCOPED_TRACE(world);
    holds(in(world, {.claim = 20, .quick = 6}), 0.93);
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, Judged, testing::Values("huang2016", "rotary_delta", "linear_delta"),
                         [](const auto& world) { return world.param; });

/// Few heights of a hexapod: offsets alone would stand out by chance, and be accepted where they do, in one of ten.
TEST(JudgedHexapods, OfFewHeightsAreKnownAsWellAsIsSaid) {
  const Bench hexapods = bench_of(robot_named("hexapod"), 200);
  for (const char* world : {"13 heights", "13 heights, 3 distances"}) {
    SCOPED_TRACE(world);
    const Judgement all = judge_world(hexapods, world_named(world), 500, machines({.claim = 80, .quick = 20}));
    EXPECT_GE(all.distance_coverage(), 0.93 - 3.0 * std::sqrt(0.93 * 0.07 / std::max(all.accepted, 1)));
    EXPECT_LE(all.use_exceeded[0], std::max(1.0, 0.05 * all.accepted + 3.0 * std::sqrt(0.05 * all.accepted)));
    for (const double U : all.largest_U) EXPECT_LT(U, 1.5);  // mm; of offsets alone 3 and more
  }
}

/// The published machine's six distances.
Measurements published_like(const Robot& robot, const SourceErrors& errors) {
  Measurements measured{.stations = {{"P0", {robot.workspace().centre(), 0.0}}}};
  for (int k = 0; k < 6; ++k) {
    const double angle = to_radians(270.0 + 60.0 * k);
    measured.stations.push_back(
        {"P" + std::to_string(k + 1),
         {robot.workspace().centre() + 500.0 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0), 0.0}});
  }
  const KnownErrors known{errors, {}, {}};
  const auto at = [&](std::size_t k) {
    return predict(robot, known, believed_joints(robot, measured.stations[k])).pose.position;
  };
  for (std::size_t k = 1; k < 7; ++k)
    measured.distances.push_back({.from = 0, .to = k, .distance = (at(k) - at(0)).norm()});
  return measured;
}

TEST(Considered, ErrorsHeldAtNominalWidenOffsetsByWhatTheirTolerancesDo) {
  const Robot robot = catalogue::huang2016();
  const Measurements readings = published_like(robot, table4_machine(robot, 1));
  CalibrationOptions options{.stage = Stage::rough};
  const Calibration wide = calibrate(robot, readings, options);
  ASSERT_EQ(wide.parameters.size(), 56);
  EXPECT_EQ(std::ranges::count(wide.parameters, false, &ParameterEstimate::held), 4);
  // A linear program of its own: 0.415 deg under the catalogue's tolerances.
  EXPECT_NEAR(to_degrees(*wide.parameters.front().std), 0.415, 0.05);
  EXPECT_NEAR(wide.parameters.front().coverage(), 2.0, 0.1);
  EXPECT_THAT(wide.assumed, testing::Contains(HasSubstr("52 other errors are fixed at nominal")));

  for (const Source source : all_sources()) {
    if (source != "theta_offset") options.fixed.push_back({source, {}});
  }
  options.scale_std = 0.0;
  const Calibration exact = calibrate(robot, readings, options);
  ASSERT_EQ(exact.parameters.size(), 4);
  EXPECT_THAT(exact.assumed, testing::Contains(HasSubstr("known exactly: e_x of all limbs")));
  EXPECT_NEAR(exact.parameters.front().coverage(), coverage_factor(2.0), 1e-9);  // 6 distances less 4 offsets
}

TEST(Considered, CovarianceIsThatOfMachinesDrawnFromTheTolerances) {
  const Robot robot = catalogue::huang2016();
  const int count = machines({.claim = 300, .quick = 40});
  std::vector<double> ratios;
  for (int k = 0; k < count; ++k) {
    RandomStream random(77, static_cast<std::uint64_t>(k));
    const SourceErrors truth = draw_errors(robot, *robot.tolerances(), random);
    const Calibration rough =
        calibrate(robot, published_like(robot, truth), {.stage = Stage::rough, .states_use = false});
    const ParameterEstimate& one = rough.parameters.front();
    if (one.std) ratios.push_back((one.value - truth(0, "theta_offset")) / *one.std);
  }
  double squares = 0.0;
  for (const double ratio : ratios) squares += ratio * ratio;
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(ratios.size())), 1.0, 4.0 / std::sqrt(2.0 * count) + 0.05);
}

/// Heights show no more of what all offsets of carriages have in common than the height of the bed that nobody knows:
/// that stays at zero, and as uncertain as the tolerances of the three, e_z included, make it.
TEST(Considered, WhatNoReadingTellsFromTheSetUpKeepsItsTolerance) {
  const Robot robot = catalogue::linear_delta();
  const Tolerances tolerances = *robot.tolerances();
  const double wanted = std::hypot(tolerances.std("theta_offset"), tolerances.std("e_z")) / std::sqrt(3.0);
  Measurements heights{.stations = bench("linear_delta").selected, .lengths = {{"bed", LengthKind::height, {}}}};
  for (std::size_t k = 0; k < heights.stations.size(); ++k) heights.lengths[0].readings.push_back({.station = k});
  RandomStream random(5, 1);
  const SourceErrors truth = draw_errors(robot, tolerances, random);
  const Measurements read = simulate(robot, truth, heights, {.noise = 0.017}, random);
  const Calibration rough = calibrate(robot, read, {.stage = Stage::rough, .states_use = false});
  const Eigen::Vector3d common = Eigen::Vector3d::Constant(1.0 / 3.0);
  ASSERT_EQ(rough.rank, 2);
  EXPECT_NEAR(std::sqrt(common.dot(rough.covariance.topLeftCorner<3, 3>() * common)), wanted, 0.03 * wanted);
  double found = 0.0;
  for (std::size_t k = 0; k < 3; ++k) found += rough.parameters[k].value / 3.0;
  EXPECT_NEAR(found, 0.0, 0.2 * wanted);
}

/// What only a tolerance tells owes nothing to the noise, what the readings tell owes them much.
TEST(Uncertainty, NoiseHasItsPartOfTheCovariance) {
  const Robot robot = catalogue::huang2016();
  const MeasuredMachine machine =
      measured_machine(robot, bench("huang2016").selected, 3, {.noise = 0.017, .repeats = 3});
  const Calibration calibration = calibrate(robot, machine.measurements);
  int untold = 0;
  double largest = 0.0;
  for (std::size_t k = 0; k < calibration.parameters.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const double share = calibration.noise_covariance(at, at) / calibration.covariance(at, at);
    largest = std::max(largest, share);
    if (calibration.parameters[k].data_share > 0.05) continue;
    EXPECT_LT(share, 0.1) << k;
    ++untold;
  }
  EXPECT_GT(untold, 0);
  EXPECT_GT(largest, 0.5);
  EXPECT_LE(largest, 1.0 + 1e-9);
}

TEST(CoverageFactor, IsStudentsAndTwoInTheLimit) {
  EXPECT_NEAR(coverage_factor(1.0), 13.97, 0.01);  // [gum, Table G.2], 95.45 %
  EXPECT_NEAR(coverage_factor(2.0), 4.53, 0.01);
  EXPECT_NEAR(coverage_factor(10.0), 2.28, 0.01);
  EXPECT_NEAR(coverage_factor(1e9), 2.0, 1e-12);
  EXPECT_TRUE(std::isfinite(coverage_factor(1e-300)));  // of a fit that diverged
  EXPECT_NEAR(coverage_factor(std::numeric_limits<double>::infinity()), 2.0, 1e-12);
}

TEST(Use, IsExceededByATwentiethOfTheMachines) {
  const Bench& huang = bench("huang2016");
  const Judgement all = judge_world(huang, world_named("noise known"), 900, machines({.claim = 60, .quick = 20}));
  EXPECT_LE(all.use_exceeded[0], 1 + all.accepted / 10);
}

/// A fit of offsets alone uses no tolerances, and heights leave its rotations wider open than these, always. Where they
/// tell distances better than the tolerances do, the calibration is accepted all the same. Where they do not, the fine
/// fit is, if the offsets are significant.
TEST(Use, HeightsMayLeaveRotationsOpen) {
  const Judgement all = judge_world(bench("huang2016"), world_named("13 heights"), 500, 20);
  EXPECT_GE(all.accepted, 13);
  EXPECT_LE(all.use_exceeded[0], 2);
}

TEST(Use, DecidesAgainstLimits) {
  const Robot robot = catalogue::huang2016();
  const MeasuredMachine machine =
      measured_machine(robot, bench("huang2016").selected, 3, {.noise = 0.017, .repeats = 3});
  const Calibration open = calibrate(robot, machine.measurements);
  ASSERT_TRUE(open.accepted());
  ASSERT_TRUE(open.use);
  const auto with_limit = [&](double share) {
    return calibrate(robot, machine.measurements, {.limits = {.distance = share * open.use->distance.U}});
  };
  EXPECT_TRUE(with_limit(1.01).accepted());
  const Calibration refused = with_limit(0.99);
  EXPECT_EQ(refused.verdict, Verdict::rejected);
  EXPECT_THAT(refused.reasons.front(), HasSubstr("U of distances over the workspace"));
  EXPECT_THAT(refused.brief(), HasSubstr("not met"));
}

TEST(Use, DoesNotHangOnRounding) {
  const Robot robot = catalogue::huang2016();
  KnownErrors known;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
      if (robot.tolerances() && (*robot.tolerances())[source] > 0.0) known.parameters.push_back({limb, source});
    }
  }
  const auto n = static_cast<Eigen::Index>(known.parameters.size());
  known.covariance = 1e-8 * Eigen::MatrixXd::Identity(n, n);  // eigenvectors are whatever rounding makes of them
  const double U = use_over_workspace(robot, known).any.distance.U;
  known.covariance(0, 1) = known.covariance(1, 0) = 1e-21;
  known.covariance(n - 1, 2) = known.covariance(2, n - 1) = -3e-21;
  EXPECT_NEAR(use_over_workspace(robot, known).any.distance.U, U, 1e-6 * U);
}

TEST(Use, IsNotStatedOfAFitThatDidNotSettle) {
  const Robot robot = catalogue::huang2016();
  const MeasuredMachine machine =
      measured_machine(robot, bench("huang2016").selected, 3, {.noise = 0.017, .repeats = 3});
  Measurements nonsense = machine.measurements;
  Random random(1);
  for (PointReading& reading : nonsense.series.front().readings) {
    reading.point = Eigen::Vector3d(random.normal(2e3), random.normal(2e3), random.normal(2e3));
  }
  const Calibration calibration = calibrate(robot, nonsense, {.limits = {.distance = 1e9}, .diagnose = false});
  ASSERT_EQ(calibration.verdict, Verdict::not_converged) << calibration.brief();
  EXPECT_FALSE(calibration.use);
  EXPECT_THAT(calibration.brief(), testing::Not(HasSubstr("uncertainty over the workspace")));
}

/// Rejected, they still say how far off they are.
TEST(Use, IsStatedOfReadingsThatAreNotWhatTheyWereTakenFor) {
  const Robot robot = catalogue::huang2016();
  MeasuredMachine machine = measured_machine(robot, bench("huang2016").selected, 3, {.noise = 0.017, .repeats = 1});
  for (PointReading& reading : machine.measurements.series.front().readings) reading.point /= 25.4;
  const Calibration calibration = calibrate(robot, machine.measurements);
  ASSERT_FALSE(calibration.accepted());
  EXPECT_THAT(calibration.reasons.front(), HasSubstr("inches"));
  EXPECT_EQ(calibration.use.has_value(), calibration.verdict == Verdict::rejected);
}

TEST(Assumptions, SayThatNobodyCanTellBacklashWithoutRepeats) {
  const Robot robot = catalogue::huang2016();
  const auto assumed = [&](int repeats) {
    const MeasuredMachine machine =
        measured_machine(robot, bench("huang2016").selected, 3, {.noise = 0.017, .repeats = repeats});
    return calibrate(robot, machine.measurements).assumed;
  };
  EXPECT_THAT(assumed(1), testing::Contains(HasSubstr("no pose was visited twice")));
  EXPECT_THAT(assumed(2), testing::Not(testing::Contains(HasSubstr("no pose was visited twice"))));
}

TEST(Temperature, ReducesLengthsToTwentyDegrees) {
  const Robot robot = catalogue::huang2016();
  const MeasuredMachine cold = measured_machine(robot, bench("huang2016").selected, 4, {.noise = 1e-4, .repeats = 1});
  Measurements warm = cold.measurements;
  for (PointReading& reading : warm.series.front().readings) reading.point *= 1.0 + 2e-4;
  const Calibration expected = calibrate(robot, cold.measurements),
                    found = calibrate(robot, at_reference_temperature(warm, 2e-4));
  for (std::size_t k = 0; k < expected.parameters.size(); ++k) {
    EXPECT_NEAR(found.parameters[k].value, expected.parameters[k].value, 1e-6);
  }
}

}  // namespace
}  // namespace paracal::test::judgement_test
