#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paracal {

/// A stage of a long job: chunks that can be computed anywhere and in any order, and their sum, which does not depend
/// on the order, to the last bit. Both are JSON texts.
class JobStage {
 public:
  virtual ~JobStage() = default;

  /// Chunks first(), ..., last() - 1. Stages of one name share their chunks.
  virtual std::uint64_t first() const { return 0; }
  virtual std::uint64_t last() const = 0;
  /// File name of a chunk: letters, digits and hyphens.
  virtual std::string name_of(std::uint64_t chunk) const = 0;
  /// @returns empty when it was stopped.
  virtual std::optional<std::string> compute(std::uint64_t chunk) = 0;
  /// @throws std::exception for a text that is not a result of that chunk.
  virtual void check(std::uint64_t chunk, std::string_view result) const = 0;

  /// Adds the result of a chunk, or another total().
  virtual void add(std::string_view result) = 0;
  virtual std::string total() const = 0;
  virtual void clear() = 0;
};

/// Computes a long job stage by stage: in this process, on MPI ranks, or with a folder of finished chunks. All ranks
/// of a job run the same stages in the same order, and all get the same total.
class LongJob {
 public:
  virtual ~LongJob() = default;
  /// @param stage  is cleared, then contains the total of the computed chunks.
  /// @returns true if these are all chunks; false if it was stopped, or computes only a part.
  virtual bool run(JobStage& stage) = 0;
};

/// Computes a stage in this process, chunk by chunk, without storing chunks.
class JobInMemory : public LongJob {
 public:
  bool run(JobStage& stage) override;
};

/// A stage with the results of single chunks: JSON texts in the order of their numbers.
/// @param compute  of a chunk's number; empty when it was stopped
/// @param check    throws std::exception for a text that is no result of that chunk.
/// @returns empty unless all were computed.
std::optional<std::vector<std::string>> compute_each(
    LongJob& job, const std::string& name, std::uint64_t first, std::uint64_t last,
    const std::function<std::optional<std::string>(std::uint64_t)>& compute,
    const std::function<void(std::uint64_t, const std::string&)>& check);

}  // namespace paracal
