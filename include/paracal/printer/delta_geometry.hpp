#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "paracal/mechanism/machine.hpp"
#include "paracal/numerics/least_squares.hpp"

namespace paracal {

/// Parameters of a delta printer in its firmware: perfect joints, one rod per tower. Mm and rad, in the firmware's
/// frame: z up, 0 on the bed, tower C at its angle by definition. machine_of() makes a robot of them.
struct DeltaGeometry {
  Actuator actuator = Actuator::linear;
  double radius = 0.0;  ///< from the nozzle, at the centre, to a carriage's joints or to a shoulder
  std::array<double, 3> tower_angle{};
  std::array<double, 3> rod{};
  std::array<double, 3> endstop{};   ///< height of the nozzle with this joint at its endstop, by this tower alone
  std::array<double, 3> arm{};       ///< of rotary deltas only
  std::array<double, 3> shoulder{};  ///< likewise: heights of the motor axes above the bed, less the effector's
};

/// The robot of these parameters, in the firmware's frame: three limbs with one rod each, which hold the nozzle.
///
///   base i    radius u_i, of arms + shoulder_i e_z;  u_i = (cos, sin, 0) of tower_angle_i
///   frame i   columns u_i, e_z, u_i x e_z;  the plate joint is the nozzle
///   joint i   -drop_i; joint_offset_i: the homed joint, which holds the rod's end at (0, 0, endstop_i)
Machine machine_of(const DeltaGeometry& geometry);

/// Largest distance of the nozzle from the centre, mm: all parts end to end.
double reach(const DeltaGeometry& geometry);

/// Distance of each joint below its endstop, mm or rad: the steps that the controller counted, times their size.
using JointDrops = std::array<double, 3>;

/// The nearest design angle of a tower, rad: 30 deg and every 60 deg from there.
double design_angle(double angle);

/// Mean over the three towers.
inline double mean_of(const std::array<double, 3>& towers) { return (towers[0] + towers[1] + towers[2]) / 3.0; }

/// Joint coordinates at the endstops; NaN if a rod does not reach the centre.
std::array<double, 3> homed_joints(const DeltaGeometry& geometry);

/// Drops with which the firmware goes to a point, elbows outward and above it. Empty if a tower does not reach it.
std::optional<JointDrops> drops_to(const DeltaGeometry& geometry, const Eigen::Vector3d& place);

/// The endstop for a homed joint of one tower; NaN if its rod does not reach the centre.
double endstop_of(const DeltaGeometry& geometry, std::size_t tower, double homed);

/// Nozzle position computed by the firmware: forward() of the robot. Empty if the three spheres have no common point,
/// or more than two, and where forward() does not settle, above rods that are nearly level.
std::optional<Eigen::Vector3d> nozzle(const DeltaGeometry& geometry, const JointDrops& drops);

/// The numbers of a geometry: endstops A B C, angles A and B, radius, rods A B C, height of all shoulders (their mean),
/// arms A B C; mm and rad. A linear delta has the first nine and ignores the rest. The angle of tower C stays.
struct DeltaNumber {
  static constexpr Eigen::Index endstop = 0, angle = 3, radius = 5, rod = 6, shoulder = 9, arm = 10, count = 13;
};
using DeltaNumbers = Eigen::Matrix<double, DeltaNumber::count, 1>;
DeltaNumbers numbers_of(const DeltaGeometry& geometry);
DeltaGeometry with_numbers(DeltaGeometry geometry, const DeltaNumbers& numbers);

/// Directions in the numbers that a fit may change. One column each.
using DeltaBasis = Eigen::Matrix<double, DeltaNumber::count, Eigen::Dynamic, 0, DeltaNumber::count, DeltaNumber::count>;

/// d nozzle / d numbers, from the closure of the rods, d_i from elbow i to the nozzle p,
///
///   \f[ d_i.dp = d_i.dc_i + rod_i d(rod_i) \f]
///
/// with elbow i at c_i, which moves with the numbers of its limb and with its homed joint.
/// @param place  nozzle(geometry, drops).
using NozzleJacobian = Eigen::Matrix<double, 3, DeltaNumber::count>;
NozzleJacobian nozzle_jacobian(const DeltaGeometry& geometry, const JointDrops& drops, const Eigen::Vector3d& place);

/// The nozzle touched the bed (a probe that reads `height` there, or a sheet of paper).
struct BedReading {
  double height = 0.0;  ///< of the nozzle above the bed, mm
  JointDrops drops{};
  bool by_hand = false;  ///< typed, not probed: the firmware does not count it in the weight

  bool operator==(const BedReading&) const = default;
};

/// A calliper's distance between two places where the nozzle has printed.
struct PrintedDistance {
  /// Shortest distance that can be measured, mm.
  static constexpr double kShortest = 1.0;

  double distance = 0.0;  ///< mm
  JointDrops from{}, to{};

  bool operator==(const PrintedDistance&) const = default;
};

struct DeltaReadings {
  std::vector<BedReading> heights = {};
  std::vector<PrintedDistance> distances = {};
};

/// How well a geometry explains readings, as Klipper's delta_calibrate judges it [klipper]:
///
///   \f[ cost = w sum (z - height)^2 + sum (|p_to - p_from| - distance)^2,    w = 2 n_distances / n_probed \f]
///
/// and w = 1 without distances or without heights.
struct DeltaFit {
  LeastSquaresStatus status = LeastSquaresStatus::not_evaluable;
  DeltaGeometry geometry;
  double cost = 0.0;          ///< mm^2
  double rms_height = 0.0;    ///< mm; 0 without heights
  double rms_distance = 0.0;  ///< mm; 0 without distances
  int parameters = 0;         ///< see firmware_basis()

  bool ok() const { return status == LeastSquaresStatus::converged; }
};

/// Parameters that this firmware fits. Linear: radius, angles, endstops; with distances also the rods. Rotary: height
/// of the shoulders, endstops; with distances also radius and angles.
DeltaBasis firmware_basis(Actuator actuator, bool with_distances);

/// The cost of a geometry as it is. Not evaluable if the spheres of a reading have no common point.
DeltaFit judge_as_firmware(const DeltaGeometry& geometry, const DeltaReadings& readings);

/// The optimum of the firmware's coordinate descent, by Levenberg-Marquardt with analytic derivatives.
/// @param start  a geometry near it, such as that of the firmware.
/// @throws InvalidArgument without heights: distances alone do not determine the bed.
DeltaFit fit_as_firmware(const DeltaGeometry& start, const DeltaReadings& readings);

}  // namespace paracal
