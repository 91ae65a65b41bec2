#include "paracal/tolerance/allocation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "cutting_planes.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/level.hpp"
#include "yield_allocation.hpp"

namespace paracal {
namespace {

using detail::Cut;
using detail::MasterSolution;
using detail::total_cost;
using detail::with;

constexpr double kViolation = 1e-6;  // of a limit
constexpr int kLargestRounds = 40;

bool any_grades(const AllocationProblem& problem) {
  return std::ranges::any_of(problem.variables, [](const auto& v) { return v.cost.law == CostLaw::grades; });
}

void check_curve(const DesignVariable& variable, const std::string& what) {
  const CostCurve& curve = variable.cost;
  const auto refuse = [&](const std::string& complaint) { throw InvalidArgument(what + ": " + complaint); };
  if (curve.law == CostLaw::grades) {
    if (curve.grades.empty()) refuse("expected at least one grade, got none");
    for (const Grade& grade : curve.grades) {
      const bool sensible = grade.tolerance > 0.0 && std::isfinite(grade.tolerance) && std::isfinite(grade.cost);
      if (!sensible) refuse(fmt::format("grade \"{}\": expected a tolerance above 0 and a finite cost", grade.name));
    }
    return;
  }
  if (!(curve.B > 0.0) || !(curve.C > 0.0))
    refuse(fmt::format("expected B and C above 0, got {} and {}", curve.B, curve.C));
  if (!(variable.lower > 0.0) || !(variable.upper >= variable.lower) || !std::isfinite(variable.upper)) {
    refuse(fmt::format("expected bounds 0 < lower <= upper, got {} and {}", variable.lower, variable.upper));
  }
}

void check_yield(const AllocationProblem& problem) {
  if (!(*problem.max_failures > 0.0) || !(*problem.max_failures < 0.5)) {
    throw InvalidArgument(
        fmt::format("largest failure rate: expected above 0 and below 0.5, got {}", *problem.max_failures));
  }
  if (any_grades(problem))
    throw InvalidArgument("yield: expected cost curves, got grades; grades need limits by another criterion");
  if (problem.rest.distribution != Distribution::normal) {
    throw InvalidArgument("yield: expected the normal distribution, got another one");
  }
}

void check(const AllocationProblem& problem) {
  if (problem.variables.empty()) throw InvalidArgument("allocation: expected a tolerance to choose, got none");
  if (problem.requirements.empty()) throw InvalidArgument("allocation: expected a requirement, got none");
  std::set<std::string_view> seen;
  for (const DesignVariable& variable : problem.variables) {
    if (variable.sources.empty())
      throw InvalidArgument("allocation: expected a source error for each variable, got none");
    const std::string what(name(variable.sources.front()));
    for (const Source source : variable.sources) {
      if (!seen.insert(source.name()).second)
        throw InvalidArgument(fmt::format("{}: expected one variable for it, got two", name(source)));
    }
    check_curve(variable, what);
  }
  const bool by_yield =
      std::ranges::any_of(problem.requirements, [](const Requirement& one) { return one.criterion == Spread::yield; });
  if (by_yield != problem.max_failures.has_value()) {
    throw InvalidArgument("allocation: expected a largest failure rate exactly if a limit is by yield");
  }
  if (by_yield) check_yield(problem);
  for (const Requirement& requirement : problem.requirements) {
    if (requirement.limit > 0.0 && std::isfinite(requirement.limit)) continue;
    throw InvalidArgument(
        fmt::format("{}: expected a limit above 0, got {}", name(requirement.characteristic), requirement.limit));
  }
}

/// d cost / d limit of a cut's requirement, per unit of its multiplier: its sides are divided by the limit (squared).
double limit_slope(const Requirement& requirement) {
  return (requirement.criterion == Spread::statistical ? 2.0 : 1.0) / requirement.limit;
}

class Allocator {
 public:
  Allocator(const Robot& robot, const AllocationProblem& problem) : robot_(robot), problem_(problem) {}

