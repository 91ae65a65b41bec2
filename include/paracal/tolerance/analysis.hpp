#pragma once

#include <cstdint>
#include <vector>

#include "paracal/tolerance/monte_carlo.hpp"
#include "paracal/tolerance/requirement.hpp"

namespace paracal {

/// What tolerances do to one requirement, without drawing machines.
struct RequirementAnalysis {
  Requirement requirement;
  ValueAtPose worst_case;                 ///< every part at its worst, at the worst pose; mm or rad
  ValueAtPose three_sigma;                ///< root of the sum of squares at its worst pose
  std::vector<Contributor> contributors;  ///< to the variance there, largest first
};

std::vector<RequirementAnalysis> analyze(const Robot& robot, const Tolerances& tolerances,
                                         const std::vector<Requirement>& requirements);

/// Poses at which machines may break the limits: where 3 sigma is largest, and of surface_poses() those where it is at
/// least 0.8 of that for some requirement. (Where it is less, limits that are kept elsewhere are broken too rarely to
/// count.)
std::vector<Pose> judged_poses(const Robot& robot, const Tolerances& tolerances,
                               const std::vector<RequirementAnalysis>& analyses);

/// How far the linear model can be trusted: the tolerances times a factor, the same machines by both models.
struct LinearityPoint {
  double factor = 1.0;
  double difference = 0.0;  ///< root mean square of |exact - linear| over that of |linear|, all machines and poses
  std::uint64_t not_closed = 0;
};

std::vector<LinearityPoint> linearity(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic,
                                      const std::vector<Pose>& poses, const std::vector<double>& factors,
                                      int machines = 200, std::uint64_t seed = 1);

/// Share of the variance of a characteristic's length at a pose that a source error (of all limbs) explains by itself,
/// and with all its interactions  [martinez2011]:
///
///   \f[ S_k = corr(f(B), f(A_k)),    T_k = 1 - corr(f(A), f(A_k)) \f]
///
/// where A_k is A with the errors k of B, with intervals by Fisher's transformation of the correlation coefficient.
struct SobolIndex {
  Source source = Source::theta_offset;
  double first = 0.0, total = 0.0;
  Interval first_interval, total_interval;
};

struct SobolOptions {
  Model model = Model::exact;
  std::uint64_t seed = 1;
  int samples = 4096;  ///< machines A, and as many B; (number of sources + 2) evaluations each
  double confidence = 0.95;
  unsigned threads = 0;
};

/// Largest total index first; sources without a tolerance are left out.
/// @throws Unreachable when a drawn machine does not close.
std::vector<SobolIndex> sobol_indices(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic,
                                      const Pose& pose, const SobolOptions& options = {});

}  // namespace paracal
