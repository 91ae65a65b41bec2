#pragma once

// Private to the programs: a batch of machines as a long job.

#include <atomic>
#include <cstdint>

#include "paracal/batch/batch.hpp"
#include "paracal/io/json.hpp"
#include "paracal/long_job.hpp"

namespace paracal::jobs {

struct BatchJobOptions {
  std::uint64_t machines = 0;
  double interval = 0.02;         ///< relative_interval() that ends the exact rounds ...
  double confidence = 0.95;       ///< ... at this confidence
  std::uint64_t least_exact = 0;  ///< machines that they go on to anyway
  unsigned threads = 0;           ///< of this process; 0: as many as there are cores
};

struct BatchResult {
  Tally tally;
  bool complete = false;  ///< false: stopped, or of some parts; `tally` then has the chunks that were computed
};

/// Everything that decides what the chunks of a batch hold, as Checkpoint wants it.
/// @param sizes  of chunks, which a folder may have begun with others of
io::Json description(const Batch& batch, ChunkSizes sizes);

/// Of a batch with a surrogate, whatever its interval: at least one in sixteen, up to where the 99.9 % percentile gets
/// an upper end; at most all of a small batch, half of a larger one. Whole chunks of any size, so that these leave no
/// trace.
struct ExactMachines {
  std::uint64_t fewest = 0, most = 0;
};
ExactMachines exact_machines(std::uint64_t machines);

/// Machines 0 ... machines - 1 to first order, and the first of them exactly, in rounds (exact_round()) until the
/// interval is reached or there are enough (exact_machines()); all of them exactly where the batch has no surrogate.
/// @param stop  may be set by another thread or a signal handler.
BatchResult run_batch(const Batch& batch, const BatchJobOptions& options, ChunkSizes sizes, LongJob& job,
                      const std::atomic<bool>& stop);

/// The chunk sizes of a description.
ChunkSizes chunk_sizes(const io::Json& description);

}  // namespace paracal::jobs
