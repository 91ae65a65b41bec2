#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "paracal/mechanism/tolerances.hpp"
#include "paracal/tolerance/cost.hpp"
#include "paracal/tolerance/failure.hpp"
#include "paracal/tolerance/requirement.hpp"

namespace paracal {

enum class AllocationStatus : std::uint8_t {
  optimal,        ///< every requirement is met at the least cost
  feasible,       ///< every requirement is met; the search over grades ended without a proof of optimality
  infeasible,     ///< a requirement is not met even with the tightest tolerances
  not_converged,  ///< the solver did not converge; do not use
};

/// A requirement with the chosen tolerances.
struct RequirementOutcome {
  Requirement requirement;
  ValueAtPose worst;   ///< 3 sigma, or worst case, at the worst pose; mm or rad
  double price = 0.0;  ///< cost saved per mm or rad of a wider limit (Lagrange multiplier); 0 if not active
};

struct [[nodiscard]] Allocation {
  AllocationStatus status = AllocationStatus::not_converged;
  std::string reason = {};  ///< reason if not optimal
  Tolerances tolerances = {};
  double cost = 0.0;
  std::vector<RequirementOutcome> requirements = {};
  int rounds = 0;                             ///< iterations: added worst poses, or new simulated machines
  std::optional<FailureShare> failures = {};  ///< failure rate of the limits with criterion `yield`
  /// Cost saved by twice the failure rate, to first order; 0 if not active.
  double failure_price = 0.0;

  bool ok() const { return status == AllocationStatus::optimal || status == AllocationStatus::feasible; }
};

/// Interpretation of "the largest sigma of tilt" in [huang2016, Eq. (12)].
enum class Bound : std::uint8_t {
  sum_of_maxima,  ///< sqrt(sum_k max over poses of (mu_k sigma_k)^2), means and maxima over the Cartesian grid: it
                  ///< reproduces Table 2
  sum_by_volume,  ///< the same with means by quadrature over the volume, as [huang2016, section 3.1] writes them, and
                  ///< maxima over the whole workspace at phi = 0
  true_maximum,   ///< max over the workspace of sqrt(sum_k mu_k^2 sigma_k^2), means by quadrature: about 10 % wider
};

/// Meaning of the paper's lower bound 0.02/100; as a standard deviation it does not agree with Table 2.
enum class LeastReading : std::uint8_t {
  tolerance,  ///< bound of T = 3 sigma
  sigma,      ///< bound of sigma
};

/// The paper's problem of one variable  [huang2016, Eqs. (12), (13)]: tolerances of the tilt group in the ratio of
/// equal influence, mean mu_k sigma_k = const, as wide as the limit on tilt admits. The position group stays as in
/// `rest`.
struct EqualInfluence {
  double max_tilt = 1e-3;  ///< 3 sigma of tilt, rad
  Bound bound = Bound::sum_of_maxima;
  std::optional<double> least = {};  ///< of the tightest tolerance, in the paper's units (rad)
  LeastReading least_reading = LeastReading::tolerance;
  Tolerances rest = {};
};

/// Cost: mean of 1 / sigma_k in the paper's units, 1 / rad  [huang2016, Eq. (12) with w_k = 1/6]. `worst` is the
/// largest 3 sigma in the whole workspace, including rotations, for every `bound`.
/// @throws InvalidArgument for a plate with six degrees of freedom, which has no tilt group.
Allocation allocate(const Robot& robot, const EqualInfluence& problem);

/// A tolerance to be chosen; several geometric errors (e_x, e_y, e_z) may share one.
struct DesignVariable {
  std::vector<Source> sources;
  CostCurve cost;
  double lower = 0.0, upper = 0.0;  ///< half-widths, mm or rad, above zero; not for grades
};

/// Minimises the cost of all limbs subject to all requirements everywhere in the workspace.
struct AllocationProblem {
  std::vector<DesignVariable> variables = {};
  Tolerances rest = {};  ///< of the errors that are not variables; its distribution applies to all
  std::vector<Requirement> requirements = {};
  /// Largest failure rate with respect to all limits with criterion `yield`; required if there is one.
  std::optional<double> max_failures = {};
  /// Poses where limits by yield apply, in addition to the worst poses.
  std::vector<Pose> poses = {};
};

/// Cutting planes: each iteration solves the convex problem with the worst poses (worst case: and directions) so far.
/// It uses sequential quadratic programming, and branch and bound over grades with the Lagrangian's bound. Then it
/// adds the poses that are now worst, until no limit is exceeded by more than 1e-6.
///
/// With limits by yield, the failure rate is P(T) <= p. Importance sampling at half-widths T (failure_share()) gives
/// failed machines, which estimate the rate at half-widths T' near T:
///
///   \f[ P(T') = mean(w \prod_k (T_k / T'_k) exp(z_k^2 / 2 (1 - (T_k / T'_k)^2))),    z_k = 3 e_k / T_k \f]
///
/// This is a smooth function of T' with a gradient, times the correction by the exact model. The next T is the cheapest
/// T' within a quarter of T, until it converges. The upper end of the stated interval is at most p.
/// @throws InvalidArgument for invalid bounds, costs or grades; with limits by yield also for grades and for
/// distributions that are not normal.
Allocation allocate(const Robot& robot, const AllocationProblem& problem);

/// "optimal", "feasible", "infeasible", "not converged".
std::string_view name(AllocationStatus status);

}  // namespace paracal
