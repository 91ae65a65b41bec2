#include "joints.hpp"

#include <fmt/format.h>

namespace paracal::detail {

JointReadings::JointReadings(std::size_t stations, double sigma, double ratio)
    : ReadingSeries("joints"), stations_(stations), sigma_(sigma), ratio_(ratio) {}

Group JointReadings::group(std::size_t index) const {
  return {.station = static_cast<std::uint32_t>(index), .stated = true};
}

ByPlate JointReadings::rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const {
  const Eigen::VectorXd& gaps = at.stations[index].gaps.gap;
  block.setZero(gaps.size(), at.unknowns.size() + 1);
  block.rightCols<1>() = gaps / sigma_;
  return ByPlate::Identity(gaps.size(), 7) / sigma_;
}

/// Root mean square, mm.
Residual JointReadings::residual(std::size_t index, const Placed& at) const {
  const Eigen::VectorXd& gaps = at.stations[index].gaps.gap;
  return {Eigen::Matrix<double, 1, 1>(ratio_ * gaps.norm() / std::sqrt(static_cast<double>(gaps.size())))};
}

std::string JointReadings::label(std::size_t index, const std::vector<Station>& stations) const {
  return fmt::format("joints at {}", stations[index].name);
}

void JointReadings::add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const {
  for (const Group& group : of_series) {
    if (group.active) tally.joints.add(residual(group.index, at).length(0));
  }
}

}  // namespace paracal::detail
