#include "paracal/printer/delta_geometry.hpp"

#include <gmock/gmock.h>

#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/printer/printer_machine.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"

namespace paracal {
namespace {

using test::klipper_sets;
using test::KlipperSet;

/// The firmware's model is the library's with perfect towers, written down once more.
TEST(DeltaGeometry, NozzleIsWhereTheMachineIs) {
  for (const KlipperSet& set : klipper_sets()) {
    const PrinterMachine printer = printer_machine(set.geometry);
    const Machine machine = build(printer.robot, printer.assumed);
    const Measurements measurements = printer_measurements(printer, set.geometry, set.readings);
    for (const Station& station : measurements.stations) {
      const ForwardResult place = forward(machine, *station.believed);
      ASSERT_TRUE(place.ok());
      EXPECT_LT((place.plate.position - station.commanded.position).norm(), 1e-8) << set.id;
    }
  }
}

TEST(DeltaGeometry, ArmsThatDoNotMeetHaveNoNozzle) {
  const DeltaGeometry geometry{
      .radius = 100, .tower_angle = {3.7, 5.8, 1.6}, .arm = {200, 200, 200}, .endstop = {300, 300, 300}};
  EXPECT_TRUE(nozzle(geometry, {100, 100, 100}));
  EXPECT_FALSE(nozzle(geometry, {100, 100, 700}));
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

TEST(DeltaFit, NeedsHeights) {
  KlipperSet set = klipper_sets().front();
  set.readings.heights.clear();
  EXPECT_THROW((void)fit_as_firmware(set.geometry, set.readings), InvalidArgument);
}

}  // namespace
}  // namespace paracal
