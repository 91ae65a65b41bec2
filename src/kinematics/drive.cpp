#include "paracal/kinematics/drive.hpp"

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"

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

}  // namespace paracal
