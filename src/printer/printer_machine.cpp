#include "paracal/printer/printer_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "paracal/error.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

bool reaches_all_around(const DeltaGeometry& geometry, double radius, double z) {
  constexpr int kAround = 12;
  for (int k = 0; k < kAround; ++k) {
    if (!drops_to(geometry, Workspace::on_circle(radius, 2.0 * std::numbers::pi * k / kAround, z))) return false;
  }
  return true;
}

/// From the bed to half the height of the homed nozzle, most of as far out as the printer goes all around.
Workspace workspace_of(const DeltaGeometry& geometry, double homed, double print_radius) {
  constexpr double kSmaller = 0.95, kUsed = 0.9, kLeast = 1.0;
  constexpr double kWithin = 1.0 - 1e-12;  // of a rod stretched out: rounding does not decide
  const double height = 0.5 * homed;
  double radius = kWithin * std::ranges::min(geometry.rod) - geometry.radius;
  while (radius > kLeast &&
         !(reaches_all_around(geometry, radius, 0.0) && reaches_all_around(geometry, radius, height))) {
    radius *= kSmaller;
  }
  radius *= kUsed;
  return {.radius = print_radius > 0.0 ? std::min(print_radius, radius) : radius, .height = height};
}

/// Towers at their design angles, everything else the mean of the three.
SharedDimensions design_of(const DeltaGeometry& geometry) {
  SharedDimensions design = *shared_dimensions(catalogue::linear_delta().limbs());
  design.actuator = geometry.actuator;
  design.arm = geometry.actuator == Actuator::linear ? 0.0 : mean_of(geometry.arm);
  design.base_radius = geometry.radius + design.plate_radius;
  design.rod = mean_of(geometry.rod);
  std::ranges::transform(geometry.tower_angle, design.limb_azimuth.begin(), design_angle);
  return design;
}

/// What makes limbs that are alike the firmware's: the design of mean lengths, its shoulders at the height `origin`.
SourceErrors differences(const DeltaGeometry& geometry, const SharedDimensions& design, double origin,
                         const Joints& homed) {
  const Machine firmware = machine_of(geometry);
  SourceErrors errors;
  for (std::size_t i = 0; i < 3; ++i) {
    const Limb& limb = firmware.limbs[i];
    const double azimuth = design.limb_azimuth[i], radius = design.base_radius - design.plate_radius;
    errors(i, "e_x") = limb.base[0] - radius * std::cos(azimuth);
    errors(i, "e_y") = limb.base[1] - radius * std::sin(azimuth);
    errors(i, "rod_mean") = limb.mean_rod() - design.rod;
    errors(i, "theta_offset") = limb.joint_offset - homed[static_cast<Eigen::Index>(i)];
    if (geometry.actuator == Actuator::linear) {
      errors(i, "theta_offset") -= origin;
      continue;
    }
    errors(i, "beta0") = geometry.tower_angle[i] - azimuth;  // the arm swings in the tower's plane
    errors(i, "e_z") = limb.base[2] - origin;
    errors(i, "arm_length") = limb.arm - design.arm;
  }
  return errors;
}

}  // namespace

Joints PrinterMachine::joints_at(const JointDrops& drops) const {
  Joints joints = homed;
  for (std::size_t i = 0; i < 3; ++i) joints[static_cast<Eigen::Index>(i)] -= drops[i];
  return joints;
}

PrinterMachine printer_machine(const DeltaGeometry& firmware, const DeltaGeometry& like, double print_radius) {
  const bool linear = like.actuator == Actuator::linear;
  const std::array<double, 3> at_endstops = homed_joints(like);
  const double origin = linear ? mean_of(at_endstops) : mean_of(like.shoulder);
  Joints homed = Joints::Zero(3);
  if (!linear) std::ranges::copy(at_endstops, homed.begin());
  RobotDescription robot;
  robot.name = "printer";
  robot.freedoms = kLevelPlate;
  const double height = linear ? origin : mean_of(like.endstop);
  robot.workspace = workspace_of(like, height, print_radius);
  robot.workspace.radius = std::min(robot.workspace.radius, workspace_of(firmware, height, print_radius).radius);
  robot.workspace.top_z = robot.workspace.height - origin;
  SharedDimensions design = design_of(like);
  design.differences = differences(firmware, design, origin, homed);
  robot.limbs = limbs_of(design);
  robot.tolerances = printer_tolerances(robot.limbs);
  robot.controller_origin = {0.0, 0.0, -origin};
  return {
      .robot = Robot(std::move(robot)), .design = SourceErrors{} - design.differences, .bed = -origin, .homed = homed};
}

