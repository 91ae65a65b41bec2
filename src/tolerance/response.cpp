#include "paracal/tolerance/response.hpp"

#include <algorithm>

#include "paracal/kinematics/drive.hpp"

namespace paracal {

Response::Response(const Robot& robot, std::vector<Characteristic> characteristics, std::vector<Pose> poses)
    : robot_(robot), characteristics_(std::move(characteristics)), poses_(std::move(poses)) {
  const auto count = static_cast<Eigen::Index>(poses_.size());
  Eigen::Index rows = 0;
  for (const Characteristic characteristic : characteristics_) {
    first_row_.push_back(rows);
    rows += component_count(characteristic.quantity) * count;
  }
  linear_.resize(rows, static_cast<Eigen::Index>(kSourceCount * robot.limb_count()));
  const LinearModel model(robot);
  for (std::size_t c = 0; c < characteristics_.size(); ++c) {
    for (Eigen::Index p = 0; p < count; ++p) {
      const SourceRows at_pose = model.rows(poses_[static_cast<std::size_t>(p)], characteristics_[c]);
      for (Eigen::Index j = 0; j < at_pose.rows(); ++j) linear_.row(first_row_[c] + j * count + p) = at_pose.row(j);
    }
  }
}

bool Response::add_exact(const Machine& machine, const Machine& believed, bool compensated,
                         Eigen::Ref<Eigen::VectorXd> components) const {
  const std::optional<PlateState> home = drive(machine, believed, {robot_.workspace().centre(), 0.0});
  if (!home) return false;
  const auto count = static_cast<Eigen::Index>(poses_.size());
  for (Eigen::Index p = 0; p < count; ++p) {
    const Pose& pose = poses_[static_cast<std::size_t>(p)];
    const std::optional<PlateState> plate = drive(machine, believed, pose);
    if (!plate) return false;
    const Reached point{pose, plate->position, turned_away(machine, pose, *plate), machine.rotation_of(plate->slide),
                        home->position};
    for (std::size_t c = 0; c < characteristics_.size(); ++c) {
      if (characteristics_[c].compensated != compensated) continue;
      const auto values = exact_components(robot_, point, characteristics_[c].quantity);
      for (Eigen::Index j = 0; j < values.size(); ++j) components(first_row_[c] + j * count + p) = values(j);
    }
  }
  return true;
}

bool Response::exact(const SourceErrors& errors, Eigen::Ref<Eigen::VectorXd> components) const {
  const Machine machine = build(robot_, errors);
  const auto wants = [&](bool compensated) {
    return std::ranges::any_of(characteristics_, [&](const auto& c) { return c.compensated == compensated; });
  };
  if (wants(false) && !add_exact(machine, robot_.nominal(), false, components)) return false;
  if (!wants(true)) return true;
  return add_exact(machine, build(robot_, without_tilt_group(errors)), true, components);
}

}  // namespace paracal
