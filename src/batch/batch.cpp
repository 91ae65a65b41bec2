#include "paracal/batch/batch.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <vector>

namespace paracal {
namespace {

/// More than there are cores would wait for one another.
unsigned worker_count(unsigned threads) {
  const auto cores = static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
  return threads == 0 ? cores : std::min(threads, cores);
}

}  // namespace

std::optional<Tally> run_chunk(const Batch& batch, MachineRange range, unsigned threads,
                               const std::atomic<bool>& stop) {
  std::vector<MachineOutcome> outcomes(range.count);
  // As many tasks as workers, each taking the next machine: a limit on threads without an arena a chunk, of which TBB
  // keeps some memory for every one.
  std::atomic<std::uint64_t> next = 0;
  const auto work = [&](unsigned /*worker*/) {
    for (std::uint64_t k = next++; k < range.count && !stop.load(std::memory_order_relaxed); k = next++) {
      outcomes[k] = produce(batch.robot, batch.plan, batch.seed, range.first + k);
    }
  };
  tbb::parallel_for(0U, worker_count(threads), work, tbb::simple_partitioner());
  if (stop.load()) return std::nullopt;
  Tally tally;
  for (const MachineOutcome& outcome : outcomes) tally.add(outcome);
  return tally;
}

}  // namespace paracal
