#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "paracal/mechanism/source_errors.hpp"
#include "paracal/mechanism/tolerances.hpp"

namespace paracal {

class Robot;

/// Two independent standard normal numbers (Box and Muller): numbers 2 k and 2 k + 1 of a stream, computed directly.
std::array<double, 2> normal_pair(std::uint64_t seed, std::uint64_t stream, std::uint64_t k);

/// Counter-based random numbers: block k of a stream is Philox4x32-10 of (k, stream) under the key `seed`
/// [salmon2011]. Streams are independent and need no order, so machine 17 of a batch is always the same
/// machine.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}
  /// Returns these normal numbers, then zeros, for tests of their effect. It has no uniform() numbers.
  explicit RandomStream(std::vector<double> normals) : given_(std::move(normals)) {}

  /// In (0, 1).
  double uniform();
  /// Standard normal (Box and Muller).
  double normal();
  /// Number `number` of a new stream, computed directly.
  double normal_at(std::uint64_t number) const;
  /// Number of normal numbers used.
  std::uint64_t normals() const { return normals_; }

 private:
  std::uint64_t seed_ = 0, stream_ = 0, counter_ = 0, normals_ = 0;
  std::optional<std::vector<double>> given_ = {};
  std::array<double, 2> uniforms_{};
  int uniforms_left_ = 0;
  double spare_normal_ = 0.0;
  bool has_spare_ = false;
};

/// The geometric error for a standard normal number: the same quantile of the distribution in the tolerances,
/// mm or rad.
double source_error(const Tolerances& tolerances, Source source, double standard_normal);

/// A machine of a batch: independent errors, distributed as in the tolerances. Uses 14 normal numbers per limb of the
/// stream, whatever kind of limb it is; each error is drawn by its own number, Parameter::number.
SourceErrors draw_errors(const Robot& robot, const Tolerances& tolerances, RandomStream& random);

}  // namespace paracal
