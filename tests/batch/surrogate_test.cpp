// Batches made to first order: against machines that were built, measured and calibrated, and what their intervals
// hold.

#include "batch/surrogate.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "batch/batch_surrogate.hpp"
#include "paracal/batch/batch.hpp"
#include "paracal/batch/error_spread.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/mechanism/random.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::surrogate_test {
namespace {

using testing::IsEmpty, testing::SizeIs;

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
  if (robot.on_single_rods()) plan.instrument.rotation_noise = 1e-5;
  plan.calibration.tolerances = plan.tolerances;
  plan.calibration.noise.point = plan.calibration.noise.body = plan.instrument.noise;
  if (plan.instrument.rotation_noise > 0.0) plan.calibration.noise.rotation = plan.instrument.rotation_noise;
  plan.calibration.noise_is_known = true;
  plan.calibration.exclude_outliers = false;
  plan.calibration.admit_drop = 1e9;
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

/// Most machines made to first order, or all by produce() and with other random numbers: the same spread, within what
/// both say of themselves. 1000 machines know quantiles three times as well as 100; a spread of linear values alone, or
/// one whose weights are wrong, is outside for either.
TEST_P(SurrogateBatch, SpreadsAsMachinesThatWereMade) {
  const auto few = static_cast<std::uint64_t>(test::machines({.claim = 1000, .quick = 100}));
  const Tally made = run_chunk(batch(2), {0, few}, 0, kNeverStop).value();
  const Tally both = run_chunk(with_surrogate(batch(3)), {0, 20 * few}, 0, kNeverStop).value();
  ASSERT_TRUE(both.surrogate);
  ASSERT_LT(both.produced(), both.machines() / 3);
  int inside = 0, all = 0;
  double width_of_made = 0.0, width_of_both = 0.0;  // over the quantile: one interval of 100 machines may be narrow
  for (const ErrorKind kind : kErrorKinds) {
    if (kind == ErrorKind::rotation && !turns(robot)) continue;
    for (const bool after : {false, true}) {
      const ErrorSpread one(made, {.kind = kind, .after = after}), other(both, {.kind = kind, .after = after});
      for (const double share : {0.5, 0.9, 0.97}) {
        const Interval a = one.quantile_interval(share, 0.95), b = other.quantile_interval(share, 0.95);
        const double apart = std::abs(one.quantile(share) - other.quantile(share));
        const double bins = 0.004 * one.quantile(share);
        inside += apart <= 0.5 * std::hypot(a.high - a.low, b.high - b.low) + bins ? 1 : 0;
        EXPECT_LT(apart, std::hypot(a.high - a.low, b.high - b.low) + bins) << name(kind) << after << share;
        width_of_made += (a.high - a.low) / one.quantile(share);
        width_of_both += (b.high - b.low) / one.quantile(share);
        ++all;
      }
    }
  }
  EXPECT_LT(width_of_both, width_of_made);
  EXPECT_GE(inside, all - 4) << "of " << all;  // at 95 %, of 24 to 30 that hang together
}

// ---- the spread of an error that corrected machines have

/// Machines with linear values exp(0.3 z) whose true ones are larger by a factor of mean exp(0.05) that grows with
/// them, chosen as a batch would.
struct Made {
  Tally tally;
  std::vector<double> truth;
};
Made made_up(std::uint64_t seed, std::uint64_t count, double growth) {
  Made made;
  SurrogateTally& surrogate = made.tally.surrogate.emplace();
  surrogate.machines = count;
  RandomStream random(seed);
  for (std::uint64_t m = 0; m < count; ++m) {
    const double z = random.normal(), linear = std::exp(0.3 * z);
    const double value = linear * std::exp(0.05 + growth * z + 0.05 * random.normal());
    Accuracy first, second;
    first[ErrorKind::distance] = linear;
    second[ErrorKind::distance] = value;
    surrogate.after[ErrorKind::distance].add(linear);
    surrogate.before[ErrorKind::distance].add(linear);
    surrogate.used_up.add(linear / 2.0);
    made.truth.push_back(value);
    const double tail = 0.5 * std::erfc(z / std::sqrt(2.0));
    const double chance = tail < 0.01 ? 1.0 : tail < 0.1 ? 0.2 : 0.01;
    if (chance < 1.0 && random.uniform() > chance) continue;
    made.tally.add({.fate = Fate::accepted, .passes = value <= 2.0, .before = second, .after = second});
    surrogate.pairs.push_back({.machine = m,
                               .chance = chance,
                               .outcome = {.fate = Fate::accepted, .before = second, .after = second},
                               .first_order_before = first,
                               .first_order_after = first,
                               .used_up = value / 2.0,
                               .first_order_used_up = linear / 2.0});
  }
  return made;
}

/// The share below x of ln g = 0.05 + (0.3 + growth) z + 0.05 z'.
double share_below(double x, double growth) {
  const boost::math::normal law(0.05, std::hypot(0.3 + growth, 0.05));
  return boost::math::cdf(law, std::log(x));
}
double value_at(double share, double growth) {
  return std::exp(boost::math::quantile(boost::math::normal(0.05, std::hypot(0.3 + growth, 0.05)), share));
}

class SpreadOfCorrected : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Growths, SpreadOfCorrected, testing::Values(0.0, 0.02));

