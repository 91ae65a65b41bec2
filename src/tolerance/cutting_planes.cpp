#include "cutting_planes.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

constexpr double kBinds = 1e-6;       // of the limit
constexpr double kStationary = 1e-6;  // of the cost
constexpr int kMostRounds = 20;

/// sigma of a source error over its half-width.
double sigma_share(const Tolerances& tolerances, Source source) {
  Tolerances one;
  one.distribution = tolerances.distribution;
  one[source] = 1.0;
  return one.std(source);
}

double slope_of(const AllocationProblem& problem, Eigen::Index variable, double half_width) {
  return problem.variables[static_cast<std::size_t>(variable)].cost.slope(half_width);
}

bool at_bound(const DesignVariable& variable, double half_width, bool upper) {
  return std::abs(half_width / (upper ? variable.upper : variable.lower) - 1.0) <= 1e-9;
}

/// The widest feasible point on the way from all lower to all upper bounds; empty when even the lower bounds fail.
std::optional<std::vector<double>> feasible_start(const AllocationProblem& problem, const std::vector<Cut>& cuts) {
  const auto point = [&](double share) {
    std::vector<double> x;
    for (const DesignVariable& variable : problem.variables) {
      x.push_back(std::log(variable.lower) + share * std::log(variable.upper / variable.lower));
    }
    return x;
  };
  const auto holds = [&](double share) {
    const Eigen::VectorXd half_widths = half_widths_of(point(share));
    return std::ranges::all_of(cuts, [&](const Cut& cut) { return cut.value(half_widths) <= 1e-12; });
  };
  if (!holds(0.0)) return std::nullopt;
  if (holds(1.0)) return point(1.0);
  double low = 0.0, high = 1.0;
  for (int step = 0; step < 30; ++step) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return point(low);
}

/// min |A x - b| with x >= 0 for a handful of columns: columns that would be negative leave, the worst first.
Eigen::VectorXd non_negative(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(A.cols());
  std::vector<Eigen::Index> used;
  for (Eigen::Index k = 0; k < A.cols(); ++k) used.push_back(k);
  while (!used.empty()) {
    const Eigen::VectorXd part = least_squares(A(Eigen::all, used), b);
    Eigen::Index worst = 0;
    if (part.minCoeff(&worst) >= 0.0) {
      x(used) = part;
      break;
    }
    used.erase(used.begin() + worst);
  }
  return x;
}

}  // namespace

Eigen::VectorXd half_widths_of(const std::vector<double>& logarithms) {
  return Eigen::Map<const Eigen::VectorXd>(logarithms.data(), static_cast<Eigen::Index>(logarithms.size()))
      .array()
      .exp();
}

Objective cost_objective(const AllocationProblem& problem, double unit_cost) {
  return [&problem, unit_cost](const std::vector<double>& x, std::vector<double>& gradient) {
    const Eigen::VectorXd half_widths = half_widths_of(x);
    for (std::size_t v = 0; v < gradient.size(); ++v) {
      const auto i = static_cast<Eigen::Index>(v);
      gradient[v] = slope_of(problem, i, half_widths(i)) * half_widths(i) / unit_cost;
    }
    return total_cost(problem, half_widths, 1) / unit_cost;
  };
}

Objective cut_objective(const Cut& cut) {
  return [&cut](const std::vector<double>& x, std::vector<double>& gradient) {
    const Eigen::VectorXd half_widths = half_widths_of(x);
    for (std::size_t v = 0; v < gradient.size(); ++v) {
      const auto i = static_cast<Eigen::Index>(v);
      gradient[v] = cut.weight(i) * cut.h_slope(half_widths(i)) * half_widths(i);
    }
    return cut.value(half_widths);
  };
}

double Cut::value(const Eigen::VectorXd& tolerance) const {
  double sum = -room;
  for (Eigen::Index v = 0; v < weight.size(); ++v) sum += weight(v) * h(tolerance(v));
  return sum;
}

Tolerances with(const AllocationProblem& problem, const Eigen::VectorXd& half_widths) {
  Tolerances tolerances = problem.rest;
  for (std::size_t v = 0; v < problem.variables.size(); ++v) {
    for (const Source source : problem.variables[v].sources) {
      tolerances.state(source, half_widths(static_cast<Eigen::Index>(v)));
    }
  }
  return tolerances;
}

Cut cut_at(const Robot& robot, const AllocationProblem& problem, std::size_t requirement, const Pose& pose,
           const Eigen::VectorXd& at) {
  const Requirement& wanted = problem.requirements[requirement];
  const SourceRows rows = LinearModel(robot).rows(pose, wanted.characteristic);
  const bool statistical = wanted.criterion == Spread::statistical;
  const auto count = static_cast<Eigen::Index>(problem.variables.size());
  Cut cut{.requirement = requirement, .criterion = wanted.criterion, .weight = Eigen::VectorXd::Zero(count)};
  const PerSource weights =
      statistical ? PerSource(squared_sensitivities(robot, rows) * 9.0 / (wanted.limit * wanted.limit))
                  : PerSource(worst_case_weights(robot, rows, worst_case(robot, rows, with(problem, at)).direction) /
                              wanted.limit);
  const Tolerances fixed = with(problem, Eigen::VectorXd::Zero(count));
  for (const Source source : sources_of(robot.limbs())) {
    cut.room -= weights(place(source)) * (statistical ? std::pow(fixed.std(source), 2) : fixed.largest(source));
  }
  for (Eigen::Index v = 0; v < count; ++v) {
    for (const Source source : problem.variables[static_cast<std::size_t>(v)].sources) {
      const double share = statistical ? std::pow(sigma_share(problem.rest, source), 2) : 1.0;
      cut.weight(v) += share * weights(place(source));
    }
  }
  return cut;
}

