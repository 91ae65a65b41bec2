#pragma once

// Private to tolerance: machines that count unequally, and what they add up to.

#include <tbb/task_arena.h>

#include <cstdint>
#include <optional>

#include "limits.hpp"
#include "paracal/tolerance/failure.hpp"

namespace paracal::detail {

/// Sums over machines with weights w: over those that fail by the linear model, by the exact one, by both.
struct Weights {
  std::uint64_t machines = 0, failures = 0, tried = 0, not_closed = 0;
  double linear = 0.0, linear_squares = 0.0;
  double exact = 0.0, exact_squares = 0.0, both_squares = 0.0;
  double outer = 0.0;  ///< of exact failures in the outer half of the band

  void add(const Weights& other);
  /// Standard deviation of the mean weight of linear failures, over it; infinite without any.
  double linear_error() const;
  /// The same of the ratio of the exact failures' sum to the linear ones'.
  double ratio_error() const;
};

/// Machines of one mixture, from stream `first_stream` on.
class WeighedSample {
 public:
  /// `limits` and `options` must outlive it.
  WeighedSample(const Limits& limits, TiltedMixture mixture, std::uint64_t first_stream, const FailureOptions& options);

  bool is_plain() const { return mixture_.is_plain(); }
  const Weights& sums() const { return sums_; }

  /// Machines until the share is known to this part of itself; false when it was stopped.
  bool draw(double relative_error, std::uint64_t most, const Progress& progress);

  /// The first of them once more, by both models where they come near a limit; empty when it was stopped.
  /// @param band  how near, as a share of it.
  std::optional<Weights> try_exactly(double band, double relative_error, const Progress& progress);

  struct Machines {
    Eigen::MatrixXd errors;           ///< a column a machine
    Eigen::ArrayXd weights, used_up;  ///< Limits::used_up
  };
  Machines machines(std::uint64_t first, std::uint64_t count) const;

 private:
  template <typename Error, typename Effort, typename Chunk>
  bool repeat(double relative_error, std::uint64_t most, const Progress& progress, Weights& sums, const Error& error,
              const Effort& effort, const Chunk& chunk);
  template <typename Chunk>
  void add_up(Weights& sums, std::uint64_t more, const Chunk& chunk);
  Weights linear_chunk(std::uint64_t first, std::uint64_t count) const;
  Weights exact_chunk(std::uint64_t first, std::uint64_t count, double band) const;

  const Limits& limits_;
  TiltedMixture mixture_;
  std::uint64_t first_stream_;
  const FailureOptions& options_;
  tbb::task_arena arena_;
  Weights sums_;
};

}  // namespace paracal::detail
