#include "paracal/batch/batch.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "paracal/batch/error_spread.hpp"
#include "surrogate.hpp"

namespace paracal {
namespace {

/// More than there are cores would wait for one another.
unsigned worker_count(unsigned threads) {
  const auto cores = static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
  return threads == 0 ? cores : std::min(threads, cores);
}

/// As many tasks as workers, each taking the next of the numbers below `count`: a limit on threads without an arena a
/// chunk, of which TBB keeps some memory for every one.
template <typename Work>
void for_each_number(std::uint64_t count, unsigned threads, const std::atomic<bool>& stop, const Work& work) {
  std::atomic<std::uint64_t> next = 0;
  const auto take = [&](unsigned /*worker*/) {
    for (std::uint64_t k = next++; k < count && !stop.load(std::memory_order_relaxed); k = next++) work(k);
  };
  tbb::parallel_for(0U, worker_count(threads), take, tbb::simple_partitioner());
}

std::vector<Surrogate::Values> first_order(const Batch& batch, MachineRange range, unsigned threads,
                                           const std::atomic<bool>& stop) {
  constexpr std::uint64_t kPart = 256;
  std::vector<Surrogate::Values> values(range.count);
  for_each_number((range.count + kPart - 1) / kPart, threads, stop, [&](std::uint64_t k) {
    const std::uint64_t first = k * kPart, count = std::min(kPart, range.count - first);
    std::ranges::move(batch.surrogate->machines(batch.seed, range.first + first, count),
                      values.begin() + static_cast<std::ptrdiff_t>(first));
  });
  return values;
}

MachinePair pair_of(const Batch& batch, std::uint64_t machine, const MachineOutcome& outcome,
                    const Surrogate::Values& values) {
  return {.machine = machine,
          .fate = outcome.fate,
          .passes = outcome.passes,
          .first_order = bins_of(values.before, values.after, batch.plan.limits),
          .exact = bins_of(outcome.before, outcome.after, batch.plan.limits)};
}

/// The power of two of machines with about so much work in all.
std::uint64_t chunk_of(double work_of_machine, std::uint64_t machines) {
  constexpr double kWork = 1e9;  // multiplications: a fifth of a second of one core
  constexpr std::uint64_t kMostChunks = std::uint64_t{1} << 16;
  const auto usual = static_cast<std::uint64_t>(std::max(kWork / work_of_machine, 1.0));
  return std::max(std::bit_floor(usual), std::bit_ceil((machines - 1) / kMostChunks + 1));
}

}  // namespace

Batch with_surrogate(Batch batch) {
  if (Surrogate::follows(batch.plan)) batch.surrogate = std::make_shared<const Surrogate>(batch.robot, batch.plan);
  return batch;
}

std::optional<Tally> to_first_order(const Batch& batch, MachineRange range, unsigned threads,
                                    const std::atomic<bool>& stop) {
  const std::vector<Surrogate::Values> values = first_order(batch, range, threads, stop);
  if (stop.load()) return std::nullopt;
  Tally tally;
  FirstOrderTally& sum = tally.first_order.emplace();
  sum.machines = range.count;
  for (const Surrogate::Values& one : values) {
    for (const ErrorKind kind : kErrorKinds) {
      sum.before[kind].add(one.before[kind]);
      sum.after[kind].add(one.after[kind]);
    }
    sum.used_up.add(used_up(one.after, batch.plan.limits));
  }
  return tally;
}

std::optional<Tally> exactly(const Batch& batch, MachineRange range, unsigned threads, const std::atomic<bool>& stop) {
  std::vector<MachineOutcome> outcomes(range.count);
  for_each_number(range.count, threads, stop, [&](std::uint64_t k) {
    outcomes[k] = produce(batch.robot, batch.plan, batch.seed, range.first + k);
  });
  if (stop.load()) return std::nullopt;
  Tally tally;
  if (!batch.surrogate) {
    for (const MachineOutcome& outcome : outcomes) tally.add(outcome);
    return tally;
  }
  const std::vector<Surrogate::Values> values = first_order(batch, range, threads, stop);
  if (stop.load()) return std::nullopt;
  for (std::uint64_t k = 0; k < range.count; ++k) tally.add(pair_of(batch, range.first + k, outcomes[k], values[k]));
  return tally;
}

ChunkSizes chunk_sizes(const Batch& batch, std::uint64_t machines) {
  constexpr double kOfAClosure = 30'000.0;  // multiplications of a matrix product that take as long as one pose
  constexpr double kOfAFit = 12.0;          // closures of each station: trials, Jacobians, outliers
  const ProductionPlan& plan = batch.plan;
  const double exact = kOfAClosure * (kOfAFit * static_cast<double>(plan.stations.size()) +
                                      2.0 * static_cast<double>(plan.validation.size()));
  if (!batch.surrogate) return {.exact = chunk_of(exact, machines)};
  return {.first_order = chunk_of(batch.surrogate->multiplications(), machines),
          .exact = std::min(chunk_of(exact, 1), kLargestExactChunk)};
}

std::uint64_t exact_round(std::uint64_t k) {
  constexpr std::uint64_t kFirst = 256;  // enough for the 95 % percentile, which 77 machines could not tell
  return (k % 2 == 0 ? kFirst : kFirst + kFirst / 2) << (k / 2);
}

double relative_interval(const Tally& tally, double confidence) {
  constexpr double kPercentile = 0.95;
  double largest = 0.0;
  for (const ErrorKind kind : kErrorKinds) {
    for (const bool after : {false, true}) {
      const ErrorSpread spread(tally, {.kind = kind, .after = after});
      const double percentile = spread.quantile(kPercentile);
      const Interval interval = spread.quantile_interval(kPercentile, confidence);
      largest = std::max(largest, 0.5 * (interval.high - interval.low) / percentile);
    }
  }
  return largest;
}

}  // namespace paracal
