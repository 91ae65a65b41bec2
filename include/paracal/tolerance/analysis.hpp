#pragma once

#include <cstdint>
#include <vector>

#include "paracal/tolerance/monte_carlo.hpp"
#include "paracal/tolerance/requirement.hpp"

namespace paracal {

/// Effect of tolerances on one requirement, without simulated machines.
struct RequirementAnalysis {
  Requirement requirement;
  ValueAtPose worst_case;                 ///< all parts at their limits, at the worst pose; mm or rad
  ValueAtPose three_sigma;                ///< root sum of squares, at its worst pose
  std::vector<Contributor> contributors;  ///< contributions to the variance there, largest first
};

std::vector<RequirementAnalysis> analyze(const Robot& robot, const Tolerances& tolerances,
                                         const std::vector<Requirement>& requirements);

/// Poses at which machines may break the limits: the pose of the largest 3 sigma, and those of surface_poses() with at
/// least 0.8 of it for some requirement. (At other poses machines break limits too rarely to
/// count.)
std::vector<Pose> judged_poses(const Robot& robot, const Tolerances& tolerances,
                               const std::vector<RequirementAnalysis>& analyses);

/// Accuracy of the linear model: both models with the same machines, and a factor on all tolerances.
struct LinearityPoint {
  double factor = 1.0;
  double difference = 0.0;  ///< root mean square of |exact - linear| over that of |linear|, all machines and poses
  std::uint64_t not_closed = 0;
};

std::vector<LinearityPoint> linearity(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic,
                                      const std::vector<Pose>& poses, const std::vector<double>& factors,
                                      int machines = 200, std::uint64_t seed = 1);

/// Sobol indices of a characteristic's length at a pose: contribution to variance of a geometric error (all limbs),
/// alone and with all its interactions  [martinez2011]:
///
///   \f[ S_k = corr(f(B), f(A_k)),    T_k = 1 - corr(f(A), f(A_k)) \f]
///
/// where A_k is A with the errors k of B. Intervals by Fisher's transformation of the correlation coefficient.
struct SobolIndex {
  Source source = "theta_offset";
  double first = 0.0, total = 0.0;
  Interval first_interval, total_interval;
};

struct SobolOptions {
  Model model = Model::exact;
  std::uint64_t seed = 1;
  int samples = 4096;  ///< number of machines A and of B; (number of errors + 2) evaluations each
  double confidence = 0.95;
  unsigned threads = 0;
};

/// Largest total index first; errors without a tolerance are omitted.
/// @throws Unreachable if a simulated machine cannot reach the pose.
std::vector<SobolIndex> sobol_indices(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic,
                                      const Pose& pose, const SobolOptions& options = {});

}  // namespace paracal
