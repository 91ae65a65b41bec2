#include "distance_geometry.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/dense.hpp"
#include "paracal/numerics/rigid_fit.hpp"

namespace paracal::detail {
namespace {

constexpr double kPrintedRounding = 0.005;  // mm: distances printed to 0.01 mm

/// Stations that the distances join, in order; empty unless every pair of at least 5 of them is there, and no sigma is
/// stated. (4 points have as many distances as distances can tell of them.)
std::vector<std::size_t> complete_stations(const Measurements& measurements) {
  std::vector<std::size_t> stations;
  for (const DistanceReading& reading : measurements.distances) {
    if (reading.distance_sigma) return {};
    stations.push_back(reading.from);
    stations.push_back(reading.to);
  }
  std::ranges::sort(stations);
  stations.erase(std::unique(stations.begin(), stations.end()), stations.end());
  const std::size_t n = stations.size();
  if (n < 5 || measurements.distances.size() != n * (n - 1) / 2) return {};
  return stations;
}

/// Row i: point i, up to a rigid motion and a mirror. Empty for points that lie nearly in a plane: distances then tell
/// little of how far each is from it, which points as measured would know.
Eigen::MatrixXd points_of(const Eigen::MatrixXd& distances) {
  Eigen::MatrixXd gram = -0.5 * distances.cwiseAbs2();
  gram.colwise() -= gram.rowwise().mean().eval();
  gram.rowwise() -= gram.colwise().mean().eval();
  const SymmetricEigen eigen = symmetric_eigen(gram);
  constexpr double kFlat = 0.02 * 0.02;  // of the largest extent, squared
  if (!(eigen.values(gram.rows() - 3) > kFlat * eigen.values(gram.rows() - 1))) return {};
  return eigen.vectors.rightCols<3>() * eigen.values.tail<3>().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

double rms_misfit(const Eigen::MatrixXd& points, const Eigen::MatrixXd& distances) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index k = 0; k < i; ++k) {
      sum += std::pow((points.row(i) - points.row(k)).norm() - distances(i, k), 2);
    }
  }
  return std::sqrt(2.0 * sum / static_cast<double>(points.rows() * (points.rows() - 1)));
}

double distance_after_alignment(const std::vector<Eigen::Vector3d>& points,
                                const std::vector<Eigen::Vector3d>& commanded) {
  const RigidMotion motion = rigid_fit(points, commanded);
  double sum = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) sum += (motion(points[k]) - commanded[k]).squaredNorm();
  return sum;
}

/// Distances cannot tell a set of points from its mirror image; the commanded poses can.
std::vector<Eigen::Vector3d> like_commanded(const Eigen::MatrixXd& points,
                                            const std::vector<Eigen::Vector3d>& commanded) {
  std::vector<Eigen::Vector3d> one, other;
  for (const auto& row : points.rowwise()) {
    one.emplace_back(row.transpose());
    other.emplace_back(-row.transpose());
  }
  return distance_after_alignment(one, commanded) <= distance_after_alignment(other, commanded) ? one : other;
}

}  // namespace

std::optional<Measurements> as_points(const Measurements& measurements) {
  const std::vector<std::size_t> stations = complete_stations(measurements);
  if (stations.empty()) return std::nullopt;
  const auto place = [&](std::size_t station) {
    return std::ranges::lower_bound(stations, station) - stations.begin();
  };
  const auto n = static_cast<Eigen::Index>(stations.size());
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(n, n);
  std::vector<std::optional<double>> rotations(stations.size());
  rotations[0] = 0.0;
  for (const DistanceReading& reading : measurements.distances) {
    const auto i = place(reading.from), k = place(reading.to);
    distances(i, k) = distances(k, i) = reading.distance;
    if (i == 0) rotations[static_cast<std::size_t>(k)] = reading.rotation;
    if (k == 0 && reading.rotation) rotations[static_cast<std::size_t>(i)] = -*reading.rotation;
  }
  const Eigen::MatrixXd points = points_of(distances);
  if (points.size() == 0 || !(rms_misfit(points, distances) < kPrintedRounding)) return std::nullopt;
  std::vector<Eigen::Vector3d> commanded;
  commanded.reserve(stations.size());
  for (const std::size_t station : stations) commanded.push_back(measurements.stations[station].commanded.position);
  const std::vector<Eigen::Vector3d> right_handed = like_commanded(points, commanded);

  const bool turned = std::ranges::all_of(rotations, [](const auto& rotation) { return rotation.has_value(); });
  Measurements result = measurements;
  result.distances.clear();
  result.series.push_back({"distances", {}});
  for (std::size_t k = 0; k < stations.size(); ++k) {
    PointReading reading{.station = stations[k], .point = right_handed[k]};
    if (turned) reading.rotation = rotations[k];
    result.series.back().readings.push_back(std::move(reading));
  }
  result.notes.emplace_back("the distances are those of all pairs of measured points: the fit uses the points");
  return result;
}

}  // namespace paracal::detail
