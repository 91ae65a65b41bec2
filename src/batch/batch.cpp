#include "paracal/batch/batch.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "batch_surrogate.hpp"
#include "numerics/distributions.hpp"
#include "paracal/mechanism/random.hpp"

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

std::optional<Tally> produce_all(const Batch& batch, MachineRange range, unsigned threads,
                                 const std::atomic<bool>& stop) {
  std::vector<MachineOutcome> outcomes(range.count);
  for_each_number(range.count, threads, stop, [&](std::uint64_t k) {
    outcomes[k] = produce(batch.robot, batch.plan, batch.seed, range.first + k);
  });
  if (stop.load()) return std::nullopt;
  Tally tally;
  for (const MachineOutcome& outcome : outcomes) tally.add(outcome);
  return tally;
}

/// A number in (0, 1) of a machine's stream, beyond those of its errors and readings.
double lot(std::uint64_t seed, std::uint64_t machine) {
  constexpr std::uint64_t kBlock = std::uint64_t{1} << 41;
  return detail::normal_probability(normal_pair(seed, machine, kBlock)[0]);
}

std::vector<Surrogate::Values> first_order(const Batch& batch, MachineRange range, unsigned threads,
                                           const std::atomic<bool>& stop) {
  constexpr std::uint64_t kPart = 256;
  std::vector<Surrogate::Values> values(range.count);
  for_each_number((range.count + kPart - 1) / kPart, threads, stop, [&](std::uint64_t k) {
    const std::uint64_t first = k * kPart, count = std::min(kPart, range.count - first);
    std::ranges::move(batch.surrogate->surrogate().machines(batch.seed, range.first + first, count),
                      values.begin() + static_cast<std::ptrdiff_t>(first));
  });
  return values;
}

MachinePair pair_of(const Batch& batch, std::uint64_t machine, double chance, const Surrogate::Values& values) {
  const auto& limits = batch.plan.limits;
  MachinePair pair{.machine = machine,
                   .chance = chance,
                   .outcome = produce(batch.robot, batch.plan, batch.seed, machine),
                   .first_order_before = values.before,
                   .first_order_after = values.after};
  pair.used_up = used_up(pair.outcome.after, limits);
  pair.first_order_used_up = used_up(values.after, limits);
  return pair;
}

std::optional<Tally> make_both_ways(const Batch& batch, MachineRange range, unsigned threads,
                                    const std::atomic<bool>& stop) {
  const std::vector<Surrogate::Values> values = first_order(batch, range, threads, stop);
  if (stop.load()) return std::nullopt;
  Tally tally;
  tally.surrogate.emplace().machines = range.count;
  std::vector<std::pair<std::uint64_t, double>> chosen;
  for (std::uint64_t k = 0; k < range.count; ++k) {
    for (const ErrorKind kind : kErrorKinds) {
      tally.surrogate->before[kind].add(values[k].before[kind]);
      tally.surrogate->after[kind].add(values[k].after[kind]);
    }
    tally.surrogate->used_up.add(used_up(values[k].after, batch.plan.limits));
    const double chance = batch.surrogate->chance(range.first + k, values[k].after);
    if (chance >= 1.0 || lot(batch.seed, range.first + k) < chance) chosen.emplace_back(k, chance);
  }
  std::vector<MachinePair>& pairs = tally.surrogate->pairs;
  pairs.resize(chosen.size());
  for_each_number(chosen.size(), threads, stop, [&](std::uint64_t k) {
    const auto [place, chance] = chosen[k];
    pairs[k] = pair_of(batch, range.first + place, chance, values[place]);
  });
  if (stop.load()) return std::nullopt;
  for (const MachinePair& pair : pairs) tally.add(pair.outcome);
  return tally;
}

}  // namespace

std::optional<Tally> run_chunk(const Batch& batch, MachineRange range, unsigned threads,
                               const std::atomic<bool>& stop) {
  return batch.surrogate ? make_both_ways(batch, range, threads, stop) : produce_all(batch, range, threads, stop);
}

}  // namespace paracal
