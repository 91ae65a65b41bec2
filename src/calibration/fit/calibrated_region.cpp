#include "paracal/calibration/calibrated_region.hpp"

#include <algorithm>
#include <cmath>

namespace paracal {
namespace {

/// One of u and -u.
std::vector<Eigen::Vector3d> half_of_all() {
  std::vector<Eigen::Vector3d> all;
  for (int k = 14; k < 27; ++k) {
    const Eigen::Vector3i steps(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
    all.push_back(steps.cast<double>().normalized());
  }
  return all;
}

}  // namespace

const std::vector<Eigen::Vector3d>& CalibratedRegion::directions() {
  static const std::vector<Eigen::Vector3d> kDirections = half_of_all();
  return kDirections;
}

void CalibratedRegion::add(const Eigen::Vector3d& position) {
  const std::vector<Eigen::Vector3d>& along = directions();
  low.resize(along.size(), HUGE_VAL);
  high.resize(along.size(), -HUGE_VAL);
  for (std::size_t k = 0; k < along.size(); ++k) {
    const double at = along[k].dot(position);
    low[k] = std::min(low[k], at);
    high[k] = std::max(high[k], at);
  }
}

double CalibratedRegion::beyond(const Eigen::Vector3d& position, std::size_t direction) const {
  const double at = directions()[direction].dot(position);
  return std::max({0.0, low[direction] - at, at - high[direction]});
}

double CalibratedRegion::beyond(const Eigen::Vector3d& position) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < low.size(); ++k) largest = std::max(largest, beyond(position, k));
  return largest;
}

bool CalibratedRegion::is_left_by(const Eigen::Vector3d& position) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < low.size(); ++k) largest = std::max(largest, high[k] - low[k]);
  for (std::size_t k = 0; k < low.size(); ++k) {
    if (beyond(position, k) > std::max(kSlack * (high[k] - low[k]), kThin * largest)) return true;
  }
  return false;
}

}  // namespace paracal
