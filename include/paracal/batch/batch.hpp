#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "paracal/batch/production.hpp"
#include "paracal/batch/tally.hpp"

namespace paracal {

class BatchSurrogate;

/// Everything that decides what the machines of a batch are, and how they are made.
struct Batch {
  Robot robot;
  ProductionPlan plan;  ///< settled()
  std::uint64_t seed = 1;
  std::shared_ptr<const BatchSurrogate> surrogate = {};  ///< null: produce() makes every machine
};

/// The batch with all machines made to first order and some of them both ways, so that each error's spread is known in
/// every part of it: of a machine m of stratum share s by an error after calibration (ranks 0.5, 0.9, 0.99, 0.999)
///
///   chance = 1 where m s < 100, else min(1, 0.1 / (s sqrt(m))); the largest of all errors' strata
///
/// whatever the number of machines, so that batches are resumed and extended. Where the strata lie is found from 4096
/// machines of other random numbers. A plan that calibrates otherwise than to first order can be said stays as it is.
Batch with_surrogate(Batch batch);

/// Where its strata lie: errors after calibration (mm and rad) at each of the ranks. Empty without a surrogate.
std::vector<Accuracy> strata(const Batch& batch);

/// Machines first, first + 1, ..., first + count - 1.
struct MachineRange {
  std::uint64_t first = 0, count = 0;
};

/// Produces some machines of a batch. Memory depends on their count (about 100 bytes a machine), not on where they
/// stand.
/// @param threads  at most this many; 0: as many as there are cores. The result is the same for any number.
/// @param stop     may be set by another thread or a signal handler; the chunk is then dropped.
/// @returns empty when it was stopped.
std::optional<Tally> run_chunk(const Batch& batch, MachineRange range, unsigned threads, const std::atomic<bool>& stop);

}  // namespace paracal
