#include "drawing.hpp"

namespace paracal::detail {

Drawing::Drawing(const Eigen::MatrixXd& response, const Tolerances& tolerances) : tolerances_(&tolerances) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index column = 0; column < response.cols(); ++column) {
    const auto source = static_cast<Source>(column % static_cast<Eigen::Index>(kSourceCount));
    const bool varies = tolerances[source] > 0.0 || !tolerances.measured[index(source)].empty();
    if (!varies || response.col(column).isZero(0.0)) continue;
    const auto number = static_cast<std::uint64_t>(column) / 2;
    if (pairs_.empty() || pairs_.back().number != number) pairs_.push_back({.number = number});
    pairs_.back().row[static_cast<std::size_t>(column % 2)] = static_cast<Eigen::Index>(used.size());
    pairs_.back().source[static_cast<std::size_t>(column % 2)] = source;
    used.push_back(column);
  }
  matrix_ = response(Eigen::all, used);
}

void Drawing::draw(std::uint64_t seed, std::uint64_t first, Eigen::Ref<Eigen::MatrixXd> errors) const {
  for (Eigen::Index m = 0; m < errors.cols(); ++m) {
    for (const Pair& pair : pairs_) {
      const std::array<double, 2> normal = normal_pair(seed, first + static_cast<std::uint64_t>(m), pair.number);
      for (std::size_t k = 0; k < 2; ++k) {
        if (pair.row[k] >= 0) errors(pair.row[k], m) = source_error(*tolerances_, pair.source[k], normal[k]);
      }
    }
  }
}

}  // namespace paracal::detail
