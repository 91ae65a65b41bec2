#include "paracal/batch/batch.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <vector>

namespace paracal {
namespace {

/// More than there are cores would wait for one another.
int arena_size(unsigned threads) {
  const int cores = tbb::this_task_arena::max_concurrency();
  return threads == 0 ? cores : static_cast<int>(std::min(threads, static_cast<unsigned>(cores)));
}

}  // namespace

std::optional<Tally> run_chunk(const Batch& batch, MachineRange range, unsigned threads,
                               const std::atomic<bool>& stop) {
  std::vector<MachineOutcome> outcomes(range.count);
  tbb::task_arena arena(arena_size(threads));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, outcomes.size(), [&](std::size_t k) {
      if (stop.load(std::memory_order_relaxed)) return;
      outcomes[k] = produce(batch.robot, batch.plan, batch.seed, range.first + k);
    });
  });
  if (stop.load()) return std::nullopt;
  Tally tally;
  for (const MachineOutcome& outcome : outcomes) tally.add(outcome);
  return tally;
}

}  // namespace paracal
