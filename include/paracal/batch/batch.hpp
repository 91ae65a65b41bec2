#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "paracal/batch/production.hpp"
#include "paracal/batch/tally.hpp"

namespace paracal {

class Surrogate;

/// Everything that determines the machines of a batch and their computation.
struct Batch {
  Robot robot;
  ProductionPlan plan;  ///< settled()
  std::uint64_t seed = 1;
  std::shared_ptr<const Surrogate> surrogate = {};  ///< null: produce() computes every machine
};

/// The batch with all machines computed to first order, and the first of them also exactly. Plans whose calibration has
/// no first-order model are unchanged.
Batch with_surrogate(Batch batch);

/// Machines first, first + 1, ..., first + count - 1.
struct MachineRange {
  std::uint64_t first = 0, count = 0;
};

/// Some machines of a batch to first order. Memory depends on their count (about 100 bytes per machine), not on their
/// numbers.
/// @param threads  at most this many; 0: as many as there are cores. The result does not depend on it.
/// @param stop     may be set by another thread or a signal handler; the chunk is then dropped.
/// @returns empty when it was stopped.
std::optional<Tally> to_first_order(const Batch& batch, MachineRange range, unsigned threads,
                                    const std::atomic<bool>& stop);

/// Some machines by produce(); as pairs where the batch has a surrogate. Otherwise as above.
std::optional<Tally> exactly(const Batch& batch, MachineRange range, unsigned threads, const std::atomic<bool>& stop);

/// Machines per chunk: the power of two with about a fifth of a second of work, by counted multiplications, so that it
/// is the same on every computer. Larger if the batch would have more than 65,536 chunks.
struct ChunkSizes {
  std::uint64_t first_order = 0, exact = 0;
};
ChunkSizes chunk_sizes(const Batch& batch, std::uint64_t machines);

/// All rounds consist of whole chunks of this size, and of any smaller power of two.
inline constexpr std::uint64_t kLargestExactChunk = 128;

/// Number of exact machines before the k-th test of the interval: 256, 384, 512, 768, ...
std::uint64_t exact_round(std::uint64_t k);

/// Relative uncertainty of the 95 % percentiles of a tally: the largest half-width of an interval divided by its
/// percentile, over all errors before and after calibration. Infinite if one has no upper end.
double relative_interval(const Tally& tally, double confidence);

}  // namespace paracal
