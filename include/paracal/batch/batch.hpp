#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "paracal/batch/production.hpp"
#include "paracal/batch/tally.hpp"

namespace paracal {

class Surrogate;

/// Everything that decides what the machines of a batch are, and how they are computed.
struct Batch {
  Robot robot;
  ProductionPlan plan;  ///< settled()
  std::uint64_t seed = 1;
  std::shared_ptr<const Surrogate> surrogate = {};  ///< null: produce() makes every machine
};

/// The batch with all machines computed to first order, and the first of them exactly, too. A plan that calibrates
/// otherwise than to first order can be said stays as it is.
Batch with_surrogate(Batch batch);

/// Machines first, first + 1, ..., first + count - 1.
struct MachineRange {
  std::uint64_t first = 0, count = 0;
};

/// Some machines of a batch to first order. Memory depends on their count (about 100 bytes a machine), not on where
/// they stand.
/// @param threads  at most this many; 0: as many as there are cores. The result is the same for any number.
/// @param stop     may be set by another thread or a signal handler; the chunk is then dropped.
/// @returns empty when it was stopped.
std::optional<Tally> to_first_order(const Batch& batch, MachineRange range, unsigned threads,
                                    const std::atomic<bool>& stop);

/// Some machines by produce(); as pairs where the batch has a surrogate. Otherwise as above.
std::optional<Tally> exactly(const Batch& batch, MachineRange range, unsigned threads, const std::atomic<bool>& stop);

/// Machines a chunk: the power of two with about a fifth of a second of work, by counted multiplications, so that it is
/// the same on every computer. Larger where the batch would have more than 65,536 chunks.
struct ChunkSizes {
  std::uint64_t first_order = 0, exact = 0;
};
ChunkSizes chunk_sizes(const Batch& batch, std::uint64_t machines);

/// All rounds are whole chunks of this size, and of any power of two below.
inline constexpr std::uint64_t kLargestExactChunk = 128;

/// So many machines are computed exactly before the interval is looked at for the k-th time: 256, 384, 512, 768, ...
std::uint64_t exact_round(std::uint64_t k);

/// How far the 95 % percentiles of a tally are known: the largest half of an interval over its percentile, of all
/// errors before and after calibration. Infinite where one has no upper end.
double relative_interval(const Tally& tally, double confidence);

}  // namespace paracal
