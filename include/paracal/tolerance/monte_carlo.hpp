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
  double sigma_error = 0.01;  ///< stop when every sigma is known to this share ...
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

/// What a batch shows of one requirement.
struct RequirementStatistics {
  Requirement requirement;
  std::vector<SigmaAtPose> poses = {};
  std::size_t worst = 0;     ///< the pose of the largest sigma
  Histogram largest = {};    ///< over the machines: the largest value at any pose
  std::uint64_t passed = 0;  ///< machines that keep the limit at all poses

  const SigmaAtPose& at_worst() const { return poses[worst]; }
  /// (limit - mean) / (3 sigma) at the worst pose.
  double cpk() const;
};

struct [[nodiscard]] MonteCarlo {
  Model model = Model::linear;
  std::uint64_t machines = 0;
  bool converged = false;        ///< every sigma is known as well as asked
  std::uint64_t not_closed = 0;  ///< machines that do not close somewhere (exact model); they fail everything
  std::vector<RequirementStatistics> requirements = {};
  std::uint64_t passed = 0;  ///< machines that keep all limits

  /// Share of the machines that keep all limits.
  Proportion yield(double confidence = 0.95) const { return proportion(passed, machines, confidence); }
};

/// Called now and then with the machines done so far and those that the present spread asks for; false stops.
using Progress = std::function<bool(std::uint64_t done, std::uint64_t expected)>;

/// Draws machines until every sigma is known as well as asked: machine m is draw_errors() with stream m of the seed, so
/// the result does not depend on threads, and the linear and the exact model see the same machines.
///
/// The standard error of sigma^2 at a pose is that of the mean of |components|^2, whatever its distribution. Checked
/// after rounds whose size follows from the spread so far.
///
/// @param job  computes the machines of the exact model, chunk by chunk; else they are computed here.
/// @throws Unreachable, InvalidArgument as LinearModel::rows.
MonteCarlo monte_carlo(const Robot& robot, const Tolerances& tolerances, const std::vector<Requirement>& requirements,
                       const std::vector<Pose>& poses, const MonteCarloOptions& options = {},
                       const Progress& progress = {}, LongJob* job = nullptr);

}  // namespace paracal
