#pragma once

#include <array>
#include <cstdint>

#include "paracal/mechanism/source_errors.hpp"
#include "paracal/mechanism/tolerances.hpp"

namespace paracal {

/// Counter-based random numbers: draw k of a stream is Philox4x32-10 of (k, stream) under the key `seed`
/// [salmon2011]. Streams need no order and share nothing, so machine 17 of a batch is the same machine whoever draws
/// it.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}

  /// In (0, 1).
  double uniform();
  /// Standard normal (Box and Muller).
  double normal();

 private:
  std::uint64_t seed_, stream_, counter_ = 0;
  std::array<double, 2> uniforms_{};
  int uniforms_left_ = 0;
  double spare_normal_ = 0.0;
  bool has_spare_ = false;
};

/// A machine out of a batch: every source error independent, spread within its tolerance as the tolerances say.
SourceErrors draw_errors(const Tolerances& tolerances, std::size_t limb_count, RandomStream& random);

}  // namespace paracal
