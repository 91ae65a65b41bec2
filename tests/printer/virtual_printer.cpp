#include "printer/virtual_printer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/printer/ladder.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::test {
namespace {

constexpr double kStep = 0.00625, kProbe = 0.02, kCalliper = 0.05;  // mm

JointDrops whole_steps(JointDrops drops) {
  for (double& one : drops) one = kStep * std::round(one / kStep);
  return drops;
}

DeltaGeometry design(double scale) {
  return {.actuator = Actuator::linear,
          .radius = 105.0 * scale,
          .tower_angle = {to_radians(210.0), to_radians(330.0), to_radians(90.0)},
          .rod = {217.0 * scale, 217.0 * scale, 217.0 * scale},
          .endstop = {250.0 * scale, 250.0 * scale, 250.0 * scale}};
}

class Owner {
 public:
  Owner(VirtualPrinter& printer, Random& random)
      : printer_(printer), machine_(build(printer.machine.robot, printer.errors)), random_(random) {}

  DeltaReadings read(const PrinterWorld& world) {
    DeltaReadings readings;
    for (int k = 0; k < world.heights; ++k) readings.heights.push_back(height(k, world.heights));
    for (int k = 0; k < world.distances; ++k) readings.distances.push_back(distance(k, world));
    return readings;
  }

 private:
  /// One in the middle, then a ring of six, two of them in turn, or four.
  Eigen::Vector3d place(int k, int of) const {
    if (k == 0) return Eigen::Vector3d::Zero();
    if (of == 7) return Workspace::on_circle(0.75 * printer_.radius, to_radians(60.0 * k), 0.0);
    if (of == 13) {
      return Workspace::on_circle((k % 2 == 1 ? 0.9 : 0.5) * printer_.radius, to_radians(30.0 * k), 0.0);
    }
    const int ring = (k - 1) % 4;
    return Workspace::on_circle(0.95 * printer_.radius * (ring + 1) / 4.0,
                                to_radians(36.0 * ((k - 1) / 4) + 9.0 * ring), 0.0);
  }

  BedReading height(int k, int of) {
    const Eigen::Vector3d p = place(k, of);
    const double z =
        printer_.bed.height + printer_.bed.slope_x * p.x() + printer_.bed.slope_y * p.y() + printer_.bed.bow_at(p);
    const InverseResult joints = inverse(machine_, {{p.x(), p.y(), z + random_.normal(kProbe)}, 0.0});
    JointDrops drops{};
    for (Eigen::Index i = 0; i < 3; ++i) {
      drops[static_cast<std::size_t>(i)] = printer_.machine.homed[i] - joints.joints[i];
    }
    return {.height = 0.0, .drops = whole_steps(drops)};
  }

  /// From the middle outwards and along the rim in turn.
  PrintedDistance distance(int k, const PrinterWorld& world) {
    const double length = (world.two_lengths && k % 2 == 1 ? 0.35 : 0.75) * printer_.radius;
    const int pair = world.two_lengths ? k / 2 : k;
    const double angle = to_radians(60.0 * (pair / 2));
    const Eigen::Vector3d out = Workspace::on_circle(length, angle, 2.0);
    const bool radial = pair % 2 == 0;
    const Eigen::Vector3d from = radial ? Eigen::Vector3d(0.0, 0.0, 2.0) : out;
    const Eigen::Vector3d to = radial ? out : Workspace::on_circle(length, angle + to_radians(60.0), 2.0);
    PrintedDistance one{.from = whole_steps(*drops_to(printer_.saved, from)),
                        .to = whole_steps(*drops_to(printer_.saved, to))};
    const auto real = [&](const JointDrops& drops) {
      return forward(machine_, printer_.machine.joints_at(drops)).plate.position;
    };
    one.distance = (real(one.to) - real(one.from)).norm() + world.bias + random_.normal(kCalliper);
    return one;
  }

  VirtualPrinter& printer_;
  Machine machine_;
  Random& random_;
};

}  // namespace

