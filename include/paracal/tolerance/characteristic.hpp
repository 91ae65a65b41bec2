#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "paracal/kinematics/error_model.hpp"
#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// A quantity that requirements limit. A characteristic is the length of a vector of one to three components, each
/// linear in the errors to first order. "Of the plate" is relative to the commanded pose, about the axes of {O}.
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
  /// After exact identification and compensation of the position group: only the effect of the tilt group remains,
  /// G_de dp_e and G_ee dp_e  [huang2016, Eqs. (5), (6)]. Not for limbs with one rod, whose errors can all be
  /// compensated.
  bool compensated = false;

  bool operator==(const Characteristic&) const = default;
};

/// "tilt", "position", "position-compensated", ...
std::string name(Characteristic characteristic);
std::optional<Characteristic> characteristic_named(std::string_view wanted);
Unit unit(Quantity quantity);
int component_count(Quantity quantity);

/// Components of a characteristic, one row each, against the parameters of the robot; mm and rad.
using SourceRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3,
                                 static_cast<int>(kMostSources) * kMaxLimbs>;

/// Why a robot has no such characteristic; empty if it has. Rotation needs a slide; `compensated` needs a level
/// plate.
std::string_view why_not_asked(const Robot& robot, Characteristic characteristic);

/// Derivative of characteristics with respect to the source errors of the nominal robot  [huang2016, Eqs. (5), (6)]; of
/// plates on struts by exact_jacobian().
class LinearModel {
 public:
  explicit LinearModel(const Robot& robot);

  /// @throws Unreachable for a pose that is out of reach or singular, InvalidArgument for a characteristic that it
  /// does not have.
  SourceRows rows(const Pose& pose, Characteristic characteristic) const;
  /// All three turns of the plate about x, y and z of {O}, zero for those that guides prevent.
  /// @throws Unreachable likewise.
  SourceRows turns(const Pose& pose) const;

 private:
  /// Plate on struts: (dr, eps), one column per geometric error.
  using OnStruts =
      Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, static_cast<int>(kMostSources) * kMaxLimbs>;
  using AtPose = std::variant<ErrorModel, OnStruts>;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxLimbs,
                                static_cast<int>(kMostSources) * kMaxLimbs>;

  AtPose at(const Pose& pose) const;
  Columns motion(const AtPose& at, bool compensated) const;
  Columns turn(const AtPose& at) const;

  Robot robot_;  ///< a copy: the caller may give a temporary
  AtPose home_;
};

/// A commanded pose and the actual pose of a machine.
struct Reached {
  Pose commanded;
  Eigen::Vector3d position;       ///< mm
  Eigen::Vector3d tilt;           ///< rotation of the plate relative to it, about x, y and z of {O}, rad
  double rotation = 0.0;          ///< rad
  Eigen::Vector3d home_position;  ///< actual position for the centre of the workspace
};

/// The exact components that rows() linearises.
Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1> exact_components(const Robot& robot,
                                                                                 const Reached& reached,
                                                                                 Quantity quantity);

}  // namespace paracal