double total_cost(const AllocationProblem& problem, const Eigen::VectorXd& half_widths, std::size_t limbs) {
  double sum = 0.0;
  for (std::size_t v = 0; v < problem.variables.size(); ++v) {
    const DesignVariable& variable = problem.variables[v];
    sum += variable.cost.cost(half_widths(static_cast<Eigen::Index>(v)));
  }
  return sum * static_cast<double>(limbs);
}

Eigen::VectorXd multipliers(const AllocationProblem& problem, const std::vector<Cut>& cuts,
                            const Eigen::VectorXd& half_widths) {
  std::vector<Eigen::Index> free, binding;
  for (Eigen::Index v = 0; v < half_widths.size(); ++v) {
    const DesignVariable& variable = problem.variables[static_cast<std::size_t>(v)];
    const bool inside = !at_bound(variable, half_widths(v), false) && !at_bound(variable, half_widths(v), true);
    if (variable.cost.law != CostLaw::grades && inside) free.push_back(v);
  }
  for (std::size_t j = 0; j < cuts.size(); ++j) {
    if (std::abs(cuts[j].value(half_widths)) <= kBinds) binding.push_back(static_cast<Eigen::Index>(j));
  }
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(cuts.size()));
  if (free.empty() || binding.empty()) return lambda;
  Eigen::MatrixXd A(free.size(), binding.size());
  Eigen::VectorXd b(free.size());
  for (Eigen::Index row = 0; row < A.rows(); ++row) {
    const Eigen::Index v = free[static_cast<std::size_t>(row)];
    b(row) = -slope_of(problem, v, half_widths(v)) * half_widths(v);
    for (Eigen::Index column = 0; column < A.cols(); ++column) {
      const Cut& cut = cuts[static_cast<std::size_t>(binding[static_cast<std::size_t>(column)])];
      A(row, column) = cut.weight(v) * cut.h_slope(half_widths(v)) * half_widths(v);
    }
  }
  lambda(binding) = non_negative(A, b);
  return lambda;
}

namespace {

/// What is left of the conditions for a minimum at an answer, as a share of the cost: variables that are not at a bound
/// have a gradient of cost and charged cuts, and those at an upper bound would like to grow.
double stationarity(const AllocationProblem& problem, const std::vector<Cut>& cuts,
                    const Eigen::VectorXd& half_widths) {
  const Eigen::VectorXd lambda = multipliers(problem, cuts, half_widths);
  double worst = 0.0, size = 0.0;
  for (Eigen::Index v = 0; v < half_widths.size(); ++v) {
    const DesignVariable& variable = problem.variables[static_cast<std::size_t>(v)];
    const double own = slope_of(problem, v, half_widths(v)) * half_widths(v);
    double gradient = own;
    for (std::size_t j = 0; j < cuts.size(); ++j) {
      gradient +=
          lambda(static_cast<Eigen::Index>(j)) * cuts[j].weight(v) * cuts[j].h_slope(half_widths(v)) * half_widths(v);
    }
    size += std::abs(own);
    const bool wants_beyond = (at_bound(variable, half_widths(v), true) && gradient <= 0.0) ||
                              (at_bound(variable, half_widths(v), false) && gradient >= 0.0);
    if (!wants_beyond) worst = std::max(worst, std::abs(gradient));
  }
  return size > 0.0 ? worst / size : 0.0;
}

}  // namespace

/// The problem is convex in the half-widths, so a stationary point of either is the answer.
MasterSolution solve_continuous(const AllocationProblem& problem, const std::vector<Cut>& cuts) {
  std::optional<std::vector<double>> start = feasible_start(problem, cuts);
  if (!start) return {AllocationStatus::infeasible, {}};
  const double unit_cost = std::max(std::abs(total_cost(problem, half_widths_of(*start), 1)), 1e-300);
  Minimization master{.objective = cost_objective(problem, unit_cost),
                      .lower = {},
                      .upper = {},
                      .step_tolerance = 1e-12,
                      .max_evaluations = 500};
  for (const DesignVariable& variable : problem.variables) {
    master.lower.push_back(std::log(variable.lower));
    master.upper.push_back(std::log(variable.upper));
  }
  for (const Cut& cut : cuts) master.constraints.push_back(cut_objective(cut));
  Eigen::VectorXd half_widths = half_widths_of(*start);
  // The solver may stop early, where its model of the curvature has gone bad; begun anew it goes on.
  for (int attempt = 0; attempt < kMostRounds && stationarity(problem, cuts, half_widths) > kStationary; ++attempt) {
    start = minimize(master, *start).x;
    half_widths = half_widths_of(*start);
  }
  const bool settled = stationarity(problem, cuts, half_widths) <= kStationary;
  return {settled ? AllocationStatus::optimal : AllocationStatus::not_converged, half_widths};
}

}  // namespace paracal::detail
