#include "paracal/printer/printer_calibration.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "paracal/error.hpp"
#include "paracal/io/klipper.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"

namespace paracal {
namespace {

using test::klipper_sets;
using test::KlipperSet;
using testing::Contains;
using testing::HasSubstr;

KlipperSet set_named(const std::string& id) {
  const std::vector<KlipperSet> sets = klipper_sets();
  return *std::ranges::find(sets, id, &KlipperSet::id);
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Readings that neither fit has seen, over all printers whose owners measured distances.
TEST(PrinterCalibration, PredictsLeftOutReadingsBetterThanTheFirmwaresFit) {
  std::vector<double> heights, distances;
  for (const KlipperSet& set : klipper_sets()) {
    if (set.readings.distances.empty()) continue;
    const auto errors = leave_one_out(set.geometry, set.readings);
    ASSERT_TRUE(errors) << set.id;
    heights.push_back(errors->second.height / errors->first.height);
    distances.push_back(errors->second.distance / errors->first.distance);
  }
  ASSERT_EQ(heights.size(), 7u);
  EXPECT_LE(median(heights), 1.0);
  EXPECT_LE(median(distances), 0.8);
}

TEST(PrinterCalibration, NamesTheGrossErrorOfThreePrinters) {
  for (const char* id : {"K09", "K10", "K11"}) {
    const KlipperSet set = set_named(id);
    const PrinterCalibration found = calibrate_printer(set.geometry, set.readings);
    EXPECT_THAT(found.findings, Contains(HasSubstr("left out distance distance11_pos1"))) << id;
    EXPECT_TRUE(found.recommended) << id;
  }
}

TEST(PrinterCalibration, SaysWhenTheSavedValuesDoNotBelongToTheReadings) {
  for (const KlipperSet& set : klipper_sets()) {
    const PrinterCalibration found = calibrate_printer(set.geometry, set.readings);
    const auto belongs = std::ranges::none_of(
        found.findings, [](const std::string& one) { return one.find("do not belong") != std::string::npos; });
    EXPECT_EQ(belongs, set.saved_is_optimum) << set.id;
    // Never worse parameters without a warning.
    const bool warned =
        std::ranges::any_of(found.findings, [](const std::string& one) { return one.starts_with("warning"); });
    EXPECT_EQ(warned, !found.recommended) << set.id;
    if (!found.recommended) continue;
    EXPECT_LE(found.projection.accuracy.shape_rms, found.accuracy_before.shape_rms) << set.id;
  }
}

/// A machine that the firmware's parameters describe is found again to what it holds.
TEST(Projection, OfAMachineThatTheControllerCanDescribeLosesNothing) {
  const KlipperSet set = set_named("K18");
  const PrinterMachine printer = printer_machine(set.geometry);
  const KnownPrinter known{printer, printer.assumed, {.name = "bed", .height = printer.bed}};
  DeltaGeometry start = set.geometry;
  start.radius += 0.7;
  start.arm[1] -= 0.5;
  start.endstop[2] += 0.4;
  const DeltaProjection found = project(known, start, ControllerArms::each);
  ASSERT_TRUE(found.ok());
  EXPECT_LT(found.accuracy.shape_max, 1e-6);
  EXPECT_NEAR(found.geometry.radius, set.geometry.radius, 1e-4);
  EXPECT_GT(accuracy_of(known, start).shape_rms, 0.05);
  // One arm length for all three cannot hold arms that differ by 0.4 mm.
  const DeltaProjection poorer = project(known, start, ControllerArms::alike);
  ASSERT_TRUE(poorer.ok());
  EXPECT_GT(poorer.accuracy.shape_rms, 1e-3);
  EXPECT_LT(poorer.accuracy.shape_rms, accuracy_of(known, start).shape_rms);
}

TEST(KlipperFile, SavedValuesAndReadingsAreThoseOfTheSet) {
  for (const KlipperSet& set : klipper_sets()) {
    const io::KlipperDelta printer = io::read_klipper({"printer.cfg", set.config});
    EXPECT_NEAR(printer.geometry.radius, set.geometry.radius, 1e-12);
    ASSERT_EQ(printer.readings.heights.size(), set.readings.heights.size());
    ASSERT_EQ(printer.readings.distances.size(), set.readings.distances.size());
    EXPECT_NEAR(judge_as_firmware(printer.geometry, printer.readings).cost / set.saved_cost, 1.0, 1e-5) << set.id;
  }
}

TEST(KlipperFile, WhatIsWrittenIsReadBack) {
  const KlipperSet set = set_named("K19");
  DeltaGeometry changed = set.geometry;
  changed.radius = 163.25;
  changed.arm = {345.5, 346.5, 347.5};
  const io::KlipperDelta again = io::read_klipper({"printer.cfg", set.config + io::klipper_save_config(changed)});
  EXPECT_NEAR(again.geometry.radius, changed.radius, 1e-6);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(again.geometry.arm[i], changed.arm[i], 1e-6);
    EXPECT_NEAR(again.geometry.endstop[i], changed.endstop[i], 1e-6);
    EXPECT_NEAR(again.geometry.tower_angle[i], changed.tower_angle[i], 1e-8);
  }
}

TEST(KlipperFile, StepsComeFromTheMotorWhereNoDistanceIsTyped) {
  const std::string tower = "arm_length: 300\nposition_endstop: 250\nrotation_distance: 40\nmicrosteps: 16\n";
  const std::string text = "[printer]\nkinematics: delta\ndelta_radius: 130\n[stepper_a]\n" + tower +
                           "gear_ratio: 3:1\n[stepper_b]\n" + tower + "[stepper_c]\n" + tower +
                           "full_steps_per_rotation: 400\n";
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", text});
  EXPECT_DOUBLE_EQ(printer.step_distance[0], 40.0 / (200 * 16 * 3));
  EXPECT_DOUBLE_EQ(printer.step_distance[1], 40.0 / (200 * 16));
  EXPECT_DOUBLE_EQ(printer.step_distance[2], 40.0 / (400 * 16));
  EXPECT_NEAR(to_degrees(printer.geometry.tower_angle[1]), 330.0, 1e-12);
}

TEST(KlipperFile, IsRefusedWithItsLine) {
  const std::string good = set_named("K18").config;
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& part) {
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, from.size(), to);
    EXPECT_THAT(
        [&] {
          (void)io::read_klipper({"printer.cfg", text});
        },
        testing::ThrowsMessage<InputFileError>(HasSubstr(part)));
  };
  refused("kinematics: delta", "kinematics: corexy", "printer.cfg:5: expected kinematics: delta, got \"corexy\"");
  refused("#*# delta_radius = 161", "#*# delta_radius = x161", "expected a number for delta_radius");
  refused("#*# arm_length = 344.106553", "#*# arm_length = 34.4", "expected arm_length above delta_radius");
  refused("height0_pos = ", "height0_pos = 1,", "expected three step counts for height0_pos");
  refused("height0_pos = ", "height0_pos = 9", "expected steps that the printer can take");
  refused("step_distance", "step_length", "expected rotation_distance in [stepper_a], got none");
}

}  // namespace
}  // namespace paracal
