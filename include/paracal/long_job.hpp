#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paracal {

/// A stage of a long job: chunks that can be computed anywhere and in any order, and what they add up to, the same to
/// the last bit however they are added. Both are JSON texts.
class JobStage {
 public:
  virtual ~JobStage() = default;

  /// Chunks first(), ..., last() - 1. Stages of one name share their chunks.
  virtual std::uint64_t first() const { return 0; }
  virtual std::uint64_t last() const = 0;
  /// What a chunk is kept under: letters, digits and hyphens.
  virtual std::string name_of(std::uint64_t chunk) const = 0;
  /// @returns empty when it was stopped.
  virtual std::optional<std::string> compute(std::uint64_t chunk) = 0;
  /// @throws std::exception for what is no result of that chunk.
  virtual void check(std::uint64_t chunk, std::string_view result) const = 0;

  /// Adds the result of a chunk, or another total().
  virtual void add(std::string_view result) = 0;
  virtual std::string total() const = 0;
  virtual void clear() = 0;
};

/// Computes a long job stage by stage: in this process, on the ranks of MPI, from a folder that keeps chunks. All ranks
/// of a job run the same stages in the same order, and each has the same total in the end.
class LongJob {
 public:
  virtual ~LongJob() = default;
  /// @param stage  cleared; then has the total of the chunks that were computed.
  /// @returns whether these are all: false when it was stopped, or where a part of the chunks was asked for.
  virtual bool run(JobStage& stage) = 0;
};

/// Computes a stage here, chunk after chunk, and keeps nothing.
class JobInMemory : public LongJob {
 public:
  bool run(JobStage& stage) override;
};

/// Chunks whose results are wanted one by one: JSON texts in the order of their numbers.
/// @param compute  of a chunk's number; empty when it was stopped
/// @returns empty unless all were computed.
std::optional<std::vector<std::string>> compute_each(
    LongJob& job, const std::string& name, std::uint64_t first, std::uint64_t last,
    const std::function<std::optional<std::string>(std::uint64_t)>& compute);

}  // namespace paracal
