#include "paracal/tolerance/characteristic.hpp"

#include <fmt/format.h>

#include "paracal/error.hpp"

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

constexpr Eigen::Index kSources = static_cast<Eigen::Index>(kSourceCount);
constexpr Eigen::Index kPosition = ErrorModel::kPosition, kTilt = ErrorModel::kTilt;

/// Derivative of (dr, ds) or of (eps_x, eps_y, eps_z), a column a source error in mm or rad.
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxLimbs,
                              static_cast<int>(kSourceCount) * kMaxLimbs>;
template <typename Position, typename Tilt>
Columns all_columns(const Position* position, const Tilt& tilt, const std::array<double, kSourceCount>& scale) {
  const Eigen::Index limbs = tilt.cols() / kTilt;
  Columns columns = Columns::Zero(tilt.rows(), limbs * kSources);
  for (Eigen::Index limb = 0; limb < limbs; ++limb) {
    for (Eigen::Index k = 0; k < kSources; ++k) {
      auto column = columns.col(limb * kSources + k);
      if (k >= kPosition) {
        column = tilt.col(limb * kTilt + k - kPosition);
      } else if (position != nullptr) {
        column = position->col(limb * kPosition + k);
      }
      column *= scale[static_cast<std::size_t>(k)];
    }
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

LinearModel::LinearModel(const Robot& robot) : robot_(robot), home_(model_at(home_of(robot))) {
  for (const Source source : all_sources()) scale_[index(source)] = paper_scale(robot, source);
}

ErrorModel LinearModel::model_at(const Pose& pose) const {
  ErrorModel model = error_model(robot_, pose);
  if (!model.ok()) {
    throw Unreachable(fmt::format("pose ({:g}, {:g}, {:g}) mm: the robot is {} there", pose.position.x(),
                                  pose.position.y(), pose.position.z(),
                                  model.status == ErrorModelStatus::singular ? "singular" : "out of reach"));
  }
  return model;
}

SourceRows LinearModel::rows(const Pose& pose, Characteristic characteristic) const {
  const ErrorModel model = model_at(pose);
  const auto tilt = [&] { return all_columns<decltype(model.G_dd)>(nullptr, model.G_ee, scale_); };
  const auto motion = [&](const ErrorModel& at) {
    return all_columns(characteristic.compensated ? nullptr : &at.G_dd, at.G_de, scale_);
  };
  switch (characteristic.quantity) {
    case Quantity::tilt:
      return tilt().topRows<2>();
    case Quantity::twist:
      return tilt().bottomRows<1>();
    case Quantity::position:
      return motion(model).topRows<3>();
    case Quantity::distance: {
      const Eigen::Vector3d way = pose.position - home_of(robot_).position;
      const Eigen::Vector3d direction = way.norm() > 0.0 ? Eigen::Vector3d(way.normalized()) : way;
      return direction.transpose() * (motion(model).topRows<3>() - motion(home_).topRows<3>());
    }
    case Quantity::rotation:
      if (!robot_.slide()) throw InvalidArgument("rotation: expected a robot with a slide, got a rigid plate");
      return motion(model).bottomRows<1>() / robot_.slide()->pinion_radius;
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
