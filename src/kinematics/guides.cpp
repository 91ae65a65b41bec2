#include "guides.hpp"

#include <cmath>

namespace paracal::detail {
namespace {

bool is_held(const Machine& machine, Eigen::Index k) { return !machine.freedoms.free[static_cast<std::size_t>(k)]; }

/// Where coordinate k of (x, y, z, tilt_x, tilt_y, tilt_z) is held, mm or rad.
double held_at(const Machine& machine, Eigen::Index k) { return k == 2 ? machine.guided_z : 0.0; }

}  // namespace

bool is_free(const Machine& machine, const Pose& pose) {
  constexpr double kSlack = 1e-6;  // mm, rad: of poses that went through a file
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double commanded = k < 3 ? pose.position(k) : pose.tilt(k - 3);
    if (is_held(machine, k) && !(std::abs(commanded - held_at(machine, k)) <= kSlack)) return false;
  }
  return true;
}

void guide(const Machine& machine, PlateState& plate) {
  for (Eigen::Index k = 0; machine.has_guides && k < 6; ++k) {
    if (is_held(machine, k)) (k < 3 ? plate.position(k) : plate.tilt(k - 3)) = held_at(machine, k);
  }
}

}  // namespace paracal::detail
