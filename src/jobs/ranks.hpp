#pragma once

// Private to the programs: the processes that compute a long job together.

#include <cstdint>
#include <functional>

#include "paracal/long_job.hpp"

namespace paracal::jobs {

class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual std::uint64_t number() const = 0;
  virtual std::uint64_t size() const = 0;
  /// All ranks begin a stage: take() counts from 0 again.
  virtual void begin() = 0;
  /// The next number that no rank has taken yet.
  virtual std::uint64_t take() = 0;
  /// Does work of this rank in such a way that others can take() meanwhile.
  virtual void work(const std::function<void()>& task) = 0;
  /// Whether it is true on every rank.
  virtual bool all(bool here) = 0;
  /// Every rank's total becomes that of all.
  virtual void add_up(JobStage& stage) = 0;
};

/// One process.
class Alone : public Ranks {
 public:
  std::uint64_t number() const override { return 0; }
  std::uint64_t size() const override { return 1; }
  void begin() override { next_ = 0; }
  std::uint64_t take() override { return next_++; }
  void work(const std::function<void()>& task) override { task(); }
  bool all(bool here) override { return here; }
  void add_up(JobStage& /*stage*/) override {}

 private:
  std::uint64_t next_ = 0;
};

}  // namespace paracal::jobs
