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
  optimal,        ///< every requirement holds, and no cheaper choice is known to exist
  feasible,       ///< every requirement holds; the search over grades ended before it could prove optimality
  infeasible,     ///< a requirement fails with every tolerance at its tightest
  not_converged,  ///< the solver did not settle; do not use
};

/// A requirement at the answer.
struct RequirementOutcome {
  Requirement requirement;
  ValueAtPose worst;   ///< 3 sigma, or worst case, where it is largest; mm or rad
  double price = 0.0;  ///< cost saved per mm or rad of a wider limit (Lagrange multiplier); 0 when it does not bind
};

struct [[nodiscard]] Allocation {
  AllocationStatus status = AllocationStatus::not_converged;
  std::string reason = {};  ///< why not optimal
  Tolerances tolerances = {};
  double cost = 0.0;
  std::vector<RequirementOutcome> requirements = {};
  int rounds = 0;                             ///< of adding worst poses, or of drawing machines
  std::optional<FailureShare> failures = {};  ///< of the limits with criterion `yield`
  /// Cost saved where twice as many machines might fail, to first order; 0 when that does not bind.
  double failure_price = 0.0;

  bool ok() const { return status == AllocationStatus::optimal || status == AllocationStatus::feasible; }
};

/// How [huang2016, Eq. (12)] reads "the largest sigma of tilt".
enum class Bound : std::uint8_t {
  sum_of_maxima,  ///< sqrt(sum_k max over poses of (mu_k sigma_k)^2), means and maxima over the Cartesian grid: it
                  ///< reproduces Table 2
  sum_by_volume,  ///< the same with means by quadrature over the volume, as [huang2016, section 3.1] writes them, and
                  ///< maxima over the whole workspace at phi = 0
  true_maximum,   ///< max over the workspace of sqrt(sum_k mu_k^2 sigma_k^2), means by quadrature: about 10 % wider
};

/// How the paper's lower bound 0.02/100 is meant; as a standard deviation it contradicts Table 2.
enum class LeastReading : std::uint8_t {
  tolerance,  ///< of T = 3 sigma
  sigma,      ///< of sigma
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
/// largest 3 sigma in the whole workspace, rotations included, whatever the bound says.
/// @throws InvalidArgument for a plate with six freedoms, which has no tilt group.
Allocation allocate(const Robot& robot, const EqualInfluence& problem);

/// A tolerance that the designer may choose; several sources (e_x, e_y, e_z) may share one.
struct DesignVariable {
  std::vector<Source> sources;
  CostCurve cost;
  double lower = 0.0, upper = 0.0;  ///< half-widths, mm or rad, above zero; not for grades
};

/// Minimise the sum of all limbs' costs so that every requirement holds everywhere in the workspace.
struct AllocationProblem {
  std::vector<DesignVariable> variables = {};
  Tolerances rest = {};  ///< of the sources that are not variables; its distribution holds for all
  std::vector<Requirement> requirements = {};
  /// Largest share of the machines that may break a limit with criterion `yield`, whichever; asked where there is one.
  std::optional<double> max_failures = {};
  /// Where machines are held against limits by yield, beside the worst poses.
  std::vector<Pose> poses = {};
};

/// Cutting planes: the requirements are imposed at their worst poses (and, for a worst case, worst directions) found so
/// far, the convex problem that results is solved (sequential quadratic programming; branch and bound over grades with
/// the Lagrangian's bound), and the poses that are now worst join, until nothing is violated by more than 1e-6.
///
/// With limits that a share of machines may break, P(T) <= p: machines that fail at half-widths T are drawn
/// (failure_share()), and count for others near by as
///
///   \f[ P(T') = mean(w \prod_k (T_k / T'_k) exp(z_k^2 / 2 (1 - (T_k / T'_k)^2))),    z_k = 3 e_k / T_k \f]
///
/// a smooth function of T' with its gradient, times what the exact model makes of it. The cheapest T' within a quarter
/// of T is drawn at next, until it stays. The upper end of the stated interval keeps p.
/// @throws InvalidArgument for bounds, costs or grades that make no sense; for grades, or errors that are not normal,
/// with a share.
Allocation allocate(const Robot& robot, const AllocationProblem& problem);

/// "optimal", "feasible", "infeasible", "not converged".
std::string_view name(AllocationStatus status);

}  // namespace paracal
