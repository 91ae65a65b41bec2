#include "prior_promise.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

/// What an error that has no prior is taken to have: nothing that counts.
constexpr double kNoPrior = 1e4;  // standard deviations that the fit leaves it
/// Factors that are tried: 20 to a factor of ten, up to 1000.
constexpr int kSteps = 60;
constexpr double kStep = 1.122;

constexpr double kRounding = 1e-6;  // of a bound, whose condition is that of 1 - s at most

double factor_at(int step) { return std::pow(kStep, step); }

/// s of this factor.
double share_of(double factor) { return 1.0 - 1.0 / (factor * factor); }
double largest_share() { return share_of(factor_at(kSteps)); }

/// Drop at one factor.
double drop_at(const Eigen::VectorXd& squares, const Eigen::VectorXd& known, double s) {
  double drop = 0.0;
  for (Eigen::Index i = 0; i < squares.size(); ++i) {
    const double left = std::max(1.0 - s * known(i), 1.0 - s);  // known <= 1 but for rounding
    drop += s * squares(i) / left - std::log(left) + std::log(1.0 - s);
  }
  return drop;
}

}  // namespace

PriorPromise::Whitened PriorPromise::whitened(const Level& level, const Eigen::MatrixXd& prior) {
  const Eigen::LLT<Eigen::MatrixXd> root(prior);
  const Eigen::MatrixXd half = root.matrixL().solve(level.covariance);
  const SymmetricEigen axes = symmetric_eigen(root.matrixL().solve(half.transpose()));
  return {axes.values, axes.vectors.transpose() * root.matrixL().solve(level.errors), root.matrixL() * axes.vectors};
}

PriorPromise::PriorPromise(const StageFit& fit) {
  constexpr int kLevels = 9;  // variances down to 1e-8, standard deviations to 1e-4 of what they are
  const Observation& observation = fit.observation();
  const Eigen::Index n = observation.source_count();
  const Eigen::MatrixXd covariance = fit.covariance().bottomRightCorner(n, n);
  prior_ = observation.prior_covariance();
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!observation.sought()[static_cast<std::size_t>(k)].prior_std) {
      prior_(k, k) = kNoPrior * kNoPrior * covariance(k, k);
    }
  }
  levels_.push_back({0.0, fit.fit().parameters.tail(n), covariance});
  if (all_stated(observation)) return;
  const Whitened now = whitened(levels_.front(), prior_);
  for (int k = 1; k < kLevels; ++k) add_level(now, fit.scatter(), std::pow(0.1, k));
}

/// Least of (r + 2 g^T (p - z) + (p - z)^T A (p - z)) / variance + p^T p, where A = K^-1 - 1 is what readings tell and
/// g = -z, as z is the least for a variance of 1: along the axes of K one number after the other.
void PriorPromise::add_level(const Whitened& at, const Scatter& scatter, double variance) {
  constexpr double kTold = 1e-5;   // below it an error is not what readings say, but what an iteration leaves
  constexpr double kFewest = 3.0;  // degrees of freedom that tell the noise: errors must not take up all readings
  const Eigen::ArrayXd known = at.known.array().max(1e-12).min(1.0);
  const Eigen::ArrayXd told = 1.0 / known - 1.0;
  const Eigen::ArrayXd was = at.errors.array();
  const Eigen::ArrayXd moved = (told > kTold).select(was * (1.0 - variance) / (told + variance), 0.0);
  const double rows = scatter.redundancy + (1.0 - known).sum();
  if (rows - (told / (told + variance)).sum() < kFewest) return;
  const double left = scatter.sum + (told * moved.square() - 2.0 * was * moved).sum();
  if (left < 0.0) return;  // no linear model of these readings
  const Eigen::ArrayXd now = was + moved, information = told / variance + 1.0;
  const double objective = rows * std::log(variance) + left / variance - scatter.sum +
                           (now.square() - was.square() + (information * known).log()).sum();
  const double most = (now.square() / (1.0 - largest_share() / information)).sum();  // bound() of all errors
  if ((1.0 + kRounding) * most < objective) return;                                  // and of some it is smaller
  levels_.push_back(
      {objective, at.axes * now.matrix(), at.axes * information.inverse().matrix().asDiagonal() * at.axes.transpose()});
}

/// sum v_i^2 / (1 - s k_i) = p^T (P - s C)^-1 p for the largest s: the logarithms add nothing to it. One Cholesky
/// decomposition, which spares most levels the eigenvectors.
double PriorPromise::bound(const Level& level, const std::vector<Eigen::Index>& at) const {
  const Eigen::VectorXd errors = level.errors(at);
  const Eigen::LLT<Eigen::MatrixXd> left(prior_(at, at) - largest_share() * level.covariance(at, at));
  if (left.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return (1.0 + kRounding) * errors.dot(left.solve(errors)) - level.objective;
}

PriorPromise::Drop PriorPromise::of(const std::vector<std::size_t>& places, double least) const {
  const std::vector<Eigen::Index> at(places.begin(), places.end());
  Drop best;
  for (const Level& one : levels_) {
    if (bound(one, at) < std::max(best.drop, least)) continue;
    const Whitened here = whitened({0.0, one.errors(at), one.covariance(at, at)}, prior_(at, at));
    const Eigen::VectorXd squares = here.errors.cwiseAbs2();
    for (int step = 1; step <= kSteps; ++step) {
      const double factor = factor_at(step);
      const double drop = drop_at(squares, here.known, share_of(factor)) - one.objective;
      if (drop > best.drop) best = {drop, factor};
    }
  }
  return best;
}

}  // namespace paracal::detail
