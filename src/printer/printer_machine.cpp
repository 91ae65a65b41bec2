#include "paracal/printer/printer_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "paracal/error.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

constexpr std::array<double, 3> kDesignAngles{to_radians(210.0), to_radians(330.0), to_radians(90.0)};

double mean_of(const std::array<double, 3>& values) { return std::accumulate(values.begin(), values.end(), 0.0) / 3.0; }

/// Of the elbows above the bed with the carriages at their endstops.
std::array<double, 3> homed_heights(const DeltaGeometry& g) {
  std::array<double, 3> heights{};
  for (std::size_t i = 0; i < 3; ++i) {
    heights[i] = g.endstop[i] + std::sqrt(g.arm[i] * g.arm[i] - g.radius * g.radius);
  }
  return heights;
}

Joints joints_at(const CarriageDrops& drops) {
  Joints joints(3);
  joints << -drops[0], -drops[1], -drops[2];
  return joints;
}

}  // namespace

PrinterMachine printer_machine(const DeltaGeometry& geometry, double print_radius) {
  constexpr double kReached = 0.9;  // of what the arms reach
  const Geometry usual = catalogue::linear_delta().geometry();
  const std::array<double, 3> heights = homed_heights(geometry);
  const double homed = mean_of(heights), rod = mean_of(geometry.arm);
  const double reach = kReached * (rod - geometry.radius);
  RobotDescription robot;
  robot.name = "printer";
  robot.geometry = usual;
  robot.geometry.arm = 0.0;
  robot.geometry.base_radius = geometry.radius + usual.plate_radius;
  robot.geometry.rod = rod;
  robot.workspace = {.radius = print_radius > 0.0 ? std::min(print_radius, reach) : reach,
                     .height = 0.5 * homed,
                     .top_z = -0.5 * homed};
  robot.tolerances = printer_tolerances(usual.parallelogram_width);
  PrinterMachine printer{.robot = Robot(std::move(robot)), .assumed = {}, .bed = -homed};
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = geometry.tower_angle[i], design = kDesignAngles[i];
    printer.assumed(i, Source::e_x) = geometry.radius * (std::cos(angle) - std::cos(design));
    printer.assumed(i, Source::e_y) = geometry.radius * (std::sin(angle) - std::sin(design));
    printer.assumed(i, Source::rod_mean) = geometry.arm[i] - rod;
    printer.assumed(i, Source::theta_offset) = heights[i] - homed;
  }
  return printer;
}

Tolerances printer_tolerances(double parallelogram_width) {
  Tolerances tolerances;
  tolerances[Source::theta_offset] = 10.0;
  tolerances[Source::e_x] = tolerances[Source::e_y] = tolerances[Source::e_z] = 0.3;
  tolerances[Source::alpha0] = tolerances[Source::beta0] = to_radians(0.04);
  tolerances[Source::rod_mean] = 0.1;
  tolerances[Source::rod_difference] = 2e-3 * parallelogram_width;
  tolerances[Source::width_difference] = 4e-3 * parallelogram_width;
  tolerances[Source::alpha03] = tolerances[Source::beta03] = tolerances[Source::alpha2] = tolerances[Source::beta2] =
      4e-3;
  return tolerances;
}

std::vector<CommonError> printer_common_errors(const Robot& robot, bool rods_too) {
  constexpr double kUnknown = 5.0;  // mm, standard deviation
  CommonError radius{.text = "delta radius", .direction = {}, .std = kUnknown};
  CommonError rods{.text = "length of the rods", .direction = {}, .std = kUnknown};
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    radius.direction(i, Source::e_x) = robot.nominal().limbs[i].radial.x();
    radius.direction(i, Source::e_y) = robot.nominal().limbs[i].radial.y();
    rods.direction(i, Source::rod_mean) = 1.0;
  }
  return rods_too ? std::vector{radius, rods} : std::vector{radius};
}

Measurements printer_measurements(const PrinterMachine& printer, const DeltaGeometry& geometry,
                                  const DeltaReadings& readings) {
  Measurements measurements;
  const auto add_station = [&](std::string name, const CarriageDrops& drops) {
    const auto place = nozzle(geometry, drops);
    if (!place) throw InvalidArgument(fmt::format("{}: the printer's arms do not meet there", name));
    const Eigen::Vector3d position = *place + Eigen::Vector3d(0.0, 0.0, printer.bed);
    measurements.stations.push_back({std::move(name), {position, 0.0}, joints_at(drops)});
    return measurements.stations.size() - 1;
  };
  if (!readings.heights.empty()) measurements.planes.push_back({"bed", {}});
  for (std::size_t k = 0; k < readings.heights.size(); ++k) {
    const BedReading& reading = readings.heights[k];
    const std::size_t station = add_station(fmt::format("height{}", k), reading.drops);
    measurements.planes.back().readings.push_back({.station = station, .height = reading.height});
  }
  for (std::size_t k = 0; k < readings.distances.size(); ++k) {
    const PrintedDistance& reading = readings.distances[k];
    const std::size_t from = add_station(fmt::format("distance{}_pos1", k), reading.from);
    const std::size_t to = add_station(fmt::format("distance{}_pos2", k), reading.to);
    measurements.distances.push_back({.from = from, .to = to, .distance = reading.distance});
  }
  return measurements;
}

CalibrationOptions printer_options(const Robot& robot, const DeltaReadings& readings) {
  CalibrationOptions options;
  options.stage = Stage::fine;
  options.noise.height = 0.02;
  options.noise.distance = 0.06;
  options.noise.distance_bias = 0.2;
  options.plane_slope = 0.5e-3;
  options.common = printer_common_errors(robot, !readings.distances.empty());
  return options;
}

}  // namespace paracal
