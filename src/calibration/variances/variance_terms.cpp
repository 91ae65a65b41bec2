#include "variance_terms.hpp"

namespace paracal::detail {

void SparseColumns::add(std::span<const Eigen::Index> rows, const Eigen::VectorXd& values) {
  rows_.insert(rows_.end(), rows.begin(), rows.end());
  values_.insert(values_.end(), values.begin(), values.end());
  ends_.push_back(rows_.size());
}

void SparseColumns::append(const SparseColumns& others) {
  const std::size_t before = rows_.size();
  rows_.insert(rows_.end(), others.rows_.begin(), others.rows_.end());
  values_.insert(values_.end(), others.values_.begin(), others.values_.end());
  for (const std::size_t end : others.ends_) ends_.push_back(before + end);
}

/// Calls look(first, end) for the entries of each column.
template <typename Look>
void SparseColumns::each(Look&& look) const {
  std::size_t first = 0;
  for (const std::size_t end : ends_) {
    look(first, end);
    first = end;
  }
}

void SparseColumns::add_square(double factor, Eigen::MatrixXd& M) const {
  each([&](std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
      const double value = factor * values_[k];
      for (std::size_t i = k; i < end; ++i) M(rows_[i], rows_[k]) += value * values_[i];
    }
  });
}

double SparseColumns::trace_with(const Eigen::MatrixXd& P) const {
  double sum = 0.0;
  each([&](std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
      double below = 0.0;
      for (std::size_t i = k + 1; i < end; ++i) below += values_[i] * P(rows_[i], rows_[k]);
      sum += values_[k] * (2.0 * below + values_[k] * P(rows_[k], rows_[k]));
    }
  });
  return sum;
}

Eigen::VectorXd SparseColumns::square_times(const Eigen::VectorXd& z) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(z.size());
  each([&](std::size_t first, std::size_t end) {
    double along = 0.0;
    for (std::size_t k = first; k < end; ++k) along += values_[k] * z(rows_[k]);
    for (std::size_t k = first; k < end; ++k) all(rows_[k]) += along * values_[k];
  });
  return all;
}

double SparseColumns::squared_norm() const {
  double sum = 0.0;
  for (const double value : values_) sum += value * value;
  return sum;
}

void VarianceTerm::add_to(Eigen::MatrixXd& V, double variance) const {
  if (by_errors.size() > 0) {
    V += variance * by_errors;
  } else if (diagonal.size() > 0) {
    V.diagonal() += variance * diagonal;
  } else {
    columns.add_square(variance, V);
  }
}

double VarianceTerm::trace_with(const Eigen::MatrixXd& P) const {
  if (by_errors.size() > 0) return by_errors.cwiseProduct(P).sum();
  return diagonal.size() > 0 ? diagonal.dot(P.diagonal()) : columns.trace_with(P);
}

Eigen::VectorXd VarianceTerm::times(const Eigen::VectorXd& z) const {
  if (by_errors.size() > 0) return by_errors * z;
  return diagonal.size() > 0 ? Eigen::VectorXd(diagonal.cwiseProduct(z)) : columns.square_times(z);
}

double VarianceTerm::trace() const {
  if (by_errors.size() > 0) return by_errors.trace();
  return diagonal.size() > 0 ? diagonal.sum() : columns.squared_norm();
}

}  // namespace paracal::detail
