#pragma once

#include <Eigen/Core>
#include <vector>

#include "optimizer.hpp"
#include "paracal/tolerance/allocation.hpp"

namespace paracal::detail {

/// A requirement at one pose (and one direction), in terms of the half-widths T_v of the design variables:
///
///   g(T) = sum_v weight_v h(T_v) - room <= 0,   h(T) = T^2 (statistical) or T (worst case),
///
/// divided by the limit (squared), less what the fixed tolerances take.
struct Cut {
  std::size_t requirement = 0;
  Spread criterion = Spread::statistical;
  Eigen::VectorXd weight;
  double room = 1.0;

  double h(double tolerance) const { return criterion == Spread::statistical ? tolerance * tolerance : tolerance; }
  double h_slope(double tolerance) const { return criterion == Spread::statistical ? 2.0 * tolerance : 1.0; }
  double value(const Eigen::VectorXd& tolerance) const;
};

Tolerances with(const AllocationProblem& problem, const Eigen::VectorXd& half_widths);

/// The cut of a requirement at a pose, where `at` decides the worst direction.
Cut cut_at(const Robot& robot, const AllocationProblem& problem, std::size_t requirement, const Pose& pose,
           const Eigen::VectorXd& at);

/// Cost of all limbs' parts.
double total_cost(const AllocationProblem& problem, const Eigen::VectorXd& half_widths, std::size_t limbs);

/// The solvers see logarithms of half-widths: costs and cuts are then of one scale from the tightest to the widest.
Eigen::VectorXd half_widths_of(const std::vector<double>& logarithms);
/// Cost of one limb's parts over `unit_cost`, and a cut, as functions of these. `problem` and `cut` must outlive them.
Objective cost_objective(const AllocationProblem& problem, double unit_cost);
Objective cut_objective(const Cut& cut);

/// Answer to the problem with these cuts alone.
struct MasterSolution {
  AllocationStatus status = AllocationStatus::not_converged;
  Eigen::VectorXd half_widths;
};

/// Continuous variables by sequential quadratic programming; a variable with lower = upper stays.
MasterSolution solve_continuous(const AllocationProblem& problem, const std::vector<Cut>& cuts);

/// The same with grades: depth first, cheapest first, over the choices; a branch ends when even its Lagrangian bound is
/// dearer than the best found, or when it breaks a cut with everything else at its tightest.
MasterSolution solve_with_grades(const AllocationProblem& problem, const std::vector<Cut>& cuts);

/// Multipliers of the cuts at an answer: cost'_v + sum_j lambda_j g_j'_v = 0 where T_v is not at a bound, lambda >= 0.
/// Zero for all where every variable is a grade or at a bound.
Eigen::VectorXd multipliers(const AllocationProblem& problem, const std::vector<Cut>& cuts,
                            const Eigen::VectorXd& half_widths);

}  // namespace paracal::detail
