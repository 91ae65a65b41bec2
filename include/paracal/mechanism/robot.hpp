#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/parameter.hpp"
#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/tolerances.hpp"
#include "paracal/mechanism/workspace.hpp"

namespace paracal {

/// A nominal limb; mm. The drive moves the upper end of its rod, or of the bar of its parallelogram; the lower end is a
/// joint of the plate, or the middle of the bar there. Both bars lie along w_0 of frame_of().
struct LimbDescription {
  /// In the base frame. Of a strut the joint at the base; of an arm the centre of the circle on which the rod's upper
  /// end goes; of a rail where that end stands at joint coordinate 0.
  Eigen::Vector3d base = Eigen::Vector3d::Zero();
  Eigen::Vector3d plate = Eigen::Vector3d::Zero();    ///< joint at the plate, in the plate frame
  double length = 0.0;                                ///< of the rod; of a strut at joint coordinate 0
  double arm = 0.0;                                   ///< of an arm: the radius of that circle
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();     ///< of an arm's motor, turning right-handed; of a rail along it
  Eigen::Vector3d at_zero = Eigen::Vector3d::Zero();  ///< where an arm points at joint coordinate 0, square to its axis
  bool behind = false;  ///< a carriage that stands behind the joint at the plate, along the rail, and not ahead of it
  Actuator kind = Actuator::strut;
  double width = 0.0;  ///< of a parallelogram
};

/// "x, y, tilt_z"
std::string in_words(const PlateFreedoms& freedoms);

/// Why a plate with these degrees of freedom is no robot: its motions are coupled. Empty where it is one.
std::string coupled_motions(const PlateFreedoms& freedoms);

/// Base of a limb: columns u_0, v_0, w_0 in {O}. Of an arm: where it points at joint coordinate 0, where it goes from
/// there, the motor's axis. Of a rail: its upward normal (of one that stands upright: outward from the z axis), along
/// it, and w_0 = u_0 x v_0.
Eigen::Matrix3d frame_of(const LimbDescription& limb);

/// Nominal dimensions that all limbs share; mm and rad [huang2016, Table 1, in brackets].
struct Geometry {
  double base_radius = 0.0;          ///< circle of the base joints [b]
  double plate_radius = 0.0;         ///< circle of the plate joints [a]
  double arm = 0.0;                  ///< arm (proximal link) [L]; of a rail: inward from it to the elbow, may be 0
  double rod = 0.0;                  ///< rod of the parallelogram [l]
  double parallelogram_width = 0.0;  ///< short side of the parallelogram [c]
  std::vector<double> limb_azimuth;  ///< gamma_i, from x towards y
  Actuator actuator = Actuator::revolute;
  std::vector<LimbDescription> limbs = {};  ///< of limbs that share nothing; see geometry_of_limbs()
  PlateFreedoms freedoms = {};              ///< of a plate on these
};

/// The kinds of all limbs.
std::vector<Actuator> kinds_of(const Geometry& geometry);

/// The names of the source errors that some limb has, in column order.
std::vector<Source> sources_of(const Geometry& geometry);

/// The source with that name; empty when no limb has it.
std::optional<Source> source_named(std::string_view name, const Geometry& geometry);

/// The sources that share the name of this one: itself, or the coordinates of a point.
std::vector<Source> sharing(Source leading, const Geometry& geometry);

/// The geometry of a plate on limbs that share nothing. What the limbs of other robots share is here the size of
/// things: radii of the joints (root mean square), mean lengths of arms and rods, the width of the first parallelogram;
/// without one that of the plate; of a plate that is a point a tenth of a rod.
Geometry geometry_of_limbs(std::vector<LimbDescription> limbs, const PlateFreedoms& freedoms = {});

/// The same of limbs of one kind.
Geometry geometry_of_limbs(Actuator kind, std::vector<LimbDescription> limbs, const PlateFreedoms& freedoms = {});

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
  Geometry geometry;
  std::optional<Slide> slide;
  Workspace workspace;
  std::optional<Tolerances> tolerances;
  /// Intended differences of limbs from that geometry: rods of other lengths, inclined rails, values stored in a
  /// controller. Only the position group; geometric errors are relative to this.
  SourceErrors intended = {};
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
  const Geometry& geometry() const { return description_.geometry; }
  const std::optional<Slide>& slide() const { return description_.slide; }
  const Workspace& workspace() const { return description_.workspace; }
  const std::optional<Tolerances>& tolerances() const { return description_.tolerances; }
  const SourceErrors& intended() const { return description_.intended; }
  const Eigen::Vector3d& controller_origin() const { return description_.controller_origin; }
  const std::optional<JointLimits>& joint_limits() const { return description_.joint_limits; }
  std::size_t limb_count() const { return description_.geometry.limb_azimuth.size(); }
  Actuator actuator() const { return description_.geometry.actuator; }
  JointSpace joint_space() const;
  /// Largest distance of the plate from the base, mm: the sum of all parts, or the end of the workspace if rails are
  /// longer.
  double reach() const;
  /// Parallelograms alone keep the plate level: the robots of [huang2016], whose errors fall apart into two groups.
  bool is_level() const { return nominal_.is_level; }
  /// Some tilt of the plate is commanded.
  bool commands_tilt() const { return nominal_.commands_tilt(); }

  /// The machine without geometric errors, as the controller assumes it.
  const Machine& nominal() const { return nominal_; }

  /// Every source error of every limb, limb by limb in the order of sources_of().
  std::span<const Parameter> parameters() const { return parameters_; }
  /// @throws InvalidArgument for a limb that does not have it.
  const Parameter& parameter(std::size_t limb, Source source) const;

 private:
  RobotDescription description_;
  Machine nominal_;
  std::vector<Parameter> parameters_;
};

/// Upper limit of any error: half a turn, or the size of the robot (base radius + arm + rod), rad or
/// mm.
double largest_error(const Geometry& geometry, Source source);

/// Why such a machine is impossible: a length of zero or less, an angle error of half a turn, or a position error
/// above the size of the robot. Empty if it is possible.
std::optional<std::string> implausible(const Robot& robot, const SourceErrors& errors);

/// The robot's tolerances; default tolerances if it states none.
Tolerances tolerances_of(const Robot& robot);

}  // namespace paracal
