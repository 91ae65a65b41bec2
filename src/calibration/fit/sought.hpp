#pragma once

// Private to calibration: which source errors a fit seeks, and what is known of them beforehand.

#include "paracal/calibration/calibration.hpp"

namespace paracal::detail {

/// The same source error of the same limb, whatever its prior.
inline bool is_same_error(const SoughtSource& one, const SoughtSource& other) {
  return one.limb == other.limb && one.source == other.source;
}

/// The encoder offsets of all limbs that are not held fixed, without priors.
std::vector<SoughtSource> encoder_offsets(const Robot& robot, const CalibrationOptions& options);

/// The position group without priors.
std::vector<SoughtSource> position_group(const Robot& robot, const CalibrationOptions& options);

/// What the paper's fine calibration seeks: the position group, for four limbs without the six errors that
/// [huang2016, Eq. (15)] sets to zero to hold the frame (e_x2, e_z2, e_z3, e_x4, e_y4, e_z4). The paper has no such
/// list for other robots; there the pseudo-inverse holds the frame alone.
std::vector<SoughtSource> paper_columns(const Robot& robot, const CalibrationOptions& options);

/// All source errors that are neither held fixed nor exact by their tolerance, with the tolerance as prior. The tilt
/// group among them is the model noise G_de dp_e of [huang2016, Eq. (14)] with covariance G_de Sigma G_de^T: seeking it
/// under its prior and leaving it out under that covariance are the same.
std::vector<SoughtSource> all_with_priors(const Robot& robot, const CalibrationOptions& options);

/// diag(prior^2) with what common errors correlate.
/// @param factors  by which the priors are larger than they were given.
Eigen::MatrixXd prior_covariance(const std::vector<SoughtSource>& errors, const std::vector<CommonError>& common,
                                 const Eigen::VectorXd& factors);

}  // namespace paracal::detail
