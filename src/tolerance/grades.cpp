#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "cutting_planes.hpp"
#include "optimizer.hpp"
#include "paracal/interruption.hpp"

// Branch and bound over processes. For any multipliers lambda >= 0 of the cuts, no choice is cheaper than
//
//   sum_v min over T_v of [cost_v(T_v) + sum_j lambda_j weight_jv h_j(T_v)]  -  sum_j lambda_j room_j,
//
// which falls apart into one small problem a variable. The multipliers that make it largest are found once.

namespace paracal::detail {
namespace {

constexpr long kLargestNodes = 2'000'000;

bool is_graded(const DesignVariable& variable) { return variable.cost.law == CostLaw::grades; }

/// Smallest value over [low, high] of a function with one minimum, where its slope changes sign.
template <typename Slope>
double where_slope_vanishes(double low, double high, Slope&& slope) {
  if (slope(low) >= 0.0) return low;
  if (slope(high) <= 0.0) return high;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (slope(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

class GradeSearch {
 public:
  GradeSearch(const AllocationProblem& problem, const std::vector<Cut>& cuts) : problem_(problem), cuts_(cuts) {
    for (Eigen::Index v = 0; v < count(); ++v) {
      if (is_graded(variable(v))) graded_.push_back(v);
    }
    best_multipliers();
    order();
  }

  MasterSolution solve() {
    half_widths_ = tightest();
    best_cost_ = std::numeric_limits<double>::infinity();
    descend(0, 0.0);
    if (nodes_ > kLargestNodes) all_tried_ = false;
    if (best_.size() == 0) return {all_tried_ ? AllocationStatus::infeasible : AllocationStatus::not_converged, {}};
    return {all_tried_ ? AllocationStatus::optimal : AllocationStatus::feasible, best_};
  }

 private:
  Eigen::Index count() const { return static_cast<Eigen::Index>(problem_.variables.size()); }
  const DesignVariable& variable(Eigen::Index v) const { return problem_.variables[static_cast<std::size_t>(v)]; }

  Eigen::VectorXd tightest() const {
    Eigen::VectorXd half_widths(count());
    for (Eigen::Index v = 0; v < count(); ++v) {
      half_widths(v) = variable(v).lower;
      if (is_graded(variable(v))) {
        half_widths(v) = std::ranges::min(variable(v).cost.grades, {}, &Grade::tolerance).tolerance;
      }
    }
    return half_widths;
  }

  /// cost_v(T) + sum_j lambda_j weight_jv h_j(T)
  double charged(Eigen::Index v, double tolerance, double cost, const std::vector<double>& lambda) const {
    for (std::size_t j = 0; j < cuts_.size(); ++j) cost += lambda[j] * cuts_[j].weight(v) * cuts_[j].h(tolerance);
    return cost;
  }

  double cheapest_charged(Eigen::Index v, const std::vector<double>& lambda) const {
    const CostCurve& curve = variable(v).cost;
    if (is_graded(variable(v))) {
      double cheapest = std::numeric_limits<double>::infinity();
      for (const Grade& grade : curve.grades) {
        cheapest = std::min(cheapest, charged(v, grade.tolerance, grade.cost, lambda));
      }
      return cheapest;
    }
    const double at = where_slope_vanishes(variable(v).lower, variable(v).upper, [&](double tolerance) {
      double slope = curve.slope(tolerance);
      for (std::size_t j = 0; j < cuts_.size(); ++j)
        slope += lambda[j] * cuts_[j].weight(v) * cuts_[j].h_slope(tolerance);
      return slope;
    });
    return charged(v, at, curve.cost(at), lambda);
  }

  double dual(const std::vector<double>& lambda) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < cuts_.size(); ++j) sum -= lambda[j] * cuts_[j].room;
    for (Eigen::Index v = 0; v < count(); ++v) sum += cheapest_charged(v, lambda);
    return sum;
  }

  /// Multipliers that make the bound largest: any would be valid, these prune most.
  void best_multipliers() {
    lambda_.assign(cuts_.size(), 0.0);
    if (cuts_.empty()) return;
    double unit = 0.0;
    for (Eigen::Index v = 0; v < count(); ++v) unit += std::abs(variable(v).cost.cost(tightest()(v)));
    unit = std::max(unit, 1e-300);
    const auto scaled = [unit](std::vector<double> x) {
      for (double& value : x) value *= unit;
      return x;
    };
    const Minimization search{
        .algorithm = Minimization::Algorithm::subplex,
        .objective = [&](const std::vector<double>& x, std::vector<double>&) { return -dual(scaled(x)) / unit; },
        .lower = std::vector<double>(cuts_.size(), 0.0),
        .upper = std::vector<double>(cuts_.size(), 1e6),
        .first_step = std::vector<double>(cuts_.size(), 0.1),
        .step_tolerance = 1e-6,
        .max_evaluations = 4000};
    lambda_ = scaled(minimize(search, std::vector<double>(cuts_.size(), 0.05)).x);
    for (double& value : lambda_) value = std::max(value, 0.0);
  }

  /// Variables whose choice matters most come first; bound_[d] is what those from depth d on cost at least, charged.
  void order() {
    const auto span = [&](Eigen::Index v) {
      const auto [low, high] = std::ranges::minmax(variable(v).cost.grades, {}, &Grade::cost);
      return high.cost - low.cost;
    };
    std::ranges::stable_sort(graded_, std::ranges::greater(), span);
    double rest = 0.0;
    for (std::size_t j = 0; j < cuts_.size(); ++j) rest -= lambda_[j] * cuts_[j].room;
    for (Eigen::Index v = 0; v < count(); ++v) {
      if (!is_graded(variable(v))) rest += cheapest_charged(v, lambda_);
    }
    bound_.assign(graded_.size() + 1, rest);
    for (std::size_t d = graded_.size(); d-- > 0;) bound_[d] = bound_[d + 1] + cheapest_charged(graded_[d], lambda_);
  }

  bool can_hold() const {
    return std::ranges::all_of(cuts_, [&](const Cut& cut) { return cut.value(half_widths_) <= 1e-9; });
  }

  /// @param charged_so_far  of the choices above.
  void descend(std::size_t depth, double charged_so_far) {
    let_interrupt();
    if (++nodes_ > kLargestNodes) return;
    if (charged_so_far + bound_[depth] >= best_cost_ - 1e-9 * std::abs(best_cost_) || !can_hold()) return;
    if (depth == graded_.size()) return finish();
    const Eigen::Index v = graded_[depth];
    std::vector<Grade> grades = variable(v).cost.grades;
    const auto price = [&](const Grade& grade) { return charged(v, grade.tolerance, grade.cost, lambda_); };
    std::ranges::stable_sort(grades, {}, price);
    const double kept = half_widths_(v);
    for (const Grade& grade : grades) {
      half_widths_(v) = grade.tolerance;
      descend(depth + 1, charged_so_far + price(grade));
    }
    half_widths_(v) = kept;
  }

  /// All grades are chosen: what is continuous is solved for, then the choice is compared with the best.
  void finish() {
    Eigen::VectorXd answer = half_widths_;
    if (graded_.size() < problem_.variables.size()) {
      AllocationProblem rest = problem_;
      for (const Eigen::Index v : graded_) {
        DesignVariable& fixed = rest.variables[static_cast<std::size_t>(v)];
        fixed.lower = fixed.upper = half_widths_(v);
        fixed.cost = {.law = CostLaw::reciprocal, .A = fixed.cost.cost(half_widths_(v)), .B = 0.0};
      }
      const MasterSolution solution = solve_continuous(rest, cuts_);
      if (solution.status == AllocationStatus::not_converged) all_tried_ = false;
      if (solution.status != AllocationStatus::optimal) return;
      answer = solution.half_widths;
      // To the bit: a grade costs what it costs only where its tolerance is as wide.
      for (const Eigen::Index v : graded_) answer(v) = half_widths_(v);
    }
    const double cost = total_cost(problem_, answer, 1);
    if (cost >= best_cost_) return;
    best_cost_ = cost;
    best_ = answer;
  }

  const AllocationProblem& problem_;
  const std::vector<Cut>& cuts_;
  std::vector<Eigen::Index> graded_;
  std::vector<double> lambda_, bound_;
  Eigen::VectorXd half_widths_, best_;
  double best_cost_ = 0.0;
  long nodes_ = 0;
  bool all_tried_ = true;  ///< or found dearer than the best without
};

}  // namespace

MasterSolution solve_with_grades(const AllocationProblem& problem, const std::vector<Cut>& cuts) {
  return GradeSearch(problem, cuts).solve();
}

}  // namespace paracal::detail
