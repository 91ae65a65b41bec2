#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "paracal/batch/batch.hpp"

namespace paracal::io {

/// One of several processes that make the same batch. They share nothing but the checkpoint folder.
struct Rank {
  std::uint64_t number = 0;  ///< 0 ... size - 1
  std::uint64_t size = 1;
};

struct BatchOptions {
  std::uint64_t machines = 0;
  std::uint64_t chunk = 256;                             ///< machines that are lost when a process dies
  unsigned threads = 0;                                  ///< of this process; 0: as many as there are cores
  std::filesystem::path checkpoint = {};                 ///< folder; empty: nothing is kept
  Rank rank = {};                                        ///< more than one needs a checkpoint
  std::function<void(std::uint64_t)> progress = {};      ///< told how many machines there are, now and then
  std::function<void(const std::string&)> warning = {};  ///< told of damaged files that are made again
};

struct BatchResult {
  Tally tally;            ///< of rank 0; other ranks leave it empty
  bool complete = false;  ///< false: stopped; `tally` then has the chunks that were done
};

/// Makes machines 0 ... machines - 1 of a batch, chunk by chunk.
///
/// With a checkpoint, every chunk is a file, written whole or not at all, and what is there is not made again: a run
/// that was killed is resumed by repeating it, and one that was finished is extended by asking for more machines. Rank
/// r makes chunks r, r + size, ... first and then what is missing anywhere, so that a rank that dies costs its chunk
/// and not the run; two ranks may make the same chunk, to the same bytes. When nothing is missing, rank 0 adds up.
///
/// The folder's batch.json says what decides the result (to_json(Batch), chunk size), every chunk has the hash of it.
/// A damaged chunk is named (`warning`) and made again.
///
/// @param stop  may be set by another thread or a signal handler.
/// @throws InputFileError for a folder or chunk of another batch; Error when the folder cannot be written.
BatchResult run_batch(const Batch& batch, const BatchOptions& options, const std::atomic<bool>& stop);

}  // namespace paracal::io
