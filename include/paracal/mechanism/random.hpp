#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "paracal/mechanism/source_errors.hpp"
#include "paracal/mechanism/tolerances.hpp"

namespace paracal {

/// Two independent standard normal numbers (Box and Muller): numbers 2 k and 2 k + 1 of a stream, by themselves.
std::array<double, 2> normal_pair(std::uint64_t seed, std::uint64_t stream, std::uint64_t k);

/// Counter-based random numbers: block k of a stream is Philox4x32-10 of (k, stream) under the key `seed`
/// [salmon2011]. Streams need no order and share nothing, so machine 17 of a batch is the same machine whoever draws
/// it.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}
  /// Of these normal numbers, then of zeros: to find out what is made of each. It has no uniform() ones.
  explicit RandomStream(std::vector<double> normals) : given_(std::move(normals)) {}

  /// In (0, 1).
  double uniform();
  /// Standard normal (Box and Muller).
  double normal();
  /// How many normal numbers were asked for.
  std::uint64_t normals() const { return normals_; }

 private:
  std::uint64_t seed_ = 0, stream_ = 0, counter_ = 0, normals_ = 0;
  std::optional<std::vector<double>> given_ = {};
  std::array<double, 2> uniforms_{};
  int uniforms_left_ = 0;
  double spare_normal_ = 0.0;
  bool has_spare_ = false;
};

/// The source error that a standard normal number stands for: the same quantile of the distribution that the tolerances
/// give the source, mm or rad.
double source_error(const Tolerances& tolerances, Source source, double standard_normal);

/// A machine out of a batch: every source error independent, spread as the tolerances say. Uses 14 normal numbers a
/// limb, source by source, whatever the tolerances: with a fresh stream, error k of limb i (from 0) is number 14 i + k
/// of the stream.
SourceErrors draw_errors(const Tolerances& tolerances, std::size_t limb_count, RandomStream& random);

}  // namespace paracal
