#include "guides.hpp"

#include <cmath>

#include "linear_closure.hpp"

namespace paracal::detail {
namespace {

/// By how much coordinate k of (x, y, z, tilt_x, tilt_y, tilt_z) is off from where guides hold it, mm or rad.
double off(const Machine& machine, const Eigen::Vector3d& position, const Eigen::Vector3d& tilt, Eigen::Index k) {
  const double held = k == 2 ? machine.guided_z : 0.0;
  return (k < 3 ? position(k) : tilt(k - 3)) - held;
}

bool is_held(const Machine& machine, Eigen::Index k) { return !machine.freedoms.free[static_cast<std::size_t>(k)]; }

}  // namespace

void add_guides(const Machine& machine, const PlateState& plate, LinearClosure<kGuided>& linear) {
  auto row = static_cast<Eigen::Index>(machine.limb_count);
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (!is_held(machine, k)) continue;
    linear.residual(row) = off(machine, plate.position, plate.tilt, k);
    linear.jacobian.row(row) = Eigen::Matrix<double, 1, 6>::Unit(k);
    ++row;
  }
}

bool is_free(const Machine& machine, const Pose& pose) {
  constexpr double kSlack = 1e-6;  // mm, rad: of poses that went through a file
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (is_held(machine, k) && !(std::abs(off(machine, pose.position, pose.tilt, k)) <= kSlack)) return false;
  }
  return true;
}

}  // namespace paracal::detail
