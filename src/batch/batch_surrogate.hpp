#pragma once

// Private to batch: which machines are made both ways.

#include <array>
#include <vector>

#include "paracal/batch/batch.hpp"
#include "surrogate.hpp"

namespace paracal {

/// Shares of the machines at which strata of an error end.
inline constexpr std::array kRanks{0.5, 0.9, 0.99, 0.999};

class BatchSurrogate {
 public:
  /// @throws as Surrogate.
  explicit BatchSurrogate(const Batch& batch);

  const Surrogate& surrogate() const { return surrogate_; }
  const std::vector<Accuracy>& strata() const { return strata_; }
  /// With which a machine is made both ways (with_surrogate()).
  double chance(std::uint64_t machine, const Accuracy& after) const;

 private:
  Surrogate surrogate_;
  std::vector<Accuracy> strata_;  ///< their upper ends, but for the last
};

}  // namespace paracal
