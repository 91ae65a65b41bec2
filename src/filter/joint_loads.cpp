#include "joint_loads.hpp"

#include <array>

namespace paracal::io {

bool JointLoads::exceeds_limit(const TargetLine& line, double seconds) const {
  std::array<Joints, kSteps + 1> joints;
  for (int k = 0; k <= kSteps; ++k) {
    const auto found = correction_.joints(axes_.pose_at(line.path.at(static_cast<double>(k) / kSteps)));
    if (!found) return false;
    joints[static_cast<std::size_t>(k)] = *found;
  }
  const double per_step = kSteps / seconds;
  for (std::size_t k = 0; k < kSteps; ++k) {
    const Joints step = joints[k + 1] - joints[k];
    if (step.cwiseAbs().maxCoeff() * per_step > limits_->speed) return true;
    if (k == 0) continue;
    const Joints change = step - (joints[k] - joints[k - 1]);
    if (change.cwiseAbs().maxCoeff() * per_step * per_step > limits_->acceleration) return true;
  }
  return false;
}

void JointLoads::add(const TargetLine& line) {
  const std::optional<double> seconds = limits_ && line.starts_known ? line.seconds() : std::nullopt;
  if (!seconds || !exceeds_limit(line, *seconds)) return;
  if (summary_.over_limit++ == 0) summary_.first_over_limit = line.number;
}

}  // namespace paracal::io
