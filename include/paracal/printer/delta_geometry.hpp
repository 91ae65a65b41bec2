#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "paracal/calibration/least_squares.hpp"

namespace paracal {

/// What the firmware of a linear-delta printer knows of its machine: perfect vertical towers on one circle, three rods.
/// Mm and rad, in the firmware's frame: z up, 0 on the bed, tower C at its angle by definition.
///
///   tower i     (radius cos a_i, radius sin a_i)
///   carriage    endstop_i + sqrt(arm_i^2 - radius^2) - drop_i
///   nozzle      the lower point one arm_i away from all three carriages
struct DeltaGeometry {
  double radius = 0.0;                  ///< delta radius: from the nozzle, at the centre, to a carriage's joints
  std::array<double, 3> tower_angle{};  ///< rad
  std::array<double, 3> arm{};          ///< rods
  std::array<double, 3> endstop{};      ///< height of the nozzle with this carriage at its endstop, by this tower alone
};

/// How far each carriage stands below its endstop, mm: the steps that the controller counted, times their length.
using CarriageDrops = std::array<double, 3>;

/// Where the firmware believes the nozzle. Empty when the three spheres have no point in common.
std::optional<Eigen::Vector3d> nozzle(const DeltaGeometry& geometry, const CarriageDrops& drops);

/// d nozzle / d (radius, angles A and B, endstops A B C, arms A B C), mm per mm or rad, from
///   (p - c_i).dp = (p - c_i).dc_i + arm_i d(arm_i),    c_i: carriage i.
/// @param place  nozzle(geometry, drops).
using NozzleJacobian = Eigen::Matrix<double, 3, 9>;
NozzleJacobian nozzle_jacobian(const DeltaGeometry& geometry, const CarriageDrops& drops, const Eigen::Vector3d& place);

/// A geometry as these nine numbers, and back: the angle of tower C stays. With fewer numbers the arms stay, too.
Eigen::Matrix<double, 9, 1> numbers_of(const DeltaGeometry& geometry);
DeltaGeometry with_numbers(DeltaGeometry geometry, const Eigen::VectorXd& numbers);

/// The nozzle touched the bed (a probe that reads `height` there, or a sheet of paper).
struct BedReading {
  double height = 0.0;  ///< of the nozzle above the bed, mm
  CarriageDrops drops{};
};

/// A calliper's distance between two places where the nozzle has printed.
struct PrintedDistance {
  double distance = 0.0;  ///< mm
  CarriageDrops from{}, to{};
};

struct DeltaReadings {
  std::vector<BedReading> heights = {};
  std::vector<PrintedDistance> distances = {};
};

/// How well a geometry explains readings, as Klipper's delta_calibrate judges it [klipper]:
///
///   cost = w sum (z - height)^2 + sum (|p_to - p_from| - distance)^2,    w = 2 n_distances / n_heights; 1 without any
struct DeltaFit {
  LeastSquaresStatus status = LeastSquaresStatus::not_evaluable;
  DeltaGeometry geometry;
  double cost = 0.0;          ///< mm^2
  double rms_height = 0.0;    ///< mm; 0 without heights
  double rms_distance = 0.0;  ///< mm; 0 without distances
  int parameters = 0;         ///< 6 (radius, angles A and B, endstops), with distances also the 3 arms
  int iterations = 0;

  bool ok() const { return status == LeastSquaresStatus::converged; }
};

/// The cost of a geometry as it is. Not evaluable where some reading's spheres have no point in common.
DeltaFit judge_as_firmware(const DeltaGeometry& geometry, const DeltaReadings& readings);

/// The optimum that the firmware's coordinate descent creeps towards, by Levenberg-Marquardt with analytic derivatives.
/// @param start  a geometry near it, as the one that the firmware has.
/// @throws InvalidArgument without heights: distances alone do not say where the bed is.
DeltaFit fit_as_firmware(const DeltaGeometry& start, const DeltaReadings& readings);

}  // namespace paracal
