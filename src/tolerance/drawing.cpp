#include "drawing.hpp"

#include <algorithm>

namespace paracal::detail {

Drawing::Drawing(const Robot& robot, const Eigen::MatrixXd& response, const Tolerances& tolerances)
    : tolerances_(&tolerances) {
  for (Eigen::Index column = 0; column < response.cols(); ++column) {
    const Parameter& parameter = robot.parameters()[static_cast<std::size_t>(column)];
    const Source source = parameter.source;
    const bool varies = tolerances[source] > 0.0 || !tolerances.measured[source].empty();
    if (!varies || response.col(column).isZero(0.0)) continue;
    const std::uint64_t number = parameter.number / 2;
    if (pairs_.empty() || pairs_.back().number != number) pairs_.push_back({.number = number});
    pairs_.back().row[parameter.number % 2] = static_cast<Eigen::Index>(columns_.size());
    sources_.push_back(source);
    columns_.push_back(column);
  }
  matrix_ = response(Eigen::all, columns_);
  half_widths_.resize(matrix_.cols());
  std::ranges::transform(sources_, half_widths_.begin(), [&](Source source) { return tolerances[source]; });
  all_normal_ = tolerances.distribution == Distribution::normal &&
                std::ranges::all_of(sources_, [&](Source source) { return tolerances.measured[source].empty(); });
}

void Drawing::draw(std::uint64_t seed, std::uint64_t first, Eigen::Ref<Eigen::MatrixXd> errors) const {
  for (Eigen::Index m = 0; m < errors.cols(); ++m) {
    for (const Pair& pair : pairs_) {
      const std::array<double, 2> normal = normal_pair(seed, first + static_cast<std::uint64_t>(m), pair.number);
      for (std::size_t k = 0; k < 2; ++k) {
        if (pair.row[k] >= 0) errors(pair.row[k], m) = normal[k];
      }
    }
  }
  spread(errors);
}

void Drawing::spread(Eigen::Ref<Eigen::MatrixXd> errors) const {
  if (all_normal_) {
    errors.array() = (errors.array() / 3.0).colwise() * half_widths_;
    return;
  }
  for (Eigen::Index m = 0; m < errors.cols(); ++m) {
    for (Eigen::Index row = 0; row < errors.rows(); ++row) {
      errors(row, m) = source_error(*tolerances_, sources_[static_cast<std::size_t>(row)], errors(row, m));
    }
  }
}

}  // namespace paracal::detail
