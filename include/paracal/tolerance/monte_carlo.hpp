#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "paracal/long_job.hpp"
#include "paracal/mechanism/tolerances.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/tolerance/response.hpp"
#include "paracal/tolerance/statistics.hpp"

namespace paracal {

struct MonteCarloOptions {
  Model model = Model::linear;
  std::uint64_t seed = 1;
  double sigma_error = 0.01;  ///< stop when every sigma has this relative error ...
  double confidence = 0.95;   ///< ... at this confidence
  std::uint64_t max_machines = 1'000'000;
  unsigned threads = 0;  ///< 0: all
};

/// Standard deviation of a characteristic at one pose, as sigma of [huang2016, Eq. (11)]: root of the summed variances
/// of its components.
struct SigmaAtPose {
  Pose pose;
  double sigma = 0.0;
  double mean = 0.0;  ///< length of the mean vector
  Interval interval;  ///< of sigma
};

/// Results for one requirement.
struct RequirementStatistics {
  Requirement requirement;
  std::vector<SigmaAtPose> poses = {};
  std::size_t worst = 0;     ///< the pose of the largest sigma
  Histogram largest = {};    ///< largest value of each machine over the poses
  std::uint64_t passed = 0;  ///< machines that keep the limit at all poses

  const SigmaAtPose& at_worst() const { return poses[worst]; }
  /// (limit - mean) / (3 sigma) at the worst pose.
  double cpk() const;
};

struct [[nodiscard]] MonteCarlo {
  Model model = Model::linear;
  std::uint64_t machines = 0;
  bool converged = false;        ///< every sigma has the required accuracy
  std::uint64_t not_closed = 0;  ///< machines that cannot reach every pose (exact model); they fail
  std::vector<RequirementStatistics> requirements = {};
  std::uint64_t passed = 0;  ///< machines that keep all limits

  /// Fraction of the machines that keep all limits.
  Proportion yield(double confidence = 0.95) const { return proportion(passed, machines, confidence); }
};

/// Called regularly with the number of finished and of expected machines; return false to stop.
using Progress = std::function<bool(std::uint64_t done, std::uint64_t expected)>;

/// Simulates machines until every sigma is accurate enough. Machine m is draw_errors() with stream m of the seed.
/// The result does not depend on threads; the linear and the exact model use the same machines.
///
/// The standard error of sigma^2 at a pose is that of the mean of |components|^2, for any distribution. It is tested
/// after rounds whose size follows from the variance so far.
///
/// @param job  computes the machines of the exact model in chunks; default: in this process.
/// @throws Unreachable, InvalidArgument as LinearModel::rows.
MonteCarlo monte_carlo(const Robot& robot, const Tolerances& tolerances, const std::vector<Requirement>& requirements,
                       const std::vector<Pose>& poses, const MonteCarloOptions& options = {},
                       const Progress& progress = {}, LongJob* job = nullptr);

}  // namespace paracal
