#include "paracal/kinematics/drive.hpp"

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "turns.hpp"

namespace paracal {

std::optional<PlateState> drive(const Machine& actual, const Machine& believed, const Pose& commanded,
                                const std::optional<PlateState>& guess) noexcept {
  const InverseResult asked = inverse(believed, commanded);
  if (!asked.ok()) return std::nullopt;
  const PlateState start = guess.value_or(plate_at(actual, commanded));
  ForwardResult taken = forward(actual, asked.joints, {.start = start});
  if (!taken.ok()) taken = forward(actual, asked.joints);
  if (!taken.ok()) return std::nullopt;
  return taken.plate;
}

Eigen::Vector3d turned_away(const Machine& machine, const Pose& commanded, const PlateState& plate) noexcept {
  if (machine.is_level) return plate.tilt;
  return detail::turn_of(plate_rotation(plate.tilt).matrix * plate_rotation(commanded.tilt).matrix.transpose());
}

}  // namespace paracal
