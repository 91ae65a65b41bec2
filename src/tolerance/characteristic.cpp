#include "paracal/tolerance/characteristic.hpp"

#include <fmt/format.h>

#include "paracal/error.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {
namespace {

constexpr std::string_view kCompensated = "-compensated";

std::string_view quantity_name(Quantity quantity) {
  switch (quantity) {
    case Quantity::tilt:
      return "tilt";
    case Quantity::twist:
      return "twist";
    case Quantity::position:
      return "position";
    case Quantity::distance:
      return "distance";
    case Quantity::rotation:
      return "rotation";
  }
  return "";
}

/// Of a limb; harmonics follow.
constexpr Eigen::Index kSources = ErrorModel::kPosition + ErrorModel::kTilt;
constexpr Eigen::Index kPosition = ErrorModel::kPosition, kTilt = ErrorModel::kTilt;

/// Derivative of (dr, ds) or of (eps_x, eps_y, eps_z), a column a source error in mm or rad.
template <typename Columns, typename Position, typename Tilt>
Columns all_columns(const Position* position, const Tilt& tilt, std::span<const Parameter> parameters) {
  Columns columns = Columns::Zero(tilt.rows(), std::ssize(parameters));
  Eigen::Index first = 0;  // of a limb
  for (Eigen::Index at = 0; at < columns.cols(); ++at) {
    const Parameter& one = parameters[static_cast<std::size_t>(at)];
    if (is_joint_zero(one.source)) first = at;
    const auto limb = static_cast<Eigen::Index>(one.limb);
    const Eigen::Index k = at - first;
    if (k >= kPosition && k < kSources) {
      columns.col(at) = tilt.col(limb * kTilt + k - kPosition);
    } else if (position != nullptr) {
      columns.col(at) = position->col(at - (limb + (k < kPosition ? 0 : 1)) * kTilt);
    }
    columns.col(at) *= one.lever;
  }
  return columns;
}

Pose home_of(const Robot& robot) { return {robot.workspace().centre(), 0.0}; }

}  // namespace

std::string name(Characteristic characteristic) {
  return fmt::format("{}{}", quantity_name(characteristic.quantity), characteristic.compensated ? kCompensated : "");
}

std::optional<Characteristic> characteristic_named(std::string_view wanted) {
  for (const Quantity quantity : kQuantities) {
    for (const bool compensated : {false, true}) {
      if (name({quantity, compensated}) == wanted) return Characteristic{quantity, compensated};
    }
  }
  return std::nullopt;
}

Unit unit(Quantity quantity) {
  return quantity == Quantity::position || quantity == Quantity::distance ? Unit::mm : Unit::rad;
}

int component_count(Quantity quantity) {
  switch (quantity) {
    case Quantity::tilt:
      return 2;
    case Quantity::position:
      return 3;
    default:
      return 1;
  }
}

std::string_view why_not_asked(const Robot& robot, Characteristic characteristic) {
  if (characteristic.quantity == Quantity::rotation && !robot.slide()) return "expected a robot with a slide";
  if (characteristic.compensated && !robot.is_level()) {
    return "expected a robot whose plate three or four parallelograms keep level: calibration corrects all errors of "
           "others";
  }
  if (!robot.nominal().has_guides) return {};
  const auto& free = robot.freedoms().free;
  if (characteristic.quantity == Quantity::tilt && !free[3] && !free[4]) {
    return "the guides prevent tilt: expected position or distance (--quantity or --problem)";
  }
  if (characteristic.quantity == Quantity::twist && !free[5]) {
    return "the guides prevent rotation: expected position or distance (--quantity or --problem)";
  }
  return {};
}

LinearModel::LinearModel(const Robot& robot) : robot_(robot), home_(at(home_of(robot))) {}

LinearModel::AtPose LinearModel::at(const Pose& pose) const {
  const auto refuse = [&](std::string_view what) {
    const Eigen::Vector3d& r = pose.position;
    throw Unreachable(fmt::format("pose ({:g}, {:g}, {:g}) mm: the robot is {} there", r.x(), r.y(), r.z(), what));
  };
  if (robot_.is_level()) {
    ErrorModel model = error_model(robot_, pose);
    if (!model.ok()) refuse(model.status == ErrorModelStatus::singular ? "singular" : "out of reach");
    return model;
  }
  const DifferentiableMachine& machine = robot_.nominal();
  const InverseResult joints = inverse(machine, pose);
  if (!joints.ok()) refuse("out of reach");
  const ExactJacobian exact = exact_jacobian(machine, plate_at(machine, pose), joints.joints);
  if (!exact.ok) refuse("singular");
  OnStruts columns = exact.plate;
  columns.bottomRows<3>() = plate_rotation(pose.tilt).axes * exact.plate.bottomRows<3>();
  return columns;
}

LinearModel::Columns LinearModel::motion(const AtPose& at, bool compensated) const {
  if (const auto* on_struts = std::get_if<OnStruts>(&at)) return on_struts->topRows<3>();
  const auto& model = std::get<ErrorModel>(at);
  return all_columns<Columns>(compensated ? nullptr : &model.G_dd, model.G_de, robot_.parameters());
}

LinearModel::Columns LinearModel::turn(const AtPose& at) const {
  if (const auto* on_struts = std::get_if<OnStruts>(&at)) return on_struts->bottomRows<3>();
  const auto& model = std::get<ErrorModel>(at);
  return all_columns<Columns, decltype(model.G_dd)>(nullptr, model.G_ee, robot_.parameters());
}

SourceRows LinearModel::turns(const Pose& pose) const { return turn(at(pose)); }

SourceRows LinearModel::rows(const Pose& pose, Characteristic characteristic) const {
  if (const std::string_view why = why_not_asked(robot_, characteristic); !why.empty()) {
    throw InvalidArgument(fmt::format("{}: {}, got {}", name(characteristic), why, robot_.name()));
  }
  const AtPose there = at(pose);
  switch (characteristic.quantity) {
    case Quantity::tilt:
      return turn(there).topRows<2>();
    case Quantity::twist:
      return turn(there).bottomRows<1>();
    case Quantity::position:
      return motion(there, characteristic.compensated).topRows<3>();
    case Quantity::distance: {
      const Eigen::Vector3d way = pose.position - home_of(robot_).position;
      const Eigen::Vector3d direction = way.norm() > 0.0 ? Eigen::Vector3d(way.normalized()) : way;
      return direction.transpose() * (motion(there, characteristic.compensated).topRows<3>() -
                                      motion(home_, characteristic.compensated).topRows<3>());
    }
    case Quantity::rotation:
      return motion(there, characteristic.compensated).bottomRows<1>() / robot_.slide()->pinion_radius;
  }
  return {};
}

Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1> exact_components(const Robot& robot,
                                                                                 const Reached& reached,
                                                                                 Quantity quantity) {
  using One = Eigen::Matrix<double, 1, 1>;
  const Eigen::Vector3d& at = reached.commanded.position;
  switch (quantity) {
    case Quantity::tilt:
      return reached.tilt.head<2>();
    case Quantity::twist:
      return reached.tilt.tail<1>();
    case Quantity::position:
      return reached.position - at;
    case Quantity::distance:
      return One((reached.position - reached.home_position).norm() - (at - home_of(robot).position).norm());
    case Quantity::rotation:
      return One(reached.rotation - reached.commanded.rotation);
  }
  return {};
}

}  // namespace paracal
