// The usual first calibration: a radius typed as somebody has measured it, and endstops levelled at the rim.

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "paracal/printer/printer_calibration.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::first_calibration_test {
namespace {

constexpr double kRim = 85.0;  // mm

/// A printer, the values of its owner, and heights that a probe reads at them.
struct First {
  DeltaGeometry actual, saved;
  DeltaReadings readings;
};

Eigen::Vector3d on_rim(double radius, double angle) { return Workspace::on_circle(radius, angle, 0.0); }

/// One in the middle and rings around it.
std::vector<Eigen::Vector3d> places_of(int rings) {
  constexpr int kAround = 6;
  std::vector<Eigen::Vector3d> places{Eigen::Vector3d::Zero()};
  for (int ring = 1; ring <= rings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      places.push_back(on_rim(kRim * ring / rings, to_radians(60.0 * k + 90.0 * ring / rings)));
    }
  }
  return places;
}

/// Turns the endstops until the nozzle at Z0 touches the bed at the rim before each tower.
void level_rim(const DeltaGeometry& actual, DeltaGeometry& saved) {
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const DeltaGeometry before = saved;
    for (std::size_t i = 0; i < 3; ++i) {
      saved.endstop[i] -= nozzle(before, *drops_to(actual, on_rim(kRim, actual.tower_angle[i])))->z();
    }
  }
}

/// Written down before: radius 2 mm, angles 0.15 deg, rods 0.05 mm, endstops as paper levels them 0.03 mm (1 sigma).
First first_calibration(unsigned seed, int rings) {
  test::Random random(seed);
  First first{.actual = {},
              .saved = {.actuator = Actuator::linear,
                        .radius = 125.0,
                        .tower_angle = {to_radians(210.0), to_radians(330.0), to_radians(90.0)},
                        .rod = {250.0, 250.0, 250.0},
                        .endstop = {270.0, 270.0, 270.0}},
              .readings = {}};
  first.actual = first.saved;
  first.actual.radius += random.normal(2.0);
  for (const std::size_t tower : {0u, 1u}) first.actual.tower_angle[tower] += random.normal(to_radians(0.15));
  for (double& rod : first.actual.rod) rod += random.normal(0.05);
  level_rim(first.actual, first.saved);
  for (double& endstop : first.saved.endstop) endstop += random.normal(0.03);
  for (const Eigen::Vector3d& place : places_of(rings)) {
    const Eigen::Vector3d touched = place + Eigen::Vector3d(0.0, 0.0, random.normal(0.01));
    first.readings.heights.push_back({.height = 0.0, .drops = *drops_to(first.actual, touched)});
  }
  return first;
}

/// Of the nozzle above the bed while the firmware computes z = 0: the lowest, and the root mean square, mm.
struct FirstLayer {
  double lowest = 0.0, rms = 0.0;
};

FirstLayer first_layer(const First& first, const DeltaGeometry& values) {
  FirstLayer layer;
  const std::vector<Eigen::Vector3d> places = places_of(6);
  for (const Eigen::Vector3d& place : places) {
    const double z = nozzle(first.actual, *drops_to(values, place))->z();
    layer.lowest = std::min(layer.lowest, z);
    layer.rms += z * z / static_cast<double>(places.size());
  }
  layer.rms = std::sqrt(layer.rms);
  return layer;
}

class FirstCalibration : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Rings, FirstCalibration, testing::Values(2, 4));

/// Written down before: after no advice the nozzle is more than 0.2 mm below the bed, no first layer gets worse by more
/// than 0.01 mm, no radius is called a shift, and four of five are advised.
TEST_P(FirstCalibration, IsNoShiftAndNeverScratchesTheBed) {
  const int count = test::machines({.claim = 20, .quick = 4});
  int advised = 0;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(count); ++seed) {
    const First first = first_calibration(seed, GetParam());
    const PrinterCalibration found = calibrate_printer(first.saved, first.readings, {.print_radius = kRim});
    EXPECT_LT(std::abs(found.shift.value), 0.15) << seed;
    const FirstLayer before = first_layer(first, first.saved), after = first_layer(first, found.advised());
    advised += found.is_advised();
    if (found.is_advised()) {
      EXPECT_GT(after.lowest, -0.2) << seed;
    }
    EXPECT_LT(after.rms, before.rms + 0.01) << seed;
  }
  RecordProperty("advised", advised);
  EXPECT_GE(advised, count * 4 / 5);
}

}  // namespace
}  // namespace paracal::first_calibration_test
