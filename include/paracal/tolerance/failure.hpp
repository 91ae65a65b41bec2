#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/mechanism/tolerances.hpp"
#include "paracal/tolerance/monte_carlo.hpp"
#include "paracal/tolerance/requirement.hpp"

namespace paracal {

/// A failure rate from importance sampling.
struct WeighedShare {
  double value = 0.0;
  Interval interval = {};      ///< at the required confidence
  std::uint64_t machines = 0;  ///< simulated
  double effective = 0.0;      ///< (sum w)^2 / sum w^2 of those that fail: equivalent number with equal weights
};

/// Status of a failure rate.
enum class FailureStatus : std::uint8_t {
  settled,     ///< accurate as required; two estimates agree
  impossible,  ///< linear model: no machine within its tolerances reaches a limit; the rate is zero
  unsettled,   ///< not estimated, see `reason`; do not use
};

/// Failure rate: probability that a machine breaks a limit at some pose.
struct [[nodiscard]] FailureShare {
  FailureStatus status = FailureStatus::unsettled;
  std::string reason = {};
  WeighedShare linear = {};                ///< linear model
  WeighedShare check = {};                 ///< second estimate: other mixture, other random numbers
  std::optional<WeighedShare> exact = {};  ///< exact model; empty if not requested or not settled
  std::uint64_t not_closed = 0;            ///< of the machines of the exact model; they are failures

  /// Exact model if known, else linear model.
  const WeighedShare& best() const { return exact ? *exact : linear; }
};

struct FailureOptions {
  std::uint64_t seed = 1;
  double relative_error = 0.05;  ///< half-width of the interval divided by the rate
  double confidence = 0.95;
  std::uint64_t max_machines = 2'000'000;  ///< of the linear model
  std::uint64_t max_exact = 20'000;        ///< of the exact model; 0: not used
  unsigned threads = 0;                    ///< 0: all
};

/// Failure rates down to 1e-9 and below from some ten thousand machines (importance sampling). The machines are from a
/// mixture q of the distribution f of the errors, tilted towards each failure mode (a requirement at a pose in
/// a direction n):
///
///   \f[ q(e) = a_0 f(e) + sum_j a_j f(e) exp(t_j . e - K(t_j)),    t_j = theta_j rows^T n / limit \f]
///
/// The mean of the j-th is on its limit  [siegmund1976]; each machine has the weight w = f / q. The failure rate is the
/// mean of w of failed machines. The mixture omits modes close to others. A second one, with all modes and other random
/// numbers, must agree (p-value above 0.001). Both need at least 100 effective failures.
///
/// The rate of the exact model is that of the linear model times the ratio of the weights of failed machines. The ratio
/// uses machines of the same sample that are near or beyond a limit. This band becomes wider until failures in
/// its outer half are negligible.
///
/// Deterministic: the same for any number of threads.
/// @param progress  as in monte_carlo().
/// @throws Unreachable, InvalidArgument as LinearModel::rows.
FailureShare failure_share(const Robot& robot, const Tolerances& tolerances,
                           const std::vector<Requirement>& requirements, const std::vector<Pose>& poses,
                           const FailureOptions& options = {}, const Progress& progress = {});

/// Yield: one minus the failure rate if it is settled; else counted machines. Machines of the exact model are also
/// counted if the failure rate is only that of the linear model.
Proportion yield(const FailureShare& failures, const MonteCarlo& drawn, double confidence);

/// Whether yield() counts the simulated machines.
bool is_counted(const FailureShare& failures, const MonteCarlo& drawn);

/// Whether the yield is from the exact model, or no machine within its tolerances can fail. A yield of the linear model
/// proves nothing.
bool is_proven(const FailureShare& failures, const MonteCarlo& drawn);

/// "settled", "impossible", "unsettled".
std::string_view name(FailureStatus status);

}  // namespace paracal
