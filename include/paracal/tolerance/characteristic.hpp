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

/// What a customer may ask to be small. A characteristic is the length of a vector of one to three components, each
/// linear in the source errors to first order. "Of the plate" is relative to the commanded pose, about the axes of {O}.
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
  /// G_de dp_e and G_ee dp_e  [huang2016, Eqs. (5), (6)]. Nothing remains of a plate on struts, whose errors can all be
  /// compensated: there it is not asked for.
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

/// Whether it can be asked of a robot: rotation of one with a slide, what is left behind compensation where the plate
/// stays level. Why not, or empty.
std::string_view why_not_asked(const Robot& robot, Characteristic characteristic);

/// Derivative of characteristics with respect to the source errors of the nominal robot  [huang2016, Eqs. (5), (6)]; of
/// plates on struts by exact_jacobian().
class LinearModel {
 public:
  explicit LinearModel(const Robot& robot);

  /// @throws Unreachable for a pose that the robot does not reach regularly, InvalidArgument for what cannot be asked
  /// of it.
  SourceRows rows(const Pose& pose, Characteristic characteristic) const;
  /// All three turns of the plate about x, y and z of {O}, zero of those that guides keep it from.
  /// @throws Unreachable likewise.
  SourceRows turns(const Pose& pose) const;

 private:
  /// Of a plate on struts: (dr, eps), a column a source error.
  using OnStruts =
      Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, static_cast<int>(kSourceCount) * kMaxLimbs>;
  using AtPose = std::variant<ErrorModel, OnStruts>;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxLimbs,
                                static_cast<int>(kSourceCount) * kMaxLimbs>;

  AtPose at(const Pose& pose) const;
  Columns motion(const AtPose& at, bool compensated) const;
  Columns turn(const AtPose& at) const;

  Robot robot_;  ///< its own: a caller may give a temporary
  AtPose home_;
  std::array<double, kSourceCount> scale_{};
};

/// The pose as commanded, and where a machine really puts its plate.
struct Reached {
  Pose commanded;
  Eigen::Vector3d position;       ///< mm
  Eigen::Vector3d tilt;           ///< how far the plate is turned away from it about x, y and z of {O}, rad
  double rotation = 0.0;          ///< rad
  Eigen::Vector3d home_position;  ///< where it puts its plate when the workspace's centre is commanded
};

/// The exact components that rows() linearises.
Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1> exact_components(const Robot& robot,
                                                                                 const Reached& reached,
                                                                                 Quantity quantity);

}  // namespace paracal
