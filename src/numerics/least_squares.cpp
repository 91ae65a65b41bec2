#include "paracal/numerics/least_squares.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "dense.hpp"

namespace paracal {
namespace {

Eigen::VectorXd column_lengths(const Eigen::MatrixXd& matrix) { return matrix.colwise().norm(); }

Eigen::VectorXd ones_for_zeros(const Eigen::VectorXd& values) { return (values.array() > 0.0).select(values, 1.0); }

/// The inverse of a triangular matrix that is certainly not singular: its condition number, |A| |A^-1|, stays below
/// 1 / tolerance. Empty otherwise.
Eigen::MatrixXd certain_inverse(const Eigen::MatrixXd& triangle, double tolerance) {
  if (triangle.rows() == 0 || !(triangle.diagonal().cwiseAbs().minCoeff() > 0.0)) return {};
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(triangle.rows(), triangle.cols());
  triangle.triangularView<Eigen::Upper>().solveInPlace(inverse);
  return inverse.norm() * triangle.norm() * tolerance < 1.0 ? inverse : Eigen::MatrixXd();
}

/// S = C^-1 (R C^-1)^+: of all steps that change the residuals alike the one of minimal length |C dp|, C: column
/// lengths.
Eigen::MatrixXd steps_of_changes(const Eigen::MatrixXd& root, double rank_tolerance) {
  const Eigen::VectorXd unscale = ones_for_zeros(column_lengths(root)).cwiseInverse();
  const Eigen::MatrixXd scaled = root * unscale.asDiagonal();
  const Eigen::MatrixXd inverse = certain_inverse(scaled, rank_tolerance);
  if (inverse.size() > 0) return unscale.asDiagonal() * inverse;
  return unscale.asDiagonal() * detail::pseudo_inverse(scaled, rank_tolerance);
}

/// Damped Gauss-Newton steps from one linearization.
class Steps {
 public:
  Steps(const InformationRoot& linear, Eigen::VectorXd damping_scale, double rank_tolerance)
      : root_(linear.root()),
        reachable_(linear.reachable()),
        step_of_change_(steps_of_changes(root_, rank_tolerance)),
        damping_scale_(std::move(damping_scale)) {}

  /// dp = S w with w = argmin |w + q|^2 + lambda |D S w|^2. In terms of the change w there is no direction that the
  /// rows do not see, and with it no singular matrix however small lambda is.
  Eigen::VectorXd step(double lambda) const {
    if (lambda == 0.0) return -step_of_change_ * reachable_;
    const Eigen::Index n = root_.cols();
    Eigen::MatrixXd rows(2 * n, n);
    rows << std::sqrt(lambda) * (damping_scale_.asDiagonal() * step_of_change_), Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd target(2 * n);
    target << Eigen::VectorXd::Zero(n), -reachable_;
    return step_of_change_ * detail::full_rank_solution(rows, target);
  }

  /// R dp of a step, by which the residuals change.
  Eigen::VectorXd change(const Eigen::VectorXd& step) const { return root_ * step; }

  /// How much |r|^2 shrinks over a step if the model is linear.
  double predicted_descent(const Eigen::VectorXd& step) const {
    return reachable_.squaredNorm() - (reachable_ + change(step)).squaredNorm();
  }

 private:
  Eigen::MatrixXd root_;
  Eigen::VectorXd reachable_;
  Eigen::MatrixXd step_of_change_;
  Eigen::VectorXd damping_scale_;
};

/// Levenberg's lambda and how fast it grows when steps fail.
struct Damping {
  static constexpr double kFirst = 1e-3, kLargest = 1e16;
  double lambda = 0.0;
  double growth = 2.0;

  void after_failure() {
    lambda = lambda == 0.0 ? kFirst : lambda * growth;
    growth *= 2.0;
  }
  /// A step that brings far less than it promised goes to and fro across the answer: the next is half as long.
  void after_success(double gain_ratio) {
    constexpr double kPoor = 0.25, kHalf = 1.0;
    if (gain_ratio < kPoor && lambda < kFirst) lambda = kHalf;
    lambda *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain_ratio - 1.0, 3));
    growth = 2.0;
  }
};

/// Near the answer a step of size e changes the cost by e^2, which drowns in rounding long before e does: smaller
/// shares of the cost than this one say nothing about a step.
constexpr double kRelativeRounding = 1e-9;

/// Raises lambda until the model can be evaluated and the residuals shrink.
bool descend(const RowModel& model, const Steps& steps, Damping& damping, LeastSquaresResult& result) {
  const double cost = result.at_answer.squared_residuals();
  const double noise = cost * kRelativeRounding;
  while (damping.lambda < Damping::kLargest) {
    const Eigen::VectorXd step = steps.step(damping.lambda);
    const Eigen::VectorXd trial = result.parameters + step;
    InformationRoot there(result.parameters.size());
    if (trial.allFinite() && model(trial, there) && there.squared_residuals() <= cost + noise) {
      const double predicted = steps.predicted_descent(step);
      const double descent = std::max(0.0, cost - there.squared_residuals());
      damping.after_success(predicted > noise ? std::min(1.0, descent / predicted) : 1.0);
      result.parameters = trial;
      result.at_answer = std::move(there);
      return true;
    }
    damping.after_failure();
  }
  return false;
}

std::atomic<std::uint64_t> solved = 0;

}  // namespace

std::uint64_t least_squares_solved() { return solved; }

LeastSquaresResult solve_least_squares(const RowModel& model, const Eigen::VectorXd& start,
                                       const LeastSquaresOptions& options) {
  ++solved;
  LeastSquaresResult result;
  result.parameters = start;
  result.at_answer = InformationRoot(start.size());
  if (!model(start, result.at_answer) || !std::isfinite(result.at_answer.squared_residuals())) return result;
  result.status = LeastSquaresStatus::not_converged;
  Damping damping{.lambda = options.initial_damping};
  Eigen::VectorXd longest = Eigen::VectorXd::Zero(start.size());
  constexpr int kMostHidden = 20;
  int hidden = 0;  // steps since rounding has hidden what they bring
  while (true) {
    const double cost = result.at_answer.squared_residuals();
    longest = longest.cwiseMax(column_lengths(result.at_answer.root()));
    const Steps steps(result.at_answer, ones_for_zeros(longest), options.rank_tolerance);
    const double change = steps.change(steps.step(0.0)).norm();
    hidden = change * change > cost * kRelativeRounding ? 0 : hidden + 1;
    if (change <= options.step_tolerance * (1.0 + std::sqrt(cost)) || hidden > kMostHidden) {
      result.status = LeastSquaresStatus::converged;
      return result;
    }
    if (result.iterations == options.max_iterations || !descend(model, steps, damping, result)) return result;
    ++result.iterations;
  }
}

}  // namespace paracal
