#include "outliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "numerics/median.hpp"

namespace paracal::detail {
namespace {

constexpr int kMostReadingRows = 7;  // of a reading
using SmallSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostReadingRows, kMostReadingRows>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostReadingRows, 1>;

/// S^-1 over the directions in which the reading can be checked at all.
SmallSquare checked_inverse(const SmallSquare& spread) {
  constexpr double kUncheckable = 1e-6;  // of the reading's own variance
  const SymmetricEigen eigen = symmetric_eigen(spread);
  const Eigen::VectorXd inverse = (eigen.values.array() > kUncheckable).select(eigen.values.cwiseInverse(), 0.0);
  return product(eigen.vectors * inverse.asDiagonal(), eigen.vectors.transpose());
}

/// How priors give way when a reading in use is left out: unknowns move by d = C J^T S^-1 v, their squares grow by
/// 2 d^T W^T w + |W d|^2, and readings tell tr(S^-1 J C W^T W C J^T) less of what priors tell more.
class GivingWay {
 public:
  GivingWay(const Observation& observation, const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& covariance)
      : priors_(observation.unknown_count()) {
    observation.add_priors(unknowns, priors_);
    by_unknowns_ = product(priors_.root(), covariance);
    pull_ = by_unknowns_.transpose() * priors_.reachable();
  }

  /// Of the other readings, when these rows no longer count.
  Scatter rest(const Scatter& all, const Eigen::MatrixXd& jacobian, const SmallSquare& inverse,
               const SmallVector& residual) const {
    const SmallVector told = inverse * residual;
    const Eigen::MatrixXd moved = product(by_unknowns_, jacobian.transpose());
    const double growth = 2.0 * told.dot(jacobian * pull_) + (moved * told).squaredNorm();
    return {all.sum - residual.dot(told) - growth,
            all.redundancy - static_cast<double>(residual.size()) + product(moved, inverse).cwiseProduct(moved).sum()};
  }

 private:
  InformationRoot priors_;
  Eigen::MatrixXd by_unknowns_;  ///< W C
  Eigen::VectorXd pull_;         ///< C W^T w
};

}  // namespace

double Contradiction::chance(std::size_t count) const {
  if (!std::isfinite(statistic)) return 0.0;
  const double one = fisher_tail(statistic, rows, freedom);
  return -std::expm1(static_cast<double>(count) * std::log1p(-std::min(one, 1.0 - 1e-16)));
}

std::vector<Contradiction> contradictions(const Observation& observation, const Eigen::VectorXd& unknowns,
                                          const Eigen::MatrixXd& covariance, const Scatter& scatter) {
  std::vector<Contradiction> all;
  const Eigen::Index n = observation.unknown_count();
  const GivingWay priors(observation, unknowns, covariance);
  observation.check_each(unknowns, [&](std::size_t g, const Eigen::MatrixXd& block) {
    const bool active = observation.groups()[g].active;
    const int rows = static_cast<int>(block.rows());
    const Eigen::MatrixXd jacobian = block.leftCols(n);
    const SmallVector residual = block.col(n);
    const double sign = active ? -1.0 : 1.0;
    const SmallSquare own = SmallSquare::Identity(rows, rows);
    const SmallSquare inverse =
        checked_inverse(own + sign * product(product(jacobian, covariance), jacobian.transpose()));
    const Scatter rest = active ? priors.rest(scatter, jacobian, inverse, residual) : scatter;
    const bool told = rest.redundancy >= 1.0;  // else nothing tells how much good readings scatter
    if (!told && active) return;
    const double unit = told ? std::max(rest.sum, 1e-12) / rest.redundancy : std::numeric_limits<double>::infinity();
    all.push_back({g, residual.dot(inverse * residual) / rows / unit, std::max(rest.redundancy, 1.0), rows});
  });
  std::ranges::sort(all, std::greater{}, &Contradiction::statistic);
  return all;
}

std::vector<double> studentised(const Observation& observation, const Eigen::VectorXd& unknowns,
                                const Eigen::MatrixXd& covariance) {
  constexpr double kUncheckable = 1e-3;  // of a reading's rows
  std::vector<double> sizes(observation.groups().size(), 0.0), active;
  const Eigen::Index n = observation.unknown_count();
  observation.check_each(unknowns, [&](std::size_t g, const Eigen::MatrixXd& block) {
    const Group& group = observation.groups()[g];
    if (!group.active) return;
    const auto rows = static_cast<double>(block.rows());
    const double redundancy = rows - product(block.leftCols(n), covariance).cwiseProduct(block.leftCols(n)).sum();
    sizes[g] = std::sqrt(block.col(n).squaredNorm() / group.weight / std::max(redundancy, kUncheckable * rows));
    active.push_back(sizes[g]);
  });
  const double middle = active.empty() ? 1.0 : std::max(median(active), 1e-12);
  for (double& size : sizes) size /= middle;
  return sizes;
}

double size_by_chance(double rows, double chance) {
  return std::sqrt(chi_square_quantile(chance, rows) / chi_square_quantile(0.5, rows));
}

bool one_stands_out(const Observation& observation, const std::vector<double>& sizes) {
  // Among few readings gross ones hide behind each other, and the rounds of a robust loss cost little. Among many each
  // that stands out less than chance lets one do contradicts too little to be left out (CalibrationOptions'
  // outlier_chance is smaller), and the rounds would mark none.
  constexpr std::size_t kFew = 200;
  constexpr double kStandsOut = 3.5, kChance = 0.01;
  const auto largest = [&](double rows) {
    if (sizes.size() <= kFew) return kStandsOut;
    return std::max(kStandsOut, size_by_chance(rows, kChance / static_cast<double>(sizes.size())));
  };
  const double of_point = largest(3.0), of_number = largest(1.0);
  for (std::size_t g = 0; g < sizes.size(); ++g) {
    const bool point = observation.series_of(observation.groups()[g]).quantity() == Quantity::coordinate;
    if (sizes[g] > (point ? of_point : of_number)) return true;
  }
  return false;
}

void leave_out_gross_points(Observation& observation, const Eigen::VectorXd& start) {
  constexpr double kGross = 8.0;
  const auto stations = observation.stations(start);
  if (!stations) return;
  std::vector<double> distances;
  for (const Group& group : observation.groups()) {
    const ReadingSeries& series = observation.series_of(group);
    if (series.shows_gross_at_start())
      distances.push_back(series.residual(group.index, {*stations, start}).length.norm());
  }
  if (distances.empty()) return;
  const double limit = std::max(kGross * median(distances), 5.0);
  std::size_t k = 0;
  for (Group& group : observation.groups()) {
    if (observation.series_of(group).shows_gross_at_start() && distances[k++] > limit) group.active = false;
  }
}

}  // namespace paracal::detail
