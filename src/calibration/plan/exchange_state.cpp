#include "exchange_state.hpp"

#include <cmath>

#include "numerics/dense.hpp"

namespace paracal::detail {

ExchangeState::ExchangeState(const Problem& problem, Criterion criterion)
    : problem_(&problem),
      criterion_(criterion),
      covariance_(Eigen::MatrixXd::Identity(problem.weighted.rows(), problem.weighted.rows())),
      goal_(problem.goal) {}

double ExchangeState::value() const {
  if (is_volume()) return std::log(determinant(covariance_));
  if (criterion_ == Criterion::worst_direction) return worst();
  return goal_.cwiseProduct(covariance_).sum();
}

Eigen::MatrixXd ExchangeState::visible_covariance() const {
  return product(product(problem_->visible.transpose(), covariance_), problem_->visible);
}

double ExchangeState::worst() const { return symmetric_eigenvalues(visible_covariance()).maxCoeff(); }

/// Gradient of tr(C^4), which the largest eigenvalues dominate, scaled to 1: a linear stand-in for the largest.
Eigen::MatrixXd ExchangeState::towards_worst() const {
  const Eigen::MatrixXd c = visible_covariance() / worst();
  return product(product(problem_->visible, product(product(c, c), c)), problem_->visible.transpose());
}

void ExchangeState::refresh(const std::vector<Eigen::Index>& chosen) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(covariance_.rows(), covariance_.rows());
  for (const Eigen::Index k : chosen) add_square(information, rows_of(k, 1));
  covariance_ = cholesky_solution(information, Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  if (criterion_ == Criterion::worst_direction) goal_ = towards_worst();
  far_ = product(product(covariance_, goal_), covariance_);
}

ExchangeState::Forms ExchangeState::forms(Eigen::Index first, Eigen::Index count) const {
  const Eigen::Index rows = problem_->rows;
  const Eigen::MatrixXd by_covariance = product(covariance_, rows_of(first, count)),
                        by_far = product(far_, rows_of(first, count));
  Forms forms{Eigen::MatrixXd(rows * count, rows), Eigen::MatrixXd(rows * count, rows)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto candidate = rows_of(first + k, 1).transpose();
    forms.near.middleRows(rows * k, rows) = candidate.lazyProduct(by_covariance.middleCols(rows * k, rows));
    forms.far.middleRows(rows * k, rows) = candidate.lazyProduct(by_far.middleCols(rows * k, rows));
  }
  return forms;
}

ExchangeState::Direction ExchangeState::direction(Eigen::Index s) const {
  const Eigen::Index rows = problem_->rows;
  const Eigen::MatrixXd u = product(covariance_, rows_of(s, 1));
  Direction along{Eigen::MatrixXd::Zero(u.rows(), 2 * rows), Eigen::MatrixXd::Zero(rows, rows)};
  along.both.leftCols(rows) = u;
  if (is_volume()) return along;
  // far_k = A_k C B C A_k^T needs A_k C B U besides A_k U.
  const Eigen::MatrixXd by_goal = product(goal_, u);
  along.both.rightCols(rows) = product(covariance_, by_goal);
  along.between = product(u.transpose(), by_goal);
  return along;
}

Eigen::MatrixXd ExchangeState::products(Eigen::Index first, Eigen::Index count, const Direction& along) const {
  return product(rows_of(first, count).transpose(), along.both);
}

void ExchangeState::move(const Direction& along, const Eigen::MatrixXd& inner) {
  const Eigen::MatrixXd u = along.both.leftCols(problem_->rows);
  covariance_ -= product(product(u, inner), u.transpose());
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
}

}  // namespace paracal::detail