  Allocation run() {
    Eigen::VectorXd half_widths = widest();
    for (allocation_.rounds = 1; allocation_.rounds <= kLargestRounds; ++allocation_.rounds) {
      if (!add_cuts(half_widths)) return finished(half_widths);
      const MasterSolution solution =
          any_grades(problem_) ? solve_with_grades(problem_, cuts_) : solve_continuous(problem_, cuts_);
      allocation_.status = solution.status;
      if (solution.status == AllocationStatus::infeasible) return infeasible();
      if (solution.status == AllocationStatus::not_converged) break;
      half_widths = solution.half_widths;
    }
    allocation_.status = AllocationStatus::not_converged;
    allocation_.reason = "the solver did not converge";
    return finished(half_widths);
  }

 private:
  Eigen::VectorXd widest() {
    Eigen::VectorXd half_widths(static_cast<Eigen::Index>(problem_.variables.size()));
    for (std::size_t v = 0; v < problem_.variables.size(); ++v)
      half_widths(static_cast<Eigen::Index>(v)) = bound(v, true);
    allocation_.status = AllocationStatus::optimal;  // where even this holds everywhere
    return half_widths;
  }

  double bound(std::size_t v, bool upper) const {
    const DesignVariable& variable = problem_.variables[v];
    if (variable.cost.law != CostLaw::grades) return upper ? variable.upper : variable.lower;
    const auto [low, high] = std::ranges::minmax(variable.cost.grades, {}, &Grade::tolerance);
    return upper ? high.tolerance : low.tolerance;
  }

  /// Adds the worst pose of every requirement that is violated; false when none is.
  bool add_cuts(const Eigen::VectorXd& half_widths) {
    const Tolerances tolerances = with(problem_, half_widths);
    allocation_.requirements.clear();
    bool violated = false;
    for (std::size_t k = 0; k < problem_.requirements.size(); ++k) {
      const Requirement& requirement = problem_.requirements[k];
      const ValueAtPose worst = worst_spread(robot_, requirement.characteristic, tolerances, requirement.criterion);
      allocation_.requirements.push_back({requirement, worst, 0.0});
      if (worst.value <= requirement.limit * (1.0 + kViolation)) continue;
      cuts_.push_back(detail::cut_at(robot_, problem_, k, worst.pose, half_widths));
      violated = true;
    }
    return violated;
  }

  Allocation finished(const Eigen::VectorXd& half_widths) {
    allocation_.tolerances = with(problem_, half_widths);
    allocation_.cost = total_cost(problem_, half_widths, robot_.limb_count());
    if (allocation_.status == AllocationStatus::feasible) {
      allocation_.reason = "every limit is kept; a cheaper combination of grades may exist (not all were tried)";
    }
    const Eigen::VectorXd lambda = multipliers(problem_, cuts_, half_widths);
    for (std::size_t j = 0; j < cuts_.size(); ++j) {
      RequirementOutcome& outcome = allocation_.requirements[cuts_[j].requirement];
      outcome.price += lambda(static_cast<Eigen::Index>(j)) * limit_slope(outcome.requirement) *
                       static_cast<double>(robot_.limb_count());
    }
    return allocation_;
  }

  Allocation infeasible() {
    Eigen::VectorXd tightest(static_cast<Eigen::Index>(problem_.variables.size()));
    for (std::size_t v = 0; v < problem_.variables.size(); ++v)
      tightest(static_cast<Eigen::Index>(v)) = bound(v, false);
    add_cuts(tightest);
    allocation_.tolerances = with(problem_, tightest);
    allocation_.cost = total_cost(problem_, tightest, robot_.limb_count());
    for (const RequirementOutcome& outcome : allocation_.requirements) {
      const Requirement& requirement = outcome.requirement;
      if (outcome.worst.value <= requirement.limit) continue;
      allocation_.reason += fmt::format("{}{} is {:.4g} with the tightest tolerances, above its limit {:.4g}",
                                        allocation_.reason.empty() ? "" : "; ", name(requirement.characteristic),
                                        outcome.worst.value, requirement.limit);
    }
    if (allocation_.reason.empty()) allocation_.reason = "no combination of grades keeps every limit";
    return allocation_;
  }