TEST_P(SpreadOfCorrected, IntervalsHoldTheTruth) {
  const double growth = GetParam();
  int inside = 0, all = 0, yields = 0;
  constexpr int kBatches = 60;
  for (int k = 0; k < kBatches; ++k) {
    const Made made = made_up(static_cast<std::uint64_t>(k) + 1, 20'000, growth);
    const ErrorSpread spread(made.tally, {.kind = ErrorKind::distance});
    for (const double share : {0.3, 0.5, 0.9, 0.99, 0.999}) {
      const Interval interval = spread.quantile_interval(share, 0.95);
      const double truth = value_at(share, growth), bin = 0.002 * truth;
      inside += interval.low - bin <= truth && truth <= interval.high + bin ? 1 : 0;
      ++all;
    }
    const Proportion share = spread.share_within(2.0, 0.95);
    yields += share.interval.contains(share_below(2.0, growth)) ? 1 : 0;
  }
  EXPECT_GE(inside, 0.92 * all);
  EXPECT_GE(yields, 52) << "of " << kBatches;  // fewer at 95 % in 1 of 100
}

/// Pairs are what makes it right: the linear values alone would miss by a twentieth.
TEST(SpreadOfCorrected, IsNotThatOfLinearValues) {
  const Made made = made_up(1, 20'000, 0.0);
  const ErrorSpread spread(made.tally, {.kind = ErrorKind::distance});
  const double linear = made.tally.surrogate->after[ErrorKind::distance].quantile(0.5);
  EXPECT_NEAR(spread.quantile(0.5) / linear, std::exp(0.05), 0.02);
  const double mean = std::exp(0.05 + 0.5 * (0.09 + 0.0025));
  EXPECT_NEAR(spread.mean() / mean, 1.0, 0.01);
  EXPECT_NEAR(spread.std() / (mean * std::sqrt(std::expm1(0.0925))), 1.0, 0.03);
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
  EXPECT_NEAR(interval.low, expected.low, 0.02 * expected.low);
  EXPECT_NEAR(interval.high, expected.high, 0.02 * expected.high);
  EXPECT_NEAR(spread.mean(), counted.mean(), 1e-12);
  EXPECT_NEAR(spread.std(), counted.std(), 1e-12);
  EXPECT_EQ(spread.counts().counts(), counted.counts());
  EXPECT_TRUE(std::isnan(ErrorSpread(Tally(), {}).quantile(0.5)));
}

/// What calibrations that fail leave behind is in the spread, and none of what was not seen is hidden.
TEST(ErrorSpread, HasTheMachinesWhoseCalibrationFailed) {
  Made made = made_up(2, 20'000, 0.0);
  std::vector<MachinePair>& pairs = made.tally.surrogate->pairs;
  EXPECT_NEAR(unseen_share(made.tally, 0.95), proportion_interval(0, pairs.size(), 0.95).high, 1e-15);
  const double yield_before = yield(made.tally, 0.95).value;
  // What may fail unseen lowers what is sure of the yield.
  const Proportion within = ErrorSpread(made.tally, {.used_up = true}).share_within(1.0, 0.95);
  EXPECT_NEAR(yield(made.tally, 0.95).interval.low, within.interval.low - unseen_share(made.tally, 0.95), 1e-12);
  int failed = 0;
  for (std::size_t k = 0; k < pairs.size(); k += 20, ++failed) {
    pairs[k].outcome.fate = Fate::rejected;
    pairs[k].outcome.after[ErrorKind::distance] *= 100.0;
    pairs[k].used_up *= 100.0;
    --made.tally.of(Fate::accepted);
    ++made.tally.of(Fate::rejected);
  }
  EXPECT_EQ(unseen_share(made.tally, 0.95), 0.0);
  EXPECT_NEAR(yield(made.tally, 0.95).value, 0.95 * yield_before, 0.03);
  EXPECT_GT(ErrorSpread(made.tally, {.kind = ErrorKind::distance}).quantile(0.98), 20.0);
}

TEST(ErrorSpread, ScrapHasNoErrorAndDoesNotPass) {
  Made made = made_up(3, 5'000, 0.0);
  const double yield_before = yield(made.tally, 0.95).value;
  const double median = ErrorSpread(made.tally, {.kind = ErrorKind::distance}).quantile(0.5);
  for (std::size_t k = 0; k < made.tally.surrogate->pairs.size(); k += 10) {
    MachinePair& pair = made.tally.surrogate->pairs[k];
    pair.outcome = {};
    pair.used_up = 0.0;
    --made.tally.of(Fate::accepted);
    ++made.tally.of(Fate::does_not_close);
  }
  EXPECT_NEAR(ErrorSpread(made.tally, {.kind = ErrorKind::distance}).quantile(0.5), median, 0.02 * median);
  EXPECT_NEAR(yield(made.tally, 0.95).value, 0.9 * yield_before, 0.05);
  // Not even at best: the end of the interval is lower by the same share.
  const Proportion passes = yield(made.tally, 0.95);
  const Proportion within = ErrorSpread(made.tally, {.used_up = true}).share_within(1.0, 0.95);
  EXPECT_NEAR(passes.interval.high / within.interval.high, passes.value / within.value, 1e-12);
  EXPECT_LT(passes.interval.high, 0.97);
}

/// A tally of 10,000 machines of which the pairs alone were made: all of linear value 1, but for 100 of value 5.
Tally two_strata(std::size_t pairs_above, double ratio_above) {
  Tally tally;
  SurrogateTally& surrogate = tally.surrogate.emplace();
  surrogate.machines = 10'000;
  const auto linear = [](bool above) { return above ? 5.0 : 1.0; };
  for (std::uint64_t m = 0; m < surrogate.machines; ++m) {
    surrogate.after[ErrorKind::distance].add(linear(m < 100));
  }
  const auto add = [&](bool above, double ratio, double chance) {
    MachinePair pair;
    pair.machine = surrogate.pairs.size();
    pair.chance = chance;
    pair.outcome.fate = Fate::accepted;
    pair.first_order_after[ErrorKind::distance] = linear(above);
    pair.outcome.after[ErrorKind::distance] = ratio * linear(above);
    tally.add(pair.outcome);
    surrogate.pairs.push_back(pair);
  };
  for (int k = 0; k < 99; ++k) add(false, 1.0, 0.01);
  for (std::size_t k = 0; k < pairs_above; ++k) add(true, ratio_above, 0.1);
  return tally;
}

/// Ten pairs tell what corrects a stratum, fewer join the one below, whose ratios then outweigh theirs.
TEST(ErrorSpread, TenPairsTellTheRatiosOfAStratum) {
  const auto top = [](std::size_t pairs) {
    return ErrorSpread(two_strata(pairs, 3.0), {.kind = ErrorKind::distance}).quantile(0.995);
  };
  EXPECT_NEAR(top(10), 15.0, 0.1);
  EXPECT_NEAR(top(9), 5.0, 0.05);
}

/// Whatever the chances were, a stratum has as many machines as it had.
TEST(ErrorSpread, AStratumHasItsMachines) {
  const Histogram counts = ErrorSpread(two_strata(20, 3.0), {.kind = ErrorKind::distance}).counts();
  EXPECT_NEAR(static_cast<double>(counts.total()), 1e4, 1.0);
}

// ---- which machines are made both ways

Batch paper_batch(std::uint64_t seed = 3) {
  Batch batch{.robot = catalogue::huang2016(), .plan = {}, .seed = seed};
  batch.plan = settled(batch.robot, paper_production(batch.robot, tolerances_of(batch.robot)));
  batch.plan.limits[ErrorKind::volumetric_aligned] = 0.08;
  return with_surrogate(std::move(batch));
}

TEST(BatchSurrogate, TheFirstMachinesAndRareOnesAreMadeBothWays) {
  const Batch batch = paper_batch();
  const std::vector<Accuracy> ends = strata(batch);
  ASSERT_THAT(ends, SizeIs(4));
  const Accuracy usual{};
  EXPECT_EQ(batch.surrogate->chance(199, usual), 1.0);  // half of all machines are such: 100 of them
  EXPECT_NEAR(batch.surrogate->chance(200, usual), 0.1 / (0.5 * std::sqrt(200.0)), 1e-12);
  EXPECT_NEAR(batch.surrogate->chance(1'000'000, usual), 0.1 / (0.5 * 1000.0), 1e-12);
  Accuracy rare = usual;
  rare[ErrorKind::tilt] = 1.01 * ends[3][ErrorKind::tilt];
  EXPECT_EQ(batch.surrogate->chance(99'999, rare), 1.0);
  EXPECT_NEAR(batch.surrogate->chance(1'000'000, rare), 0.1 / (0.001 * 1000.0), 1e-9);
  for (std::size_t k = 1; k < ends.size(); ++k) EXPECT_GT(ends[k][ErrorKind::tilt], ends[k - 1][ErrorKind::tilt]);
}

/// Pairs stand for as many machines as one over their chance; a chance that was not theirs is a wrong share.
TEST(BatchSurrogate, PairsAreChosenByTheChanceThatTheyState) {
  const Batch batch = paper_batch();
  constexpr MachineRange kRange{20'000, 7'000};
  double expected = 0.0, variance = 0.0;
  const std::vector<Surrogate::Values> values =
      batch.surrogate->surrogate().machines(batch.seed, kRange.first, kRange.count);
  for (std::uint64_t k = 0; k < kRange.count; ++k) {
    const double chance = batch.surrogate->chance(kRange.first + k, values[k].after);
    expected += chance;
    variance += chance * (1.0 - chance);
  }
  const Tally tally = run_chunk(batch, kRange, 2, kNeverStop).value();
  EXPECT_NEAR(static_cast<double>(tally.surrogate->pairs.size()), expected, 3.0 * std::sqrt(variance));
  for (const MachinePair& pair : tally.surrogate->pairs) {
    EXPECT_EQ(pair.chance, batch.surrogate->chance(pair.machine, pair.first_order_after));
  }
}

TEST(BatchSurrogate, IsForFitsThatItFollows) {
  Batch batch{.robot = catalogue::huang2016(), .plan = {}, .seed = 1};
  ProductionPlan plan = paper_production(batch.robot, tolerances_of(batch.robot));
  plan.calibration.method = Method::paper;
  batch.plan = settled(batch.robot, plan);
  EXPECT_EQ(with_surrogate(batch).surrogate, nullptr);
  EXPECT_THAT(strata(batch), IsEmpty());
  EXPECT_THROW(Surrogate(batch.robot, batch.plan), InvalidArgument);
}

TEST(BatchSurrogate, PartsMergeInAnyOrderAndOverThreads) {
  const Batch batch = paper_batch();
  const auto part = [&](std::uint64_t first, std::uint64_t count, unsigned threads) {
    return run_chunk(batch, {first, count}, threads, kNeverStop).value();
  };
  constexpr std::uint64_t kFirst = 170;  // of the first 200 all are made both ways, of the others few
  const Tally whole = part(kFirst, 330, 2);
  Tally sum;
  for (const std::uint64_t after : {220U, 0U, 110U}) sum.add(part(kFirst + after, 110, 1));
  ASSERT_TRUE(sum.surrogate);
  EXPECT_EQ(sum.fates, whole.fates);
  EXPECT_EQ(sum.machines(), 330U);
  EXPECT_EQ(sum.produced(), whole.surrogate->pairs.size());
  EXPECT_EQ(io::to_json(batch, sum, 0.95).dump(), io::to_json(batch, whole, 0.95).dump());
  ASSERT_EQ(sum.surrogate->pairs.size(), whole.surrogate->pairs.size());
  for (std::size_t k = 0; k < sum.surrogate->pairs.size(); ++k) {
    EXPECT_EQ(sum.surrogate->pairs[k].machine, whole.surrogate->pairs[k].machine);
    EXPECT_EQ(sum.surrogate->pairs[k].outcome, whole.surrogate->pairs[k].outcome);
  }
  // A pair is the machine that produce() makes, beside its first order.
  const MachinePair& last = whole.surrogate->pairs.back();
  EXPECT_EQ(last.outcome, produce(batch.robot, batch.plan, batch.seed, last.machine));
  EXPECT_NEAR(last.first_order_after[ErrorKind::tilt] / last.outcome.after[ErrorKind::tilt], 1.0, 0.05);
  EXPECT_EQ(last.used_up, last.outcome.after[ErrorKind::volumetric_aligned] / 0.08);
}

TEST(BatchSurrogate, AStoppedChunkIsDropped) {
  const std::atomic<bool> stopped = true;
  EXPECT_FALSE(run_chunk(paper_batch(), {0, 100'000}, 0, stopped).has_value());
}

}  // namespace
}  // namespace paracal::surrogate_test