Eigen::Vector3d VirtualPrinter::place(const JointDrops& drops) const {
  const Eigen::Vector3d p = forward(build(machine.robot, errors), machine.joints_at(drops)).plate.position;
  const double z = p.z() - bed.height - bed.slope_x * p.x() - bed.slope_y * p.y();
  return {p.x() + bed.slope_x * z, p.y() + bed.slope_y * z, z};
}

std::vector<double> VirtualPrinter::heights(const DeltaGeometry& values) const {
  std::vector<double> all;
  for (const Eigen::Vector3d& wanted : printable_disk(radius)) {
    const Eigen::Vector3d real = place(*drops_to(values, wanted));
    all.push_back(real.z() - bed.bow_at(real));
  }
  return all;
}

double VirtualPrinter::first_layer(const DeltaGeometry& values) const {
  const std::vector<double> all = heights(values);
  return std::sqrt(std::inner_product(all.begin(), all.end(), all.begin(), 0.0) / static_cast<double>(all.size()));
}

double VirtualPrinter::depth(const DeltaGeometry& values) const { return -std::ranges::min(heights(values)); }

double VirtualPrinter::size_error(const DeltaGeometry& values) const {
  constexpr int kAround = 12;
  const Machine actual = build(machine.robot, errors);
  const auto real = [&](double angle) {
    const auto drops = drops_to(values, Workspace::on_circle(0.6 * radius, angle, 0.0));
    return forward(actual, machine.joints_at(*drops)).plate.position;
  };
  double sum = 0.0;
  for (int k = 0; k < kAround; ++k) {
    const double angle = to_radians(180.0 * k / kAround);
    sum += ((real(angle) - real(angle + to_radians(180.0))).norm() / (1.2 * radius) - 1.0) / kAround;
  }
  return sum;
}

void PrintTo(const PrinterWorld& world, std::ostream* out) {
  *out << fmt::format("{} heights, {} distances, bias {} mm, rails lean {} times, rods unlike by {} mm", world.heights,
                      world.distances, world.bias, world.leaning, world.unlike_rods);
}

VirtualPrinter virtual_printer(const PrinterWorld& world, unsigned seed) {
  Random random(seed);
  const double scale = random.uniform(0.0, 1.0) < 0.5 ? 1.0 : 1.55;
  const DeltaGeometry saved = design(scale);
  DeltaGeometry actual = saved;
  actual.radius += random.normal(0.5);
  const double lot = random.normal(0.5);
  for (std::size_t i = 0; i < 3; ++i) {
    actual.rod[i] += lot + random.normal(world.unlike_rods);
    actual.endstop[i] += random.normal(0.4);
  }
  const double radius = 85.0 * scale;
  VirtualPrinter printer{.saved = saved,
                         .machine = printer_machine(actual, radius),
                         .errors = {},
                         .bed = {.edge = world.bow, .radius = radius},
                         .readings = {}};
  printer.radius = radius;
  const Tolerances tolerances = printer_tolerances(printer.machine.robot.limbs());
  for (std::size_t i = 0; i < 3; ++i) {
    for (const Source source : sources_of(printer.machine.robot.actuator())) {
      if (source == "theta_offset" || source == "rod_mean") continue;
      const bool leans = source == "alpha0" || source == "beta0";
      printer.errors(i, source) += random.normal((leans ? world.leaning : 1.0) * tolerances[source] / 3.0);
    }
  }
  printer.bed.height = printer.machine.bed;
  printer.bed.slope_x = random.normal(0.5e-3);
  printer.bed.slope_y = random.normal(0.5e-3);
  Owner owner(printer, random);
  if (world.calibrated_before) {
    PrinterWorld before = world;
    before.heights = 7;
    before.distances = 12;
    printer.saved = fit_as_firmware(saved, owner.read(before)).geometry;
  }
  printer.readings = owner.read(world);
  if (world.saved_is_fit) printer.saved = fit_as_firmware(saved, printer.readings).geometry;
  return printer;
}

}  // namespace paracal::test
