#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/kinematics/error_model.hpp"
#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// What a customer may ask to be small. A characteristic is the length of a vector of one to three components, each
/// linear in the source errors to first order.
enum class Quantity : std::uint8_t {
  tilt,      ///< eps_theta = |(eps_x, eps_y)| of the plate, rad  [huang2016, section 3.1]
  twist,     ///< |eps_z| of the plate, rad
  position,  ///< |dr| in the base frame, mm
  distance,  ///< |d_rho|: change of the distance to the workspace's centre, mm
  rotation,  ///< |d_phi| = |ds| / r_g of the end-effector, rad; robots with a slide only
};

inline constexpr std::array<Quantity, 5> kQuantities{Quantity::tilt, Quantity::twist, Quantity::position,
                                                     Quantity::distance, Quantity::rotation};

struct Characteristic {
  Quantity quantity = Quantity::tilt;
  /// After the position group has been identified without error and compensated: only what the tilt group does remains,
  /// G_de dp_e and G_ee dp_e  [huang2016, Eqs. (5), (6)].
  bool compensated = false;

  bool operator==(const Characteristic&) const = default;
};

/// "tilt", "position", "position-compensated", ...
std::string name(Characteristic characteristic);
std::optional<Characteristic> characteristic_named(std::string_view wanted);
Unit unit(Quantity quantity);
int component_count(Quantity quantity);

/// Components of a characteristic, a row each, against the source errors, 14 a limb; mm and rad.
using SourceRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3,
                                 static_cast<int>(kSourceCount) * kMaxLimbs>;

/// Derivative of characteristics with respect to the source errors of the nominal robot  [huang2016, Eqs. (5), (6)].
class LinearModel {
 public:
  explicit LinearModel(const Robot& robot);

  /// @throws Unreachable for a pose that the robot does not reach regularly, InvalidArgument for the rotation of a
  /// rigid plate.
  SourceRows rows(const Pose& pose, Characteristic characteristic) const;

 private:
  ErrorModel model_at(const Pose& pose) const;

  Robot robot_;  ///< its own: a caller may give a temporary
  ErrorModel home_;
  std::array<double, kSourceCount> scale_{};
};

/// The pose as commanded, and where a machine really puts its plate.
struct Reached {
  Pose commanded;
  Eigen::Vector3d position;       ///< mm
  Eigen::Vector3d tilt;           ///< rad
  double rotation = 0.0;          ///< rad
  Eigen::Vector3d home_position;  ///< where it puts its plate when the workspace's centre is commanded
};

/// The exact components that rows() linearises.
Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1> exact_components(const Robot& robot,
                                                                                 const Reached& reached,
                                                                                 Quantity quantity);

}  // namespace paracal
