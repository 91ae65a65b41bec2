#pragma once

// Private to calibration: numbers of the robot file are wrong.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dimensions.hpp"
#include "mistake.hpp"

namespace paracal::detail {

/// Numbers of the robot file that are wrong together, and what they should be.
struct Misprint {
  std::vector<Dimension> of;
  Eigen::VectorXd values;

  std::size_t count() const { return of.size(); }
  double value(std::size_t k) const { return values(static_cast<Eigen::Index>(k)); }
};

/// "the readings fit a robot whose rod_mm is 960.0, the file says 950". Undone with the joints as the controller
/// believed them, which the wrong numbers told it.
Mistake mistake_of(const Robot& given, const Misprint& misprint);

/// By how much twice the objective of a fit shrinks, to first order, where errors may have directions D in common at no
/// cost, and how much of each they then have. With L = diag(1 / sigma_j^2) and C the covariance after the fit,
///
///   amounts = (D^T (L - L C L) D)^-1 D^T L p,     gain = p^T L D amounts
///
/// Nothing where readings do not tell the directions from each other, or one from none.
struct CommonPart {
  Eigen::VectorXd amounts;
  double gain = 0.0;
};
CommonPart common_part(const TrialFit& fit, const std::vector<SourceErrors>& directions);

/// Single errors that would explain a fit, sought without their priors; best first.
std::vector<Mistake> wrong_parts(const TrialFit& fit);

/// Nominal dimensions that would explain the errors of a fit, best first: each read as "the readings fit a robot whose
/// rod_mm is 960, the file says 950", with the value that fits best and the joints as the controller believed them.
/// The numbers of the file: base_radius_mm, plate_radius_mm, arm_mm, rod_mm, limb_azimuth_deg of one limb,
/// pinion_radius_mm.
std::vector<Mistake> wrong_nominals(const Input& given, const TrialFit& fit);

/// The scale of the instrument, which no reading tells from a robot that is as much larger.
/// @returns empty where errors do not speak of one.
std::optional<Mistake> wrong_scale(const Input& given, const TrialFit& fit);

/// Two of the numbers that all limbs have in common: "the readings fit a robot whose rod_mm is 800.0 and arm_mm is
/// 330.0, the file says 780 and 320".
std::vector<Mistake> wrong_pairs(const Input& given, const TrialFit& fit);

}  // namespace paracal::detail