Tolerances printer_tolerances(const Limbs& limbs) {
  const bool linear = actuator_of(limbs) == Actuator::linear;
  const double width = sizes_of(limbs).parallelogram_width;
  Tolerances tolerances;
  tolerances["theta_offset"] = linear ? 10.0 : to_radians(5.0);
  tolerances["e_x"] = tolerances["e_y"] = linear ? 1.5 : 0.3;
  tolerances["e_z"] = 0.3;
  tolerances["alpha0"] = tolerances["beta0"] = to_radians(linear ? 0.08 : 0.3);
  tolerances["arm_length"] = linear ? 0.0 : 0.1;  // of a rail the gain: firmware knows none
  tolerances["rod_mean"] = linear ? 0.5 : 0.1;
  const double assembly = linear ? 8e-3 : 4e-3;  // rad
  tolerances["rod_difference"] = 0.5 * assembly * width;
  tolerances["width_difference"] = assembly * width;
  tolerances["alpha03"] = tolerances["beta03"] = tolerances["alpha2"] = tolerances["beta2"] = assembly;
  tolerances.origin.values.fill(Origin::generous);
  if (linear) tolerances.origin["gain"] = Origin::exact;
  list_assumed(tolerances, limbs);
  return tolerances;
}

std::vector<CommonError> printer_common_errors(const Robot& robot, bool has_distances) {
  constexpr double kUnknown = 5.0, kTyped = 0.5;  // mm, standard deviations
  CommonError radius{.text = "delta radius", .direction = {}, .std = kUnknown};
  const double lengths = has_distances ? kUnknown : kTyped;
  CommonError rods{.text = "length of the rods", .direction = {}, .std = lengths};
  CommonError arms{.text = "length of the arms", .direction = {}, .std = lengths};
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    radius.direction(i, "e_x") = robot.nominal().limbs[i].radial[0];
    radius.direction(i, "e_y") = robot.nominal().limbs[i].radial[1];
    rods.direction(i, "rod_mean") = 1.0;
    arms.direction(i, "arm_length") = 1.0;
  }
  return robot.actuator() == Actuator::linear ? std::vector{radius, rods} : std::vector{radius, rods, arms};
}

Measurements printer_measurements(const PrinterMachine& printer, const DeltaGeometry& geometry,
                                  const DeltaReadings& readings) {
  Measurements measurements;
  const auto add_station = [&](std::string name, const JointDrops& drops) {
    const auto place = nozzle(geometry, drops);
    if (!place) throw InvalidArgument(fmt::format("{}: the printer's arms do not meet there", name));
    const Eigen::Vector3d position = *place + Eigen::Vector3d(0.0, 0.0, printer.bed);
    measurements.stations.push_back({std::move(name), {position, 0.0}, printer.joints_at(drops)});
    return measurements.stations.size() - 1;
  };
  if (!readings.heights.empty()) measurements.lengths.push_back({"bed", LengthKind::height});
  for (std::size_t k = 0; k < readings.heights.size(); ++k) {
    const BedReading& reading = readings.heights[k];
    const std::size_t station = add_station(fmt::format("height{}", k), reading.drops);
    measurements.lengths.back().readings.push_back({.station = station, .length = reading.height});
  }
  for (std::size_t k = 0; k < readings.distances.size(); ++k) {
    const PrintedDistance& reading = readings.distances[k];
    const std::size_t from = add_station(fmt::format("distance{}_pos1", k), reading.from);
    const std::size_t to = add_station(fmt::format("distance{}_pos2", k), reading.to);
    measurements.distances.push_back({.from = from, .to = to, .distance = reading.distance});
  }
  return measurements;
}

CalibrationOptions printer_options(const PrinterMachine& printer, const DeltaReadings& readings, bool seeks_bias) {
  CalibrationOptions options;
  options.diagnose = false;             // the firmware's own fit stands beside it
  options.seeks_discrepancies = false;  // firmware has geometry alone; readings that are held out judge it
  options.stage = Stage::fine;
  options.noise.height = 0.02;
  options.noise.distance = 0.05;
  options.noise.distance_bias = seeks_bias ? kDistanceBias : 0.0;
  options.plane_slope = 0.5e-3;
  options.common = printer_common_errors(printer.robot, !readings.distances.empty());
  options.expected = printer.design;
  options.controller = {.evidence = ControllerEvidence::stated, .source = "the firmware's settings"};
  return options;
}

}  // namespace paracal
