#include "paracal/tolerance/response.hpp"

#include <algorithm>
#include <array>

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
  linear_.resize(rows, static_cast<Eigen::Index>(robot.parameters().size()));
  const LinearModel model(robot);
  for (std::size_t c = 0; c < characteristics_.size(); ++c) {
    for (Eigen::Index p = 0; p < count; ++p) {
      const SourceRows at_pose = model.rows(poses_[static_cast<std::size_t>(p)], characteristics_[c]);
      for (Eigen::Index j = 0; j < at_pose.rows(); ++j) linear_.row(first_row_[c] + j * count + p) = at_pose.row(j);
    }
  }
}

SentMachine::SentMachine(const Robot& robot, const SourceErrors& errors, bool compensated)
    : machine_(build(robot, errors)),
      believed_(compensated ? build(robot, without_tilt_group(errors)) : Machine(robot.nominal())),
      home_(drive(machine_, believed_, {robot.workspace().centre(), 0.0})) {}

std::optional<Reached> SentMachine::at(const Pose& commanded) const {
  if (!home_) return std::nullopt;
  const std::optional<PlateState> plate = drive(machine_, believed_, commanded);
  if (!plate) return std::nullopt;
  return Reached{commanded, plate->position, turned_away(machine_, commanded, *plate),
                 machine_.rotation_of(plate->slide), home_->position};
}

bool Response::add_exact(const SourceErrors& errors, bool compensated, Eigen::Ref<Eigen::VectorXd> components) const {
  const SentMachine machine(robot_, errors, compensated);
  const auto count = static_cast<Eigen::Index>(poses_.size());
  for (Eigen::Index p = 0; p < count; ++p) {
    const std::optional<Reached> point = machine.at(poses_[static_cast<std::size_t>(p)]);
    if (!point) return false;
    for (std::size_t c = 0; c < characteristics_.size(); ++c) {
      if (characteristics_[c].compensated != compensated) continue;
      const auto values = exact_components(robot_, *point, characteristics_[c].quantity);
      for (Eigen::Index j = 0; j < values.size(); ++j) components(first_row_[c] + j * count + p) = values(j);
    }
  }
  return true;
}

Eigen::ArrayXXd Response::squared_lengths(std::size_t characteristic, const Eigen::MatrixXd& components) const {
  const auto poses = static_cast<Eigen::Index>(poses_.size());
  const Eigen::Index first = first_row_[characteristic];
  Eigen::ArrayXXd squared = components.middleRows(first, poses).array().square();
  for (int j = 1; j < component_count(characteristics_[characteristic].quantity); ++j) {
    squared += components.middleRows(first + j * poses, poses).array().square();
  }
  return squared;
}

bool Response::exact(const SourceErrors& errors, Eigen::Ref<Eigen::VectorXd> components) const {
  return std::ranges::all_of(std::array{false, true}, [&](bool compensated) {
    const bool wanted =
        std::ranges::any_of(characteristics_, [&](const auto& c) { return c.compensated == compensated; });
    return !wanted || add_exact(errors, compensated, components);
  });
}

}  // namespace paracal
