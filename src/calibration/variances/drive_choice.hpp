#pragma once

// Private to calibration: whether a machine is better predicted with the smooth errors of its drives.

#include <optional>

#include "variance_table.hpp"

namespace paracal::detail {

/// Omits the poses one by one. With z = P y, and P the inverse covariance of the readings but for what the set-up
/// takes up, the readings of pose k are
///
///   e_k = P_kk^-1 z_k
///
/// off from their prediction by all others, set-up included: no fit is repeated. Rigid: by variances of noise and parts
/// alone, at their own mode, as the fit has them.
/// @param noise_mm  with which readings entered.
/// @returns empty where drives gain nothing that stands out, poses are too few, or one of them alone holds the set-up.
std::optional<OmittedPoses> omitted_poses(const VarianceTable& table, const VarianceTable::Mode& mode, double noise_mm);

}  // namespace paracal::detail
