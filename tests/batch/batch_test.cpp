#include "paracal/batch/batch.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <thread>

#include "jobs/batch_job.hpp"
#include "paracal/error.hpp"
#include "paracal/io/tally_json.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/random.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::batch_test {
namespace {

using test::machines;

const std::atomic<bool> kNeverStop = false;

/// The paper's batch with a limit that some machines miss.
Batch a_batch() {
  Batch batch{.robot = catalogue::huang2016(), .plan = {}, .seed = 3};
  batch.plan = settled(batch.robot, paper_production(batch.robot, tolerances_of(batch.robot)));
  batch.plan.limits[ErrorKind::volumetric_aligned] = 0.05;
  return batch;
}

void expect_same(const Tally& one, const Tally& other) {
  EXPECT_EQ(one.fates, other.fates);
  EXPECT_EQ(one.passed, other.passed);
  for (const ErrorKind kind : kErrorKinds) {
    EXPECT_EQ(one.before[kind].counts(), other.before[kind].counts()) << name(kind);
    EXPECT_EQ(one.after[kind].counts(), other.after[kind].counts()) << name(kind);
  }
}

/// Ten machines are shared by two threads, and too few for 64.
TEST(Batch, IsTheSumOfItsMachines) {
  const Batch batch = a_batch();
  const auto count = static_cast<std::uint64_t>(machines({.claim = 20, .quick = 10}));
  Tally one_by_one;
  for (std::uint64_t machine = 0; machine < count; ++machine) {
    one_by_one.add(produce(batch.robot, batch.plan, batch.seed, 100 + machine));
  }
  EXPECT_EQ(one_by_one.machines(), count);
  EXPECT_EQ(one_by_one.before[ErrorKind::tilt].total(), count);
  for (const unsigned threads : {1U, 2U, 64U, 0U}) {
    const std::optional<Tally> chunk = exactly(batch, {100, count}, threads, kNeverStop);
    ASSERT_TRUE(chunk.has_value());
    expect_same(*chunk, one_by_one);
  }
}

/// Parts of few machines each: what merges is counts.
TEST(Batch, PartsMergeInAnyOrder) {
  const Batch batch = a_batch();
  const auto third = static_cast<std::uint64_t>(machines({.claim = 10, .quick = 4}));
  std::vector<Tally> parts;
  for (std::uint64_t part = 0; part < 3; ++part) {
    parts.push_back(exactly(batch, {part * third, third}, 0, kNeverStop).value());
  }
  const Tally whole = exactly(batch, {0, 3 * third}, 0, kNeverStop).value();
  for (const std::array<std::size_t, 3>& order : {std::array<std::size_t, 3>{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}) {
    Tally sum;
    for (const std::size_t part : order) sum.add(parts[part]);
    expect_same(sum, whole);
  }
}

TEST(Batch, AStoppedChunkIsDropped) {
  const Batch batch = a_batch();
  const std::atomic<bool> stopped = true;
  EXPECT_FALSE(exactly(batch, {0, 1000000}, 0, stopped).has_value());
  EXPECT_FALSE(to_first_order(with_surrogate(batch), {0, 100'000}, 0, stopped).has_value());
  std::atomic<bool> stop = false;
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop = true;
  });
  EXPECT_FALSE(exactly(batch, {0, 100000}, 0, stop).has_value());
}

/// Takes a stage's chunks until there are enough, then says that it was stopped.
class StoppedJob : public LongJob {
 public:
  explicit StoppedJob(std::uint64_t chunks) : chunks_(chunks) {}
  bool run(JobStage& stage) override {
    stage.clear();
    for (std::uint64_t k = stage.first(); k < chunks_; ++k) stage.add(stage.compute(k).value());
    return false;
  }

 private:
  std::uint64_t chunks_;
};

/// Without a folder, what was finished is what there is.
TEST(Batch, AStoppedRunHasItsWholeChunks) {
  const Batch batch = a_batch();
  StoppedJob job(2);
  const jobs::BatchResult result = jobs::run_batch(batch, {.machines = 1000}, {.exact = 3}, job, kNeverStop);
  EXPECT_FALSE(result.complete);
  expect_same(result.tally, exactly(batch, {0, 6}, 0, kNeverStop).value());
}

TEST(Batch, RefusesRunsThatMakeNoSense) {
  const Batch batch = a_batch();
  JobInMemory job;
  EXPECT_THROW((void)jobs::run_batch(batch, {.machines = 0}, {.exact = 1}, job, kNeverStop), InvalidArgument);
  EXPECT_THROW((void)jobs::chunk_sizes(io::Json{{"chunks", {{"first_order", 0U}, {"exact", 0U}}}}), InvalidArgument);
}

// ---- how much is computed

/// A power of two with the work of about a fifth of a second, more of it where there would be too many files.
TEST(ChunkSizes, FollowFromCountedWork) {
  const Batch exact = a_batch(), quick = with_surrogate(exact);
  EXPECT_EQ(chunk_sizes(exact, 1'000).exact, 64U);
  EXPECT_EQ(chunk_sizes(exact, 1'000).first_order, 0U);
  EXPECT_EQ(chunk_sizes(exact, 1'000'000'000).exact, 16'384U);  // 61,036 chunks
  EXPECT_EQ(chunk_sizes(quick, 1'000).first_order, 8'192U);
  EXPECT_EQ(chunk_sizes(quick, 1'000).exact, 64U);
  EXPECT_EQ(chunk_sizes(quick, 1'000'000'000).first_order, 16'384U);
  EXPECT_EQ(chunk_sizes(quick, 1'000'000'000).exact, 64U);
  Batch larger = exact;
  for (int k = 0; k < 3; ++k)
    larger.plan.validation.insert(larger.plan.validation.end(), exact.plan.validation.begin(),
                                  exact.plan.validation.end());
  EXPECT_EQ(chunk_sizes(larger, 1'000).exact, 16U);
}

TEST(ExactRounds, GrowByHalvesAndThirds) {
  std::vector<std::uint64_t> rounds;
  for (std::uint64_t k = 0; k < 6; ++k) rounds.push_back(exact_round(k));
  EXPECT_THAT(rounds, testing::ElementsAre(256, 384, 512, 768, 1024, 1536));
}

/// Stages of a job as they come, with machines that need no robot: ln(exact / first order) scatters by `spread`.
class ImaginedJob : public LongJob {
 public:
  ImaginedJob(std::uint64_t machines, double spread) : machines_(machines), spread_(spread) {}
  std::vector<std::uint64_t> exact;  ///< machines at the end of each stage

  bool run(JobStage& stage) override {
    stage.clear();
    stage.add(io::tally_json(stage.name_of(stage.first()).starts_with("first-order") ? to_first_order() : pairs(stage))
                  .dump());
    return true;
  }

 private:
  static double linear(std::uint64_t machine) { return std::exp(0.3 * RandomStream(1, machine).normal()); }

  Tally to_first_order() const {
    Tally tally;
    FirstOrderTally& sum = tally.first_order.emplace();
    sum.machines = machines_;
    for (std::uint64_t m = 0; m < machines_; ++m) {
      for (const ErrorKind kind : kErrorKinds) {
        sum.before[kind].add(linear(m));
        sum.after[kind].add(linear(m));
      }
      sum.used_up.add(linear(m));
    }
    return tally;
  }

  Tally pairs(const JobStage& stage) {
    exact.push_back(64 * stage.last());
    Tally tally;
    for (std::uint64_t m = 64 * stage.first(); m < 64 * stage.last(); ++m) {
      const double value = linear(m) * std::exp(spread_ * RandomStream(2, m).normal());
      MachinePair pair{.machine = m, .fate = Fate::accepted, .passes = true, .first_order = {}, .exact = {}};
      for (const ErrorKind kind : kErrorKinds) {
        pair.first_order.before[kind] = pair.first_order.after[kind] = Histogram::bin_of(linear(m));
        pair.exact.before[kind] = pair.exact.after[kind] = Histogram::bin_of(value);
      }
      tally.add(pair);
    }
    return tally;
  }

  std::uint64_t machines_;
  double spread_;
};

/// Rounds go on until the interval is reached, and never beyond half of the machines; small batches are exact.
TEST(ExactRounds, EndAtTheInterval) {
  const Batch batch = with_surrogate(a_batch());
  const auto rounds = [&](std::uint64_t machines, double interval, std::uint64_t least, double spread = 0.1) {
    ImaginedJob job(machines, spread);
    (void)jobs::run_batch(batch, {.machines = machines, .interval = interval, .least_exact = least}, {8192, 64}, job,
                          kNeverStop);
    return job.exact;
  };
  EXPECT_EQ(rounds(4'000, 1.0, 0).back(), 256U);
  EXPECT_EQ(rounds(4'000, 1.0, 500).back(), 512U);
  EXPECT_EQ(rounds(4'000, 1e-6, 0).back(), 1920U);
  EXPECT_EQ(rounds(1'000, 1e-6, 0).back(), 384U);
  EXPECT_EQ(rounds(300, 1e-6, 0).back(), 256U);
  EXPECT_EQ(rounds(20'000, 1.0, 0).back(), 1536U);   // one in 16
  EXPECT_EQ(rounds(100'000, 1.0, 0).back(), 4096U);  // the 99.9 %
  const std::vector<std::uint64_t> coarse = rounds(8'000, 0.06, 0), fine = rounds(8'000, 0.03, 0);
  EXPECT_LT(coarse.back(), fine.back());
  EXPECT_LT(fine.back(), 3968U);
}

/// A batch that is smaller than a round is exact as a whole, and counted.
TEST(ExactRounds, SmallBatchesAreExact) {
  const Batch batch = with_surrogate(a_batch());
  JobInMemory job;
  const Tally tally = jobs::run_batch(batch, {.machines = 5}, {8192, 2}, job, kNeverStop).tally;
  EXPECT_EQ(tally.produced(), 5U);
  EXPECT_EQ(tally.machines(), 5U);
  Tally counted;
  for (std::uint64_t m = 0; m < 5; ++m) counted.add(produce(batch.robot, batch.plan, batch.seed, m));
  EXPECT_EQ(tally.fates, counted.fates);
  EXPECT_EQ(yield(tally, 0.95).interval.low, yield(counted, 0.95).interval.low);
  // A pair is the machine that produce() makes.
  EXPECT_EQ(tally.pairs[3].exact.after[ErrorKind::tilt],
            Histogram::bin_of(produce(batch.robot, batch.plan, batch.seed, 3).after[ErrorKind::tilt]));
}

TEST(Tally, StatesYieldAndDefects) {
  Tally tally;
  for (int k = 0; k < 20; ++k) tally.add({.fate = Fate::accepted, .passes = k >= 5, .before = {}, .after = {}});
  const Proportion share = yield(tally, 0.95);
  EXPECT_EQ(share.value, 0.75);
  EXPECT_NEAR(share.interval.low, 1.0 - 0.4910, 1e-4);
  EXPECT_NEAR(share.interval.high, 1.0 - 0.0866, 1e-4);
  const Proportion defects = defects_per_million(share);
  EXPECT_EQ(defects.value, 250000.0);
  EXPECT_NEAR(defects.interval.low, 86600.0, 100.0);
  EXPECT_NEAR(defects.interval.high, 491000.0, 100.0);
  EXPECT_TRUE(std::isnan(yield({}, 0.95).value));
}

TEST(Tally, ScrapHasNoAccuracy) {
  Tally tally;
  tally.add(MachineOutcome{});
  EXPECT_EQ(tally.of(Fate::does_not_close), 1U);
  EXPECT_EQ(tally.after[ErrorKind::distance].total(), 0U);
  EXPECT_EQ(tally.passed, 0U);
}

}  // namespace
}  // namespace paracal::batch_test