  const Robot& robot_;
  const AllocationProblem& problem_;
  std::vector<Cut> cuts_;
  Allocation allocation_;
};

Allocation allocate_by_spread(const Robot& robot, const AllocationProblem& problem) {
  return Allocator(robot, problem).run();
}

/// The tilt group of these half-widths, mm and rad, beside the rest.
Tolerances with_tilt_group(Tolerances rest, const PerSource& half_widths) {
  rest.distribution = Distribution::normal;
  for (const Source source : all_sources()) {
    if (tilts_plate(source)) rest.state(source, half_widths(place(source)));
  }
  return rest;
}

/// 3 over the tolerance, the mean over the tilt group.
double mean_cost(const PerSource& tolerances) {
  double sum = 0.0;
  for (const Source source : all_sources()) sum += tilts_plate(source) ? 3.0 / tolerances(place(source)) : 0.0;
  return sum / ErrorModel::kTilt;
}

/// Means good to half a percent: the search for the worst pose is no better, and a slider can be dragged.
constexpr GlobalSensitivityOptions kQuick{.relative_error = 5e-3, .max_level = 2};

/// @param tightest  tolerance, in the paper's units.
void check_least(const EqualInfluence& problem, double tightest, Allocation& allocation) {
  const bool of_sigma = problem.least_reading == LeastReading::sigma;
  const double reached = of_sigma ? tightest / 3.0 : tightest;
  if (!problem.least || reached >= *problem.least) return;
  allocation.status = AllocationStatus::infeasible;
  allocation.reason = fmt::format("the tightest {} would be {:.3g} rad, below the manufacturing limit of {:.3g} rad",
                                  of_sigma ? "sigma" : "tolerance", reached, *problem.least);
}

/// Means and maxima of the local sensitivities, as a bound takes them.
GlobalSensitivity sensitivity_for(Bound bound, const Robot& robot, Characteristic tilt) {
  if (bound == Bound::sum_of_maxima) return mean_sensitivity(robot, tilt, cartesian_grid(robot));
  if (bound == Bound::true_maximum) return global_sensitivity(robot, tilt, kQuick);
  GlobalSensitivity global = global_sensitivity(robot, tilt);
  std::vector<WeightedPose> surface;  // where the maxima are, and no point of the rule
  for (const Pose& pose : polar_grid(robot, {}, false)) surface.push_back({pose, 1.0});
  global.largest = global.largest.max(mean_sensitivity(robot, tilt, surface).largest);
  return global;
}

}  // namespace

std::string_view name(AllocationStatus status) {
  switch (status) {
    case AllocationStatus::optimal:
      return "optimal";
    case AllocationStatus::feasible:
      return "feasible";
    case AllocationStatus::infeasible:
      return "infeasible";
    case AllocationStatus::not_converged:
      return "not converged";
  }
  return "";
}

Allocation allocate(const Robot& robot, const EqualInfluence& problem) {
  check_level(robot, "tolerances of equal influence");
  if (!(problem.max_tilt > 0.0) || !std::isfinite(problem.max_tilt)) {
    throw InvalidArgument(fmt::format("largest tilt: expected a number above 0 rad, got {}", problem.max_tilt));
  }
  const Characteristic tilt{Quantity::tilt};
  const GlobalSensitivity global = sensitivity_for(problem.bound, robot, tilt);
  const PerSource units = paper_units(robot), mean = global.mean * units;
  // Half-widths of equal influence in the paper's units, the tightest 1; of the tilt group (nothing else tilts).
  const PerSource ratio = mean.maxCoeff() / mean;
  const Tolerances at_one = with_tilt_group(problem.rest, ratio * units);
  ValueAtPose worst = worst_spread(robot, tilt, at_one, Spread::statistical);
  const double tilt_at_one =
      problem.bound == Bound::true_maximum ? worst.value : 3.0 * sigma_of(global.largest.square(), variances(at_one));
  const double tightest = problem.max_tilt / tilt_at_one;  // tilt grows in proportion
  worst.value *= tightest;
  Allocation allocation{.status = AllocationStatus::optimal, .rounds = 1};
  allocation.tolerances = with_tilt_group(problem.rest, tightest * ratio * units);
  list_assumed(allocation.tolerances, robot.limbs());
  allocation.cost = mean_cost(tightest * ratio);
  // The cost goes with one over the limit.
  allocation.requirements = {{{tilt, problem.max_tilt}, worst, allocation.cost / problem.max_tilt}};
  check_least(problem, tightest, allocation);
  return allocation;
}

Allocation allocate(const Robot& robot, const AllocationProblem& problem) {
  check(problem);
  Allocation allocation =
      problem.max_failures ? detail::allocate_by_yield(robot, problem) : allocate_by_spread(robot, problem);
  list_assumed(allocation.tolerances, robot.limbs());
  return allocation;
}

}  // namespace paracal
