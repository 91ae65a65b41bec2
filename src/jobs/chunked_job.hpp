#pragma once

// Private to the programs: a long job on one or more processes, with or without a folder that keeps its chunks.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "checkpoint.hpp"
#include "paracal/long_job.hpp"
#include "ranks.hpp"

namespace paracal::jobs {

/// One of `count` parts that are computed by themselves, as by an array of jobs: every count-th chunk.
struct Part {
  std::uint64_t number = 0;  ///< from 0
  std::uint64_t count = 1;
};

struct ChunkedJobOptions {
  std::filesystem::path checkpoint = {};  ///< folder; empty: nothing is kept
  Part part = {};                         ///< more than one needs a checkpoint
  /// Called with the number of the stage (from 1), the chunks that were taken, and all chunks of the stage.
  std::function<void(std::uint64_t, std::uint64_t, std::uint64_t)> progress = {};
  std::function<void(const std::string&)> warning = {};  ///< told of damaged files that are computed again
};

/// Ranks take the next chunk as they come to it. What is in the folder is read instead of computed: a job that was
/// killed is resumed by repeating it, and a rank that dies costs its chunk.
class ChunkedJob : public LongJob {
 public:
  /// @param description  what decides the results (Checkpoint).
  ChunkedJob(Ranks& ranks, ChunkedJobOptions options, const io::Json& description);

  /// The description, with the sizes of chunks that the folder was begun with.
  const io::Json& agreed() const { return agreed_; }
  /// Missing because they are of other parts.
  std::uint64_t left_to_others() const { return left_to_others_; }

  bool run(JobStage& stage) override;

 private:
  /// Empty when it was stopped or is left to another part.
  std::optional<std::string> result_of(JobStage& stage, std::uint64_t chunk);
  std::optional<std::string> kept(const JobStage& stage, std::uint64_t chunk) const;

  Ranks& ranks_;
  ChunkedJobOptions options_;
  io::Json agreed_;
  std::optional<Checkpoint> checkpoint_;
  std::uint64_t left_to_others_ = 0;
  std::uint64_t stages_ = 0;  ///< begun
};

}  // namespace paracal::jobs
