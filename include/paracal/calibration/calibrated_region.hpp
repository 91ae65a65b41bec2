#pragma once

#include <Eigen/Core>
#include <vector>

namespace paracal {

/// Where the poses of a calibration are: between two planes in each of 13 directions (edges, diagonals of faces and of
/// the body of a cube), mm in {O}. Planes instead of the convex hull: a few numbers, and as large as the hull but for
/// its rounded corners.
struct CalibratedRegion {
  std::vector<double> low = {}, high = {};  ///< u . r in the order of directions(); empty: unknown

  static const std::vector<Eigen::Vector3d>& directions();

  bool is_known() const { return !low.empty(); }
  void add(const Eigen::Vector3d& position);

  /// How far a position is beyond the planes, mm; 0 inside, and where the region is unknown.
  double beyond(const Eigen::Vector3d& position) const;

  /// A prediction there extrapolates: the position is beyond a plane by more than kSlack of its distance from the other
  /// one, and by more than kThin of the largest such distance, because poses in one plane have none. Errors of a
  /// machine are smooth, so that a little farther they are as known as at the rim.
  bool is_left_by(const Eigen::Vector3d& position) const;

  static constexpr double kSlack = 0.1, kThin = 0.02;

 private:
  double beyond(const Eigen::Vector3d& position, std::size_t direction) const;
};

}  // namespace paracal
