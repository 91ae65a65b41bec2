#include "known_delta.hpp"

#include <cmath>
#include <utility>

#include "numerics/dense.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::detail {
namespace {

/// Shapes of a bed over the disk: the bow, of an edge that is 1 mm above the centre, then Zernike's polynomials of
/// degree 2 to 4.
constexpr Eigen::Index kShapes = 12;
using Shapes = Eigen::Matrix<double, 1, kShapes>;

Shapes shapes_at(const Eigen::Vector3d& place, double radius) {
  const double r = place.head<2>().norm() / radius, a = std::atan2(place.y(), place.x());
  const double r2 = r * r, r3 = r2 * r, r4 = r2 * r2;
  const double coma = 3.0 * r3 - 2.0 * r, second = 4.0 * r4 - 3.0 * r2;
  Shapes shapes;
  shapes << r2 - 0.5, r2 * std::cos(2.0 * a), r2 * std::sin(2.0 * a), r3 * std::cos(3.0 * a), r3 * std::sin(3.0 * a),
      coma * std::cos(a), coma * std::sin(a), 6.0 * r4 - 6.0 * r2 + 1.0, r4 * std::cos(4.0 * a), r4 * std::sin(4.0 * a),
      second * std::cos(2.0 * a), second * std::sin(2.0 * a);
  return shapes;
}

Shapes shape_priors(const LadderPriors& priors) {
  Shapes std = Shapes::Constant(priors.wave);
  std(0) = priors.bow;
  return std;
}

/// Sums of weighted squares, row by row.
struct Normal {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;

  void add(const Eigen::MatrixXd& by, const Eigen::VectorXd& residual) {
    for (Eigen::Index k = 0; k < residual.size(); ++k) {
      const double weight = soft_weight(residual(k));
      information += weight * by.row(k).transpose() * by.row(k);
      gradient += weight * residual(k) * by.row(k).transpose();
    }
  }
};

/// d residuals / d (numbers, shapes, bias), over standard deviations.
Eigen::MatrixXd by_all(const DeltaGeometry& geometry, const DeltaReadings& readings, const Rows& rows,
                       const DeltaBasis& free, const ReadingNoise& noise, double radius) {
  const Eigen::Index n = free.cols(), heights = std::ssize(readings.heights);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(rows.count(), n + kShapes + 1);
  by.leftCols(n) = rows.by_numbers * free;
  for (Eigen::Index k = 0; k < heights; ++k) {
    const auto place = nozzle(geometry, readings.heights[static_cast<std::size_t>(k)].drops);
    if (place) by.row(k).segment<kShapes>(n) = -shapes_at(*place, radius) / noise.height;
  }
  by.col(n + kShapes).tail(rows.count() - heights).setConstant(1.0 / noise.distance);
  return by;
}

}  // namespace

KnownDelta::KnownDelta(const DeltaGeometry& geometry, const DeltaGeometry& saved, const DeltaReadings& readings,
                       const ReadingNoise& noise, const LadderOptions& options)
    : geometry_(geometry), radius_(options.print_radius), free_(rung_basis(geometry.actuator, Rung::rods)) {
  const Rows rows = reading_rows(geometry, readings, noise).value_or(Rows{});
  const Eigen::Index n = free_.cols(), all = n + kShapes + 1;
  const Eigen::MatrixXd by = by_all(geometry, readings, rows, free_, noise, radius_);
  Normal normal{Eigen::MatrixXd::Zero(all, all), Eigen::VectorXd::Zero(all)};
  normal.add(by, rows.residual);
  const Rows prior = prior_rows(geometry, saved, !readings.distances.empty(), options.priors);
  Eigen::MatrixXd by_prior = Eigen::MatrixXd::Zero(prior.count(), all);
  by_prior.leftCols(n) = prior.by_numbers * free_;
  normal.add(by_prior, prior.residual);
  const Shapes shapes = shape_priors(options.priors);
  for (Eigen::Index k = 0; k < kShapes; ++k) normal.information(n + k, n + k) += 1.0 / (shapes(k) * shapes(k));
  normal.information(n + kShapes, n + kShapes) += 1.0 / (options.priors.bias * options.priors.bias);
  covariance_ = Cholesky(normal.information).inverse();
  mean_ = -covariance_ * normal.gradient;
  residuals_ = rows.residual + by * mean_;
  own_parts_.resize(rows.count());
  for (Eigen::Index k = 0; k < rows.count(); ++k) {
    const double weight = soft_weight(rows.residual(k));
    own_parts_(k) = 1.0 - weight * by.row(k).dot(product(covariance_, by.row(k).transpose()).col(0));
  }
}

Eigen::MatrixXd KnownDelta::possible(Eigen::Index count) const {
  RandomStream random(1);
  Eigen::MatrixXd normal(mean_.size(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index i = 0; i < normal.rows(); ++i) normal(i, k) = random.normal();
  }
  return product(cholesky(covariance_), normal).colwise() + mean_;
}

std::optional<KnownDelta::Behaviour> KnownDelta::behaviour(const DeltaGeometry& values,
                                                           const Eigen::MatrixXd& machines) const {
  const std::vector<Eigen::Vector3d> places = printable_disk(radius_);
  const Eigen::Index n = free_.cols(), count = std::ssize(places);
  // Heights over the disk, then the size of prints: at the fitted geometry, and by all that is not known.
  Eigen::VectorXd fitted = Eigen::VectorXd::Zero(count + 1);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(count + 1, mean_.size());
  Eigen::Index reached = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Vector3d& place = places[static_cast<std::size_t>(k)];
    const auto drops = drops_to(values, place);
    const auto real = drops ? nozzle(geometry_, *drops) : std::nullopt;
    if (!real) continue;  // beyond the rods
    ++reached;
    const NozzleJacobian motion = nozzle_jacobian(geometry_, *drops, *real);
    fitted(k) = real->z();
    by.row(k).head(n) = motion.row(2) * free_;
    by.row(k).segment<kShapes>(n) = -shapes_at(place, radius_);
    const double length = place.norm();
    if (!(length > 0.0)) continue;
    const Eigen::RowVector3d out = place.transpose() / (length * length * static_cast<double>(count - 1));
    fitted(count) += out.dot(*real - place);
    by.row(count).head(n) += out * motion * free_;
  }
  if (2 * reached < count) return std::nullopt;
  const Eigen::MatrixXd all = product(by, machines).colwise() + fitted;
  const auto heights = all.topRows(count);
  return Behaviour{-heights.colwise().minCoeff().transpose(),
                   (heights.colwise().squaredNorm() / static_cast<double>(reached)).cwiseSqrt().transpose(),
                   all.bottomRows(1).transpose(), (fitted + product(by, mean_).col(0)).head(count)};
}

}  // namespace paracal::detail
