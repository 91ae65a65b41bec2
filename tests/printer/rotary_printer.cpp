#include "printer/rotary_printer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::test {
namespace {

constexpr double kJointStep = 2.0 * std::numbers::pi / (200.0 * 16.0 * 5.0 * 3.75);
constexpr double kBedRadius = 100.0, kWall = 0.1, kRotaryProbe = 0.02, kRotaryCalliper = 0.05;

Eigen::Vector3d on_bed(double radius, double degrees) { return Workspace::on_circle(radius, to_radians(degrees), 0.0); }

JointDrops whole_joint_steps(const JointDrops& drops) {
  JointDrops whole{};
  for (std::size_t i = 0; i < 3; ++i) whole[i] = kJointStep * std::round(drops[i] / kJointStep);
  return whole;
}

/// Where the real nozzle touches the bed below a place.
JointDrops touching(const RotaryPrinter& printer, const Machine& machine, const Eigen::Vector3d& place) {
  const InverseResult joints = inverse(machine, {place + Eigen::Vector3d(0.0, 0.0, printer.machine.bed), 0.0});
  JointDrops drops{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    drops[i] = printer.machine.homed[k] - joints.joints[k];
  }
  return whole_joint_steps(drops);
}

/// Where the firmware prints a pillar that is meant to stand at a place.
JointDrops printing(const RotaryPrinter& printer, const Eigen::Vector3d& place) {
  return whole_joint_steps(*drops_to(printer.saved, place));
}

void read_heights(RotaryPrinter& printer, const Machine& machine, Random& random) {
  for (int k = 0; k < 13; ++k) {
    const double radius = k == 0 ? 0.0 : k % 2 == 0 ? 0.55 * kBedRadius : kBedRadius;
    const Eigen::Vector3d noise(0.0, 0.0, random.normal(kRotaryProbe));
    printer.readings.heights.push_back({0.0, touching(printer, machine, on_bed(radius, 30.0 * k) + noise)});
  }
}

void measure_distances(RotaryPrinter& printer, const Machine& machine, Random& random) {
  const auto real = [&](const JointDrops& drops) {
    return forward(machine, printer.machine.joints_at(drops)).plate.position;
  };
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector3d from = on_bed(k < 6 ? 0.0 : 0.8 * kBedRadius, 60.0 * k);
    const Eigen::Vector3d to = on_bed(0.8 * kBedRadius, 60.0 * k + (k < 6 ? 0.0 : 60.0));
    PrintedDistance one{.from = printing(printer, from), .to = printing(printer, to)};
    one.distance = (real(one.to) - real(one.from)).norm() + kWall + random.normal(kRotaryCalliper);
    printer.readings.distances.push_back(one);
  }
}

std::string steps(const JointDrops& drops) {
  return fmt::format("{:.3f},{:.3f},{:.3f}", drops[0] / kJointStep, drops[1] / kJointStep, drops[2] / kJointStep);
}

std::string config_of(const RotaryPrinter& printer) {
  const DeltaGeometry& saved = printer.saved;
  std::string text = fmt::format("[printer]\nkinematics: rotary_delta\nshoulder_radius: {}\nshoulder_height: {}\n",
                                 saved.radius, saved.shoulder[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    text += fmt::format(
        "\n[stepper_{}]\ngear_ratio: 80:16, 60:16\nmicrosteps: 16\nangle: {:.17g}\nposition_endstop: {}\n"
        "upper_arm_length: {}\nlower_arm_length: {}\n",
        "abc"[i], to_degrees(saved.tower_angle[i]), saved.endstop[i], saved.arm[i], saved.rod[i]);
  }
  text +=
      "\n#*# <---------------------- SAVE_CONFIG ---------------------->\n"
      "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n#*#\n#*# [delta_calibrate]\n";
  for (std::size_t k = 0; k < printer.readings.heights.size(); ++k) {
    const BedReading& one = printer.readings.heights[k];
    text += fmt::format("#*# height{} = {}\n#*# height{}_pos = {}\n", k, one.height, k, steps(one.drops));
  }
  for (std::size_t k = 0; k < printer.readings.distances.size(); ++k) {
    const PrintedDistance& one = printer.readings.distances[k];
    text += fmt::format("#*# distance{0} = {1:.17g}\n#*# distance{0}_pos1 = {2}\n#*# distance{0}_pos2 = {3}\n", k,
                        one.distance, steps(one.from), steps(one.to));
  }
  return text;
}

}  // namespace

RotaryPrinter rotary_printer(unsigned seed) {
  const DeltaGeometry saved{.actuator = Actuator::revolute,
                            .radius = 33.9,
                            .tower_angle = {to_radians(30.0), to_radians(150.0), to_radians(270.0)},
                            .rod = {320.0, 320.0, 320.0},
                            .endstop = {252.0, 252.0, 252.0},
                            .arm = {170.0, 170.0, 170.0},
                            .shoulder = {412.9, 412.9, 412.9}};
  Random random(seed);
  DeltaGeometry actual = saved;
  actual.radius += random.uniform(-1.0, 1.0);
  actual.rod.fill(saved.rod[0] + random.uniform(-1.0, 1.0));
  actual.arm.fill(saved.arm[0] + random.uniform(-1.0, 1.0));
  actual.shoulder.fill(saved.shoulder[0] + random.uniform(-1.0, 1.0));
  for (std::size_t i = 0; i < 3; ++i) {
    if (i < 2) actual.tower_angle[i] += to_radians(random.uniform(-0.3, 0.3));
    actual.endstop[i] += random.uniform(-2.0, 2.0);
  }
  RotaryPrinter printer{
      .saved = saved, .actual = actual, .machine = printer_machine(actual), .errors = {}, .readings = {}, .config = {}};
  const Tolerances tolerances = printer_tolerances(printer.machine.robot.limbs());
  for (std::size_t i = 0; i < 3; ++i) {
    for (const Source source : sources_of(printer.machine.robot.actuator())) {
      if (source != "theta_offset") printer.errors(i, source) += random.normal(tolerances[source] / 3.0);
    }
  }
  const Machine machine = build(printer.machine.robot, printer.errors);
  read_heights(printer, machine, random);
  measure_distances(printer, machine, random);
  printer.config = config_of(printer);
  return printer;
}

}  // namespace paracal::test
