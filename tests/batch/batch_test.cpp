#include "paracal/batch/batch.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <thread>

#include "paracal/error.hpp"
#include "paracal/io/chunks.hpp"
#include "paracal/mechanism/catalogue.hpp"
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
    const std::optional<Tally> chunk = run_chunk(batch, {100, count}, threads, kNeverStop);
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
    parts.push_back(run_chunk(batch, {part * third, third}, 0, kNeverStop).value());
  }
  const Tally whole = run_chunk(batch, {0, 3 * third}, 0, kNeverStop).value();
  for (const std::array<std::size_t, 3>& order : {std::array<std::size_t, 3>{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}) {
    Tally sum;
    for (const std::size_t part : order) sum.add(parts[part]);
    expect_same(sum, whole);
  }
}

TEST(Batch, AStoppedChunkIsDropped) {
  const Batch batch = a_batch();
  const std::atomic<bool> stopped = true;
  EXPECT_FALSE(run_chunk(batch, {0, 1000000}, 0, stopped).has_value());
  std::atomic<bool> stop = false;
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop = true;
  });
  EXPECT_FALSE(run_chunk(batch, {0, 100000}, 0, stop).has_value());
}

/// Without a folder, what was finished is what there is.
TEST(Batch, AStoppedRunHasItsWholeChunks) {
  const Batch batch = a_batch();
  std::atomic<bool> stop = false;
  const io::BatchResult result = io::run_batch(
      batch, {.machines = 1000, .chunk = 3, .progress = [&](std::uint64_t machines) { stop = machines == 6; }}, stop);
  EXPECT_FALSE(result.complete);
  expect_same(result.tally, run_chunk(batch, {0, 6}, 0, kNeverStop).value());
}

TEST(Batch, RefusesRunsThatMakeNoSense) {
  const Batch batch = a_batch();
  EXPECT_THROW((void)io::run_batch(batch, {.machines = 0}, kNeverStop), InvalidArgument);
  EXPECT_THROW((void)io::run_batch(batch, {.machines = 1, .chunk = 0}, kNeverStop), InvalidArgument);
  EXPECT_THROW((void)io::run_batch(batch, {.machines = 1, .rank = {.number = 1, .size = 2}}, kNeverStop),
               InvalidArgument);
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
