#include "paracal/numerics/information_root.hpp"

#include <algorithm>
#include <cmath>

#include "dense.hpp"
#include "paracal/interruption.hpp"

namespace paracal {
namespace {

/// Rows collected before they are folded: enough that the triangle's share of the work is small, few enough to stay in
/// the cache.
Eigen::Index block_rows(Eigen::Index columns) { return std::max<Eigen::Index>(64, 4 * columns); }

}  // namespace

InformationRoot::InformationRoot(Eigen::Index parameters)
    : buffer_(parameters + 1 + block_rows(parameters + 1), parameters + 1), used_(parameters + 1) {
  buffer_.topRows(parameters + 1).setZero();  // rows below are written before they are read
}

void InformationRoot::add(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  let_interrupt();
  if (rows.rows() > buffer_.rows() - buffer_.cols()) {  // more than a block: in halves
    const Eigen::Index half = rows.rows() / 2;
    add(rows.topRows(half));
    return add(rows.bottomRows(rows.rows() - half));
  }
  if (used_ + rows.rows() > buffer_.rows()) fold();
  buffer_.middleRows(used_, rows.rows()) = rows;
  used_ += rows.rows();
  rows_ += rows.rows();
  squared_residuals_ += rows.rightCols<1>().squaredNorm();
  folded_ = false;
}

void InformationRoot::add(const InformationRoot& other) {
  other.fold();
  const double sum = squared_residuals_ + other.squared_residuals_;
  const Eigen::Index count = rows_ + other.rows_;
  add(other.buffer_.topRows(other.buffer_.cols()));
  squared_residuals_ = sum;
  rows_ = count;
}

void InformationRoot::add_prior(Eigen::Index parameter, double current, double value, double sigma) {
  const Eigen::Index last = parameter_count();
  auto place = buffer_.row(parameter).tail(last + 1 - parameter);
  const double residual = (current - value) / sigma;
  if (place.isZero(0.0)) {  // the row is one of the triangle as it stands
    place(0) = 1.0 / sigma;
    place(last - parameter) = residual;
    squared_residuals_ += residual * residual;
    ++rows_;
    return;
  }
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(last + 1);
  row(parameter) = 1.0 / sigma;
  row(last) = residual;
  add(row);
}

/// Householder reflections of a triangle over a block of rows: each touches one row of the triangle and the block.
void InformationRoot::fold() const {
  if (folded_) return;
  const Eigen::Index columns = buffer_.cols();
  auto block = buffer_.middleRows(columns, used_ - columns);
  Eigen::RowVectorXd along(columns);
  for (Eigen::Index k = 0; k < columns; ++k) {
    const Eigen::Index right = columns - k - 1;
    auto reflector = block.col(k);  // below a leading 1
    const double corner = buffer_(k, k), below = reflector.squaredNorm();
    if (below == 0.0) continue;
    const double length = -std::copysign(std::sqrt(corner * corner + below), corner);
    reflector /= corner - length;
    buffer_(k, k) = length;
    auto row = buffer_.row(k).tail(right);
    auto projection = along.tail(right);
    projection.noalias() = reflector.transpose() * block.rightCols(right);
    projection = (projection + row) * ((length - corner) / length);
    row -= projection;
    block.rightCols(right).noalias() -= reflector * projection;
  }
  used_ = columns;
  folded_ = true;
}

Eigen::MatrixXd InformationRoot::root() const {
  fold();
  return buffer_.topLeftCorner(parameter_count(), parameter_count());
}

Eigen::VectorXd InformationRoot::reachable() const {
  fold();
  return buffer_.col(parameter_count()).head(parameter_count());
}

Spectrum analyse(const Eigen::MatrixXd& root, double rank_tolerance, const Eigen::VectorXd& scale) {
  Spectrum spectrum;
  if (root.cols() == 0) return spectrum;  // Eigen decomposes nothing that is empty
  spectrum.scale = scale.size() > 0 ? scale : Eigen::VectorXd(root.colwise().norm());
  spectrum.scale = (spectrum.scale.array() > 0.0).select(spectrum.scale, 1.0);
  const Eigen::VectorXd unscale = spectrum.scale.cwiseInverse();
  const detail::SingularValues svd = detail::singular_values(root * unscale.asDiagonal());
  spectrum.singular_values = svd.values;
  const Eigen::VectorXd& s = spectrum.singular_values;
  while (spectrum.rank < s.size() && s(spectrum.rank) > rank_tolerance * s(0)) ++spectrum.rank;
  const Eigen::MatrixXd seen =
      unscale.asDiagonal() * svd.right.leftCols(spectrum.rank) * s.head(spectrum.rank).cwiseInverse().asDiagonal();
  spectrum.covariance = seen * seen.transpose();
  spectrum.null_space = unscale.asDiagonal() * svd.right.rightCols(svd.right.cols() - spectrum.rank);
  spectrum.null_space.colwise().normalize();
  return spectrum;
}

Eigen::MatrixXd inverse_information(const Eigen::MatrixXd& root) {
  const Eigen::MatrixXd inverse =
      root.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(root.rows(), root.cols()));
  return inverse * inverse.transpose();
}

}  // namespace paracal
