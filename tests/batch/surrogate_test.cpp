// Batches made to first order: against machines that were built, measured and calibrated, and what their intervals
// hold.

#include "batch/surrogate.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "jobs/batch_job.hpp"
#include "paracal/batch/batch.hpp"
#include "paracal/batch/error_spread.hpp"
#include "paracal/error.hpp"
#include "paracal/io/tally_json.hpp"
#include "paracal/mechanism/random.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::surrogate_test {
namespace {

const std::atomic<bool> kNeverStop = false;

class SurrogateLaw : public test::EveryRobot {
 protected:
  Batch batch(std::uint64_t seed = 1) const {
    ProductionPlan plan = paper_production(robot, tolerances_of(robot));
    plan.calibration.noise.point = plan.calibration.noise.body = plan.instrument.noise;
    return {.robot = robot, .plan = settled(robot, std::move(plan)), .seed = seed};
  }
};
PARACAL_ON_EVERY_ROBOT(SurrogateLaw);
PARACAL_ON_ROBOT_TEMPLATES(SurrogateLaw);

/// With small errors, small noise that is known and no reading left out, both ways make the same machine.
TEST_P(SurrogateLaw, IsTheLimitOfSmallErrors) {
  constexpr double kSmall = 0.03;  // smaller, and solvers stop before the noise does
  ProductionPlan plan = paper_production(robot, tolerances_of(robot));
  for (double& half_width : plan.tolerances.half_width) half_width *= kSmall;
  plan.instrument.noise *= kSmall;
  plan.instrument.rotation_noise *= kSmall;
  if (!robot.is_level()) plan.instrument.rotation_noise = 1e-5;
  plan.calibration.tolerances = plan.tolerances;
  plan.calibration.noise.point = plan.calibration.noise.body = plan.instrument.noise;
  if (plan.instrument.rotation_noise > 0.0) plan.calibration.noise.rotation = plan.instrument.rotation_noise;
  plan.calibration.noise_is_known = true;
  plan.calibration.exclude_outliers = false;
  plan.calibration.seeks_discrepancies = false;
  plan = settled(robot, std::move(plan));
  const Surrogate surrogate(robot, plan);
  const std::vector<Surrogate::Values> values = surrogate.machines(5, 0, 6);
  for (std::uint64_t m = 0; m < values.size(); ++m) {
    const MachineOutcome made = produce(robot, plan, 5, m);
    ASSERT_EQ(made.fate, Fate::accepted);
    for (const ErrorKind kind : kErrorKinds) {
      if (kind == ErrorKind::rotation && !turns(robot)) continue;
      if (kind == ErrorKind::tilt && made.before[kind] == 0.0) {  // guides keep it from that
        EXPECT_EQ(values[m].before[kind] + values[m].after[kind], 0.0);
        continue;
      }
      EXPECT_NEAR(values[m].before[kind] / made.before[kind], 1.0, 3e-3) << name(kind) << " before";
      EXPECT_NEAR(values[m].after[kind] / made.after[kind], 1.0, 0.02) << name(kind) << " after";
    }
  }
}

TEST_P(SurrogateLaw, AMachineDoesNotDependOnOthers) {
  const Batch one = batch();
  const Surrogate surrogate(robot, one.plan);
  const std::vector<Surrogate::Values> together = surrogate.machines(1, 100, 70), alone = surrogate.machines(1, 165, 1);
  for (const ErrorKind kind : kErrorKinds) {
    EXPECT_NEAR(together[65].before[kind], alone[0].before[kind], 1e-12 * together[65].before[kind]);
    EXPECT_NEAR(together[65].after[kind], alone[0].after[kind], 1e-10 * together[65].before[kind]);
  }
}

class SurrogateBatch : public SurrogateLaw {};
PARACAL_ON_EVERY_ROBOT(SurrogateBatch);

/// Most machines computed to first order, or all by produce() and with other random numbers: the same spread, within
/// what both say of themselves. 1000 machines know quantiles three times as well as 100; a spread of linear values
/// alone, or one whose weights are wrong, is outside for either.
TEST_P(SurrogateBatch, SpreadsAsMachinesThatWereMade) {
  const auto few = static_cast<std::uint64_t>(test::machines({.claim = 1000, .quick = 128}));
  const Tally made = exactly(batch(2), {0, few}, 0, kNeverStop).value();
  Batch other_seed = with_surrogate(batch(3));
  Tally both = to_first_order(other_seed, {0, 20 * few}, 0, kNeverStop).value();
  both.add(exactly(other_seed, {0, few}, 0, kNeverStop).value());
  ASSERT_EQ(both.produced(), few);
  ASSERT_EQ(both.machines(), 20 * few);
  int inside = 0, all = 0;
  double width_of_made = 0.0, width_of_both = 0.0;  // over the quantile: one interval of 100 machines may be narrow
  for (const ErrorKind kind : kErrorKinds) {
    if (kind == ErrorKind::rotation && !turns(robot)) continue;
    for (const bool after : {false, true}) {
      const ErrorSpread one(made, {.kind = kind, .after = after}), other(both, {.kind = kind, .after = after});
      for (const double share : {0.5, 0.9}) {
        const Interval a = one.quantile_interval(share, 0.95), b = other.quantile_interval(share, 0.95);
        inside += a.low <= b.high && b.low <= a.high ? 1 : 0;
        const double apart = std::abs(one.quantile(share) - other.quantile(share));
        EXPECT_LT(apart, std::hypot(a.high - a.low, b.high - b.low)) << name(kind) << after << share;
        width_of_made += (a.high - a.low) / one.quantile(share);
        width_of_both += (b.high - b.low) / one.quantile(share);
        ++all;
      }
    }
  }
  EXPECT_LT(width_of_both, 0.8 * width_of_made);
  EXPECT_GE(inside, all - 1) << "of " << all;
}

TEST(BatchSurrogate, IsForFitsThatItFollows) {
  Batch batch{.robot = catalogue::huang2016(), .plan = {}, .seed = 1};
  ProductionPlan plan = paper_production(batch.robot, tolerances_of(batch.robot));
  plan.calibration.method = Method::paper;
  batch.plan = settled(batch.robot, plan);
  EXPECT_EQ(with_surrogate(batch).surrogate, nullptr);
  EXPECT_THROW(Surrogate(batch.robot, batch.plan), InvalidArgument);
}

// ---- the spread of an error that corrected machines have

constexpr double kScatter = 0.05;  ///< of ln(exact / linear)
constexpr double kFar = 5.0;       ///< times further off, where a calibration went wrong

/// Machines with linear values exp(0.3 z) whose exact ones are exp(0.05 + growth z + 0.05 z') times as large; of some,
/// whatever their linear value, five times that again. The first `pairs` are exact.
Tally made_up(std::uint64_t seed, std::uint64_t count, std::uint64_t pairs, double growth, double far) {
  Tally tally;
  FirstOrderTally& first_order = tally.first_order.emplace();
  first_order.machines = count;
  RandomStream random(seed);
  PerErrorKind<std::optional<double>> limits;
  limits[ErrorKind::distance] = 2.0;
  for (std::uint64_t m = 0; m < count; ++m) {
    const double z = random.normal(), linear = std::exp(0.3 * z);
    Accuracy first, second;
    first[ErrorKind::distance] = linear;
    second[ErrorKind::distance] =
        linear * std::exp(0.05 + growth * z + kScatter * random.normal()) * (random.uniform() < far ? kFar : 1.0);
    first_order.after[ErrorKind::distance].add(linear);
    first_order.before[ErrorKind::distance].add(linear);
    first_order.used_up.add(linear / 2.0);
    if (m >= pairs) continue;
    tally.add(MachinePair{.machine = m,
                          .fate = Fate::accepted,
                          .passes = second[ErrorKind::distance] <= 2.0,
                          .first_order = bins_of(first, first, limits),
                          .exact = bins_of(second, second, limits)});
  }
  return tally;
}

/// Probability that an exact value is below x.
double share_below(double x, double growth, double far) {
  const boost::math::normal law(0.05, std::hypot(0.3 + growth, kScatter));
  return (1.0 - far) * boost::math::cdf(law, std::log(x)) + far * boost::math::cdf(law, std::log(x / kFar));
}

struct World {
  const char* name;
  double growth, far;
};
void PrintTo(const World& world, std::ostream* out) { *out << world.name; }

class SpreadOfCorrected : public testing::TestWithParam<World> {};
INSTANTIATE_TEST_SUITE_P(Worlds, SpreadOfCorrected,
                         testing::Values(World{"follows", 0.0, 0.0}, World{"grows", 0.05, 0.0},
                                         World{"heavy_tail", 0.0, 0.02}, World{"rare_tail", 0.0, 0.001}),
                         [](const auto& one) { return one.param.name; });

/// Also where first order knows nothing of a tail. An interval holds a percentile when the probability below its ends
/// is on either side.
TEST_P(SpreadOfCorrected, IntervalsHoldTheTruth) {
  const auto [name, growth, far] = GetParam();
  int inside = 0, all = 0, yields = 0, known = 0;
  constexpr int kBatches = 60;
  for (int k = 0; k < kBatches; ++k) {
    const Tally tally = made_up(static_cast<std::uint64_t>(k) + 1, 20'000, 2'000, growth, far);
    const ErrorSpread spread(tally, {.kind = ErrorKind::distance});
    for (const double share : {0.3, 0.5, 0.9, 0.99, 0.997, 0.999}) {
      const Interval interval = spread.quantile_interval(share, 0.95);
      inside += share_below(interval.low, growth, far) <= share && share <= share_below(interval.high, growth, far);
      known += std::isfinite(interval.high) ? 1 : 0;
      ++all;
    }
    yields += yield(tally, 0.95).interval.contains(share_below(2.0, growth, far)) ? 1 : 0;
  }
  EXPECT_GE(inside, 0.94 * all);
  EXPECT_EQ(known, all - kBatches);            // 2000 machines cannot tell the 99.9 %
  EXPECT_GE(yields, 52) << "of " << kBatches;  // fewer at 95 % in 1 of 100
}

/// What first order knows is worth several times as many exact machines.
TEST(ErrorSpread, IsNarrowerThanThatOfItsExactMachines) {
  const Tally both = made_up(1, 20'000, 1'000, 0.0, 0.0), alone = made_up(1, 1'000, 1'000, 0.0, 0.0);
  const auto width = [](const Tally& tally, double share) {
    const Interval interval = ErrorSpread(tally, {.kind = ErrorKind::distance}).quantile_interval(share, 0.95);
    return interval.high - interval.low;
  };
  EXPECT_LT(width(both, 0.5), 0.6 * width(alone, 0.5));
  EXPECT_LT(width(both, 0.9), 0.6 * width(alone, 0.9));
}

/// Pairs are what makes it right: the linear values alone would miss by a twentieth.
TEST(ErrorSpread, IsNotThatOfLinearValues) {
  const Tally tally = made_up(1, 20'000, 2'000, 0.0, 0.0);
  const ErrorSpread spread(tally, {.kind = ErrorKind::distance});
  const double linear = tally.first_order->after[ErrorKind::distance].quantile(0.5);
  EXPECT_NEAR(spread.quantile(0.5) / linear, std::exp(0.05), 0.01);
  const double mean = std::exp(0.05 + 0.5 * (0.09 + 0.0025));
  EXPECT_NEAR(spread.moments().mean / mean, 1.0, 0.01);
  EXPECT_NEAR(spread.moments().std / (mean * std::sqrt(std::expm1(0.0925))), 1.0, 0.03);
  EXPECT_NEAR(static_cast<double>(spread.counts().total()), 2e4, 50.0);  // rounded, bin by bin
}

TEST(ErrorSpread, OfCountedMachinesIsTheirHistogram) {
  Tally tally;
  RandomStream random(4);
  for (int m = 0; m < 500; ++m) {
    MachineOutcome outcome{.fate = Fate::accepted, .passes = true, .before = {}, .after = {}};
    outcome.after[ErrorKind::tilt] = std::exp(random.normal());
    tally.add(outcome);
  }
  const Histogram& counted = tally.after[ErrorKind::tilt];
  const ErrorSpread spread(tally, {.kind = ErrorKind::tilt});
  for (const double share : {0.0, 0.001, 0.5, 0.95, 1.0}) {
    EXPECT_EQ(spread.quantile(share), counted.quantile(share));
  }
  const Interval interval = spread.quantile_interval(0.5, 0.95), expected = counted.quantile_interval(0.5, 0.95);
  EXPECT_NEAR(interval.low, expected.low, 0.03 * expected.low);
  EXPECT_NEAR(interval.high, expected.high, 0.03 * expected.high);
  EXPECT_NEAR(spread.moments().mean, counted.mean(), 1e-12);
  EXPECT_NEAR(spread.moments().std, counted.std(), 1e-12);
  EXPECT_EQ(spread.counts().counts(), counted.counts());
  EXPECT_TRUE(std::isnan(ErrorSpread(Tally(), {}).quantile(0.5)));
}

/// Of 300 machines the 99 % are not known yet, and no interval is of zero width.
TEST(ErrorSpread, SaysWhatFewMachinesCannotTell) {
  for (const std::uint64_t count : {std::uint64_t{300}, std::uint64_t{20'000}}) {
    const Tally tally = made_up(7, count, 300, 0.0, 0.0);
    const ErrorSpread spread(tally, {.kind = ErrorKind::distance});
    EXPECT_TRUE(std::isfinite(spread.quantile_interval(0.95, 0.95).high));
    EXPECT_TRUE(std::isinf(spread.quantile_interval(0.99, 0.95).high));
    EXPECT_GT(spread.quantile_interval(0.99, 0.95).low, spread.quantile(0.9));
    EXPECT_EQ(spread.quantile_interval(0.01, 0.95).low, 0.0);
  }
  Tally alike;
  MachineOutcome outcome{.fate = Fate::accepted, .passes = true, .before = {}, .after = {}};
  outcome.after[ErrorKind::tilt] = 0.001;
  for (int m = 0; m < 300; ++m) alike.add(outcome);
  const Interval interval = ErrorSpread(alike, {.kind = ErrorKind::tilt}).quantile_interval(0.5, 0.95);
  EXPECT_LT(interval.low, 0.001);
  EXPECT_GT(interval.high, 0.001);
}

/// What calibrations that fail leave behind is in the spread, and none of what was not seen is hidden.
TEST(ErrorSpread, HasTheMachinesWhoseCalibrationFailed) {
  Tally tally = made_up(2, 20'000, 2'000, 0.0, 0.0);
  EXPECT_NEAR(unseen_share(tally, 0.95), proportion_interval(0, 2'000, 0.95).high, 1e-15);
  const Proportion before = yield(tally, 0.95);
  EXPECT_LT(before.interval.low, before.value - unseen_share(tally, 0.95));
  for (std::size_t k = 0; k < tally.pairs.size(); k += 20) {
    MachinePair& pair = tally.pairs[k];
    pair.fate = Fate::rejected;
    constexpr std::uint32_t kOctaves = 7 * 256;
    pair.exact.after[ErrorKind::distance] += kOctaves;
    pair.exact.used_up += kOctaves;
    --tally.of(Fate::accepted);
    ++tally.of(Fate::rejected);
  }
  EXPECT_EQ(unseen_share(tally, 0.95), 0.0);
  EXPECT_NEAR(yield(tally, 0.95).value, 0.95 * before.value, 0.01);
  EXPECT_GT(ErrorSpread(tally, {.kind = ErrorKind::distance}).quantile(0.98), 20.0);
}

TEST(ErrorSpread, ScrapHasNoErrorAndDoesNotPass) {
  Tally tally = made_up(3, 5'000, 1'000, 0.0, 0.0);
  const Proportion before = yield(tally, 0.95);
  const double median = ErrorSpread(tally, {.kind = ErrorKind::distance}).quantile(0.5);
  for (std::size_t k = 0; k < tally.pairs.size(); k += 10) {
    MachinePair& pair = tally.pairs[k];
    pair.fate = Fate::does_not_close;
    pair.passes = false;
    pair.exact = {};
    --tally.of(Fate::accepted);
    ++tally.of(Fate::does_not_close);
  }
  const ErrorSpread spread(tally, {.kind = ErrorKind::distance});
  EXPECT_NEAR(spread.quantile(0.5), median, 0.02 * median);
  EXPECT_NEAR(static_cast<double>(spread.counts().total()), 4'500.0, 25.0);
  EXPECT_NEAR(yield(tally, 0.95).value, 0.9 * before.value, 0.01);
  EXPECT_LT(yield(tally, 0.95).interval.high, 0.94);
}

/// Of a part without pairs too, where no row shows that a column is none.
TEST(BatchSurrogate, RefusesPartsOfAnotherType) {
  using io::Json;
  Tally none;
  none.first_order.emplace();
  const Json json = io::tally_json(none);
  EXPECT_EQ(io::tally_json(io::tally_of(json)).dump(), json.dump());
  for (const char* place :
       {"/fates", "/pairs/machine", "/pairs/fate", "/pairs/passes", "/pairs/first_order", "/pairs/first_order/0",
        "/pairs/exact/10", "/first_order/used_up", "/first_order/before/tilt"}) {
    for (const Json& wrong : {Json(), Json(""), Json(5), Json::object(), Json::array({"x"})}) {
      Json changed = json;
      changed[Json::json_pointer(place)] = wrong;
      EXPECT_THROW((void)io::tally_of(changed), std::exception) << place << ": " << wrong;
    }
  }
  Json longer = json;
  longer["fates"].push_back(0U);
  EXPECT_THROW((void)io::tally_of(longer), std::exception);
}

/// Parts of either kind, in any order and over threads, are the same to the last bit.
TEST(BatchSurrogate, PartsMergeInAnyOrderAndOverThreads) {
  Batch batch{.robot = catalogue::huang2016(), .plan = {}, .seed = 3};
  batch.plan = settled(batch.robot, paper_production(batch.robot, tolerances_of(batch.robot)));
  batch.plan.limits[ErrorKind::volumetric_aligned] = 0.08;
  batch = with_surrogate(std::move(batch));
  Tally whole = to_first_order(batch, {0, 330}, 2, kNeverStop).value();
  whole.add(exactly(batch, {0, 12}, 2, kNeverStop).value());
  Tally sum;
  sum.add(exactly(batch, {8, 4}, 1, kNeverStop).value());
  for (const std::uint64_t first : {220U, 0U, 110U})
    sum.add(to_first_order(batch, {first, 110}, 1, kNeverStop).value());
  sum.add(exactly(batch, {0, 8}, 1, kNeverStop).value());
  EXPECT_EQ(io::tally_json(sum).dump(), io::tally_json(whole).dump());
  EXPECT_EQ(sum.machines(), 330U);
  EXPECT_EQ(sum.pairs, whole.pairs);
  // As a chunk is kept and goes from rank to rank.
  EXPECT_EQ(io::tally_json(io::tally_of(io::tally_json(whole))).dump(), io::tally_json(whole).dump());
  const MachinePair& last = whole.pairs.back();
  const MachineOutcome made = produce(batch.robot, batch.plan, batch.seed, last.machine);
  EXPECT_EQ(last.exact, bins_of(made.before, made.after, batch.plan.limits));
  EXPECT_NEAR(Histogram::value_of(last.first_order.after[ErrorKind::tilt]) / made.after[ErrorKind::tilt], 1.0, 0.05);
  EXPECT_EQ(last.exact.used_up, Histogram::bin_of(made.after[ErrorKind::volumetric_aligned] / 0.08));
}

}  // namespace
}  // namespace paracal::surrogate_test
