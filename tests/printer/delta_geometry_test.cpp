#include "paracal/printer/delta_geometry.hpp"

#include <gmock/gmock.h>

#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/printer/printer_machine.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"
#include "printer/rotary_printer.hpp"

namespace paracal::delta_geometry_test {
namespace {

using test::klipper_sets;
using test::KlipperSet;

/// Two maps of a firmware's numbers: to one rod a tower, and to the pairs of rods that are calibrated.
TEST(DeltaGeometry, NozzleIsWhereTheMachineIs) {
  for (const KlipperSet& set : klipper_sets()) {
    const PrinterMachine printer = printer_machine(set.geometry);
    const Machine machine = printer.robot.nominal();
    const Measurements measurements = printer_measurements(printer, set.geometry, set.readings);
    for (const Station& station : measurements.stations) {
      const ForwardResult place = forward(machine, *station.believed);
      ASSERT_TRUE(place.ok());
      EXPECT_LT((place.plate.position - station.commanded.position).norm(), 1e-8) << set.id;
    }
  }
}

/// Likewise with arms, whose towers stand where they are and not where they should.
TEST(DeltaGeometry, NozzleOfARotaryDeltaIsWhereTheMachineIs) {
  const test::RotaryPrinter printer = test::rotary_printer();
  const Machine machine = printer.machine.robot.nominal();
  for (const BedReading& reading : printer.readings.heights) {
    const ForwardResult place = forward(machine, printer.machine.joints_at(reading.drops));
    ASSERT_TRUE(place.ok());
    const Eigen::Vector3d lift(0.0, 0.0, printer.machine.bed);
    EXPECT_LT((place.plate.position - *nozzle(printer.actual, reading.drops) - lift).norm(), 1e-8);
  }
}

TEST(DeltaGeometry, EndstopsAndHomedJointsAreOneAndTheSame) {
  for (const DeltaGeometry& geometry : {klipper_sets().front().geometry, test::rotary_printer().actual}) {
    const std::array<double, 3> homed = homed_joints(geometry);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(endstop_of(geometry, i, homed[i]), geometry.endstop[i], 1e-9);
  }
}

TEST(DeltaGeometry, DerivativesAreDifferences) {
  constexpr double kStep = 1e-4;
  for (const DeltaGeometry& geometry : {klipper_sets().front().geometry, test::rotary_printer().actual}) {
    const JointDrops drops =
        geometry.actuator == Actuator::linear ? JointDrops{300, 320, 310} : JointDrops{0.8, 0.9, 1};
    const NozzleJacobian jacobian = nozzle_jacobian(geometry, drops, *nozzle(geometry, drops));
    for (Eigen::Index k = 0; k < DeltaNumber::count; ++k) {
      const DeltaNumbers step = kStep * DeltaNumbers::Unit(k), numbers = numbers_of(geometry);
      const Eigen::Vector3d ahead = *nozzle(with_numbers(geometry, numbers + step), drops),
                            behind = *nozzle(with_numbers(geometry, numbers - step), drops);
      EXPECT_LT(((ahead - behind) / (2 * kStep) - jacobian.col(k)).norm(), 1e-5 * (1.0 + jacobian.col(k).norm())) << k;
    }
  }
}

TEST(DeltaGeometry, ArmsThatDoNotMeetInOnePointHaveNoNozzle) {
  const DeltaGeometry geometry{
      .radius = 100, .tower_angle = {3.7, 5.8, 1.6}, .rod = {200, 200, 200}, .endstop = {300, 300, 300}};
  EXPECT_TRUE(nozzle(geometry, {100, 100, 100}));
  EXPECT_FALSE(nozzle(geometry, {100, 100, 700}));
  DeltaGeometry twice = geometry;
  twice.tower_angle[1] = twice.tower_angle[0];
  EXPECT_FALSE(nozzle(twice, {100, 100, 100})) << "any point of a circle";
}

/// The optimum that SciPy finds of the same cost, on every set; and never a cost above the saved one.
TEST(DeltaFit, ReachesTheOptimumOnEverySet) {
  for (const KlipperSet& set : klipper_sets()) {
    const DeltaFit fit = fit_as_firmware(set.geometry, set.readings);
    ASSERT_TRUE(fit.ok()) << set.id;
    EXPECT_EQ(fit.parameters, set.readings.distances.empty() ? 6 : 9);
    EXPECT_NEAR(fit.cost / set.best_cost, 1.0, 1e-6) << set.id;
    EXPECT_NEAR(judge_as_firmware(set.geometry, set.readings).cost / set.saved_cost, 1.0, 1e-6) << set.id;
    EXPECT_LE(fit.cost, set.saved_cost);
  }
}

/// Readings of a machine that the firmware's seven numbers describe are explained to the last bit.
TEST(DeltaFit, FindsARotaryDelta) {
  const test::RotaryPrinter printer = test::rotary_printer();
  DeltaGeometry actual = printer.saved;
  actual.radius += 0.6;
  actual.tower_angle[1] -= 0.01;
  actual.shoulder.fill(411.5);
  actual.endstop = {251.0, 253.5, 252.2};
  DeltaReadings readings = printer.readings;
  for (BedReading& one : readings.heights) one.height = nozzle(actual, one.drops)->z();
  for (PrintedDistance& one : readings.distances) {
    one.distance = (*nozzle(actual, one.to) - *nozzle(actual, one.from)).norm();
  }
  const DeltaFit fit = fit_as_firmware(printer.saved, readings);
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit.parameters, 7);
  EXPECT_LT(fit.cost, 1e-12);
  EXPECT_LT((numbers_of(fit.geometry) - numbers_of(actual)).cwiseAbs().maxCoeff(), 1e-5);
  readings.distances.clear();
  EXPECT_EQ(fit_as_firmware(printer.saved, readings).parameters, 4);
}

TEST(DeltaFit, NeedsHeights) {
  KlipperSet set = klipper_sets().front();
  set.readings.heights.clear();
  EXPECT_THROW((void)fit_as_firmware(set.geometry, set.readings), InvalidArgument);
}

}  // namespace
}  // namespace paracal::delta_geometry_test
