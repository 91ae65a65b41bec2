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

/// A share of machines from machines that were drawn with unequal chances.
struct WeighedShare {
  double value = 0.0;
  Interval interval = {};      ///< at the confidence asked for
  std::uint64_t machines = 0;  ///< drawn
  double effective = 0.0;      ///< (sum w)^2 / sum w^2 of those that fail: as many equal weights know it as well
};

/// How it came about.
enum class FailureStatus : std::uint8_t {
  settled,     ///< known as well as asked, and by two ways of drawing alike
  impossible,  ///< no machine within its drawings reaches a limit by the linear model: the share is zero
  unsettled,   ///< cannot be told: `reason` says why; do not use
};

/// Share of the machines that break a limit at some pose.
struct [[nodiscard]] FailureShare {
  FailureStatus status = FailureStatus::unsettled;
  std::string reason = {};
  WeighedShare linear = {};                ///< by the linear model
  WeighedShare check = {};                 ///< the same by another mixture, from other random numbers
  std::optional<WeighedShare> exact = {};  ///< by the exact model; empty where it was not asked for, or not settled
  std::uint64_t not_closed = 0;            ///< of the machines tried by the exact model; they count as failures

  /// By the exact model where that is known.
  const WeighedShare& best() const { return exact ? *exact : linear; }
};

struct FailureOptions {
  std::uint64_t seed = 1;
  double relative_error = 0.05;  ///< half-width of the interval over the share
  double confidence = 0.95;
  std::uint64_t max_machines = 2'000'000;  ///< by the linear model
  std::uint64_t max_exact = 20'000;        ///< by the exact model; 0: not asked for
  unsigned threads = 0;                    ///< 0: all
};

/// Shares down to 1e-9 and below from some ten thousand machines (importance sampling). Machines are drawn from a
/// mixture q of the drawings' law f tilted towards each way in which a limit may be broken (a requirement at a pose in
/// a direction n):
///
///   \f[ q(e) = a_0 f(e) + sum_j a_j f(e) exp(t_j . e - K(t_j)),    t_j = theta_j rows^T n / limit \f]
///
/// so that the mean of the j-th lies on its limit  [siegmund1976], and each counts w = f / q. The share is the mean of
/// w over the machines that fail. The mixture leaves out ways that are close to others; a second one, with all of them
/// and other random numbers, must agree within chance (0.001), and both must rest on at least 100 effective failures.
///
/// The share by the exact model is that of the linear one times the ratio of the weights of machines that fail by
/// either, from machines of the same drawing that come near a limit or beyond; how near is widened until what fails in
/// the outer half of that band no longer counts.
///
/// Deterministic: the same for any number of threads.
/// @param progress  as of monte_carlo().
/// @throws Unreachable, InvalidArgument as LinearModel::rows.
FailureShare failure_share(const Robot& robot, const Tolerances& tolerances,
                           const std::vector<Requirement>& requirements, const std::vector<Pose>& poses,
                           const FailureOptions& options = {}, const Progress& progress = {});

/// Share of the machines that keep all limits: by the failures where these are settled, else counted; also where
/// machines of the exact model were counted, and the failures are those of the linear one alone.
Proportion yield(const FailureShare& failures, const MonteCarlo& drawn, double confidence);

/// Whether yield() counts the machines that were drawn.
bool is_counted(const FailureShare& failures, const MonteCarlo& drawn);

/// The exact model tells the yield, or no machine within its drawings fails: else it is the linear model's, which
/// proves nothing of machines.
bool is_proven(const FailureShare& failures, const MonteCarlo& drawn);

/// "settled", "impossible", "unsettled".
std::string_view name(FailureStatus status);

}  // namespace paracal
