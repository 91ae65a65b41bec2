#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "paracal/mechanism/differentiable_machine.hpp"
#include "paracal/mechanism/limb_description.hpp"
#include "paracal/mechanism/parameter.hpp"
#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/tolerances.hpp"
#include "paracal/mechanism/workspace.hpp"

namespace paracal {

/// "x, y, tilt_z"
std::string in_words(const PlateFreedoms& freedoms);

/// Why a plate with these degrees of freedom is no robot: its motions are coupled. Empty where it is one.
std::string coupled_motions(const PlateFreedoms& freedoms);

/// The slide of an articulated plate: subparts 1 and 2 move apart along an axis and a rack and pinion turns that
/// into rotation, phi = s / r_g. With s > 0 the plate joints of limb i stand at a_i + mu_i s shat in the plate frame.
struct Slide {
  Eigen::Vector3d axis;        ///< unit vector shat in the plate frame
  std::vector<double> sign;    ///< mu_i: +1 or -1 a limb
  double pinion_radius = 0.0;  ///< r_g, mm
};

/// Limits of drives and mechanics, rad/s and rad/s^2 or mm/s and mm/s^2.
struct JointLimits {
  double speed = 0.0, acceleration = 0.0;

  bool operator==(const JointLimits&) const = default;
};

/// The description of a robot before it is checked. `slide` empty means a rigid plate (Delta).
struct RobotDescription {
  std::string name;
  Limbs limbs;
  PlateFreedoms freedoms = {};  ///< of the plate, without its slide
  std::optional<Slide> slide;
  Workspace workspace;
  std::optional<Tolerances> tolerances;
  /// Where the controller's coordinates, and so a program's, begin in the base frame, mm.
  Eigen::Vector3d controller_origin = Eigen::Vector3d::Zero();
  /// Of every joint, if known.
  std::optional<JointLimits> joint_limits = {};
  /// See BasicMachine::hang; Robot sets it.
  Eigen::Vector3d hang = Eigen::Vector3d::Zero();
};

/// A valid nominal robot: every length is positive, the limbs differ, reach the whole workspace and hold the plate
/// everywhere in it. There are at least as many limbs as the plate has degrees of freedom; joints of all limbs have the
/// same unit. Immutable.
class Robot {
 public:
  /// @throws InvalidArgument naming the quantity and the limit that it breaks.
  explicit Robot(RobotDescription description);

  const RobotDescription& description() const { return description_; }
  const std::string& name() const { return description_.name; }
  const Limbs& limbs() const { return description_.limbs; }
  const PlateFreedoms& freedoms() const { return description_.freedoms; }
  const std::optional<Slide>& slide() const { return description_.slide; }
  const Workspace& workspace() const { return description_.workspace; }
  const std::optional<Tolerances>& tolerances() const { return description_.tolerances; }
  const Eigen::Vector3d& controller_origin() const { return description_.controller_origin; }
  const std::optional<JointLimits>& joint_limits() const { return description_.joint_limits; }
  std::size_t limb_count() const { return description_.limbs.size(); }
  Actuator actuator() const { return actuator_of(limbs()); }
  JointSpace joint_space() const;
  /// Largest distance of the plate from the base, mm: the sum of all parts, or the end of the workspace if rails are
  /// longer.
  double reach() const;
  /// Parallelograms alone keep the plate level: the robots of [huang2016], whose errors fall apart into two groups.
  bool is_level() const { return nominal_.is_level; }
  /// Some tilt of the plate is commanded.
  bool commands_tilt() const { return nominal_.commands_tilt(); }

  /// The machine without geometric errors, as the controller assumes it.
  const DifferentiableMachine& nominal() const { return nominal_; }

  /// Every source error of every limb, limb by limb in the order of sources_of().
  std::span<const Parameter> parameters() const { return parameters_; }
  /// @throws InvalidArgument for a limb that does not have it.
  const Parameter& parameter(std::size_t limb, Source source) const;

 private:
  RobotDescription description_;
  DifferentiableMachine nominal_;
  std::vector<Parameter> parameters_;
};

/// Upper limit of any error: half a turn, or the size of the robot (base radius + arm + rod), rad or
/// mm.
double largest_error(const Limbs& limbs, Source source);

/// Why such a machine is impossible: a length of zero or less, an angle error of half a turn, or a position error
/// above the size of the robot. Empty if it is possible.
std::optional<std::string> implausible(const Robot& robot, const SourceErrors& errors);

/// The robot's tolerances; default tolerances if it states none.
Tolerances tolerances_of(const Robot& robot);

}  // namespace paracal
