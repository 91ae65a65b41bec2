#include "joint_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace paracal::io {

std::optional<JointLoad> JointLoads::load_of(const TargetLine& line, double seconds) const {
  std::array<Joints, kSteps + 1> joints;
  for (int k = 0; k <= kSteps; ++k) {
    const auto found = correction_.joints(axes_.pose_at(line.path.at(static_cast<double>(k) / kSteps)));
    if (!found) return std::nullopt;
    joints[static_cast<std::size_t>(k)] = *found;
  }
  const double per_step = kSteps / seconds;
  JointLoad hardest{.line = line.number};
  for (Eigen::Index i = 0; i < joints[0].size(); ++i) {
    JointLoad load{.line = line.number, .joint = static_cast<std::size_t>(i) + 1};
    for (std::size_t k = 0; k < kSteps; ++k) {
      const double step = joints[k + 1](i) - joints[k](i);
      load.speed = std::max(load.speed, std::abs(step) * per_step);
      if (k == 0) continue;
      const double change = step - (joints[k](i) - joints[k - 1](i));
      load.acceleration = std::max(load.acceleration, std::abs(change) * per_step * per_step);
    }
    load.of_limit = std::max(load.speed / limits_->speed, load.acceleration / limits_->acceleration);
    if (load.of_limit >= hardest.of_limit) hardest = load;
  }
  return hardest;
}

void JointLoads::add(const TargetLine& line) {
  const std::optional<double> seconds = limits_ && line.starts_known ? line.seconds() : std::nullopt;
  const auto load = seconds ? load_of(line, *seconds) : std::nullopt;
  if (!load) return;
  if (load->of_limit > 1.0 && summary_.over_limit++ == 0) summary_.first_over_limit = line.number;
  auto& hardest = summary_.hardest;
  hardest.insert(std::ranges::upper_bound(hardest, load->of_limit, std::greater{}, &JointLoad::of_limit), *load);
  if (hardest.size() > kHardest) hardest.pop_back();
}

}  // namespace paracal::io
