#include "pair_covariance.hpp"

#include <algorithm>

#include "numerics/dense.hpp"

namespace paracal::detail {

Eigen::MatrixXd covariance_of_pairs(const Measurements& measurements, const Observation& observation,
                                    const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& pseudo_inverse,
                                    double sum) {
  const Eigen::Index n = observation.unknown_count();
  const auto states = observation.stations(unknowns);
  if (!states) return {};
  // H^T D, three columns a station; D's rows are +-n^T / sigma at the two ends of each distance.
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(n, 3 * static_cast<Eigen::Index>(measurements.stations.size()));
  Eigen::MatrixXd block;
  double trace = 0.0;
  for (const Group& group : observation.groups()) {
    observation.rows(group, *states, unknowns, block);
    const Eigen::Vector3d between = (*states)[group.station].plate.position - (*states)[group.from].plate.position;
    const double sigma = observation.sigma_of(group);
    const Eigen::RowVector3d end = between.normalized().transpose() / sigma;
    const Eigen::VectorXd row = block.row(0).head(n).transpose();
    mixed.middleCols<3>(3 * static_cast<Eigen::Index>(group.station)).noalias() += row * end;
    mixed.middleCols<3>(3 * static_cast<Eigen::Index>(group.from)).noalias() -= row * end;
    trace += 2.0 / (sigma * sigma);
  }
  const Eigen::MatrixXd half = product(pseudo_inverse, mixed);
  const double redundancy = trace - mixed.cwiseProduct(half).sum();
  return product(half, half.transpose()) * (sum / std::max(redundancy, 1e-12 * trace));
}

}  // namespace paracal::detail
