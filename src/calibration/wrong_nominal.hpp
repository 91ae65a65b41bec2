#pragma once

// Private to calibration: one number of the robot file is wrong.

#include <vector>

#include "mistakes.hpp"

namespace paracal::detail {

/// By how much twice the objective of a fit shrinks, to first order, where errors may have `direction` in common at no
/// cost, and how much of it they then have. With L = diag(1 / sigma_j^2) and C the covariance after the fit,
///
///   amount = d^T L p / (d^T (L - L C L) d),     gain = amount d^T L p
struct CommonPart {
  double amount = 0.0;
  double gain = 0.0;
};
CommonPart common_part(const TrialFit& fit, const SourceErrors& direction);

/// Single errors that would explain a fit, sought without their priors; best first.
std::vector<Mistake> wrong_parts(const TrialFit& fit);

/// Nominal dimensions that would explain the errors of a fit, best first: each read as "the readings fit a robot whose
/// rod_mm is 960, the file says 950", with the value that fits best and the joints as the controller believed them.
/// The numbers of the file: base_radius_mm, plate_radius_mm, arm_mm, rod_mm, limb_azimuth_deg of one limb,
/// pinion_radius_mm.
std::vector<Mistake> wrong_nominals(const Input& given, const TrialFit& fit);

}  // namespace paracal::detail
