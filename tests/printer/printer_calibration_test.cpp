#include "paracal/printer/printer_calibration.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "paracal/error.hpp"
#include "paracal/io/klipper.hpp"
#include "paracal/numerics/least_squares.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"
#include "printer/rotary_printer.hpp"

namespace paracal::printer_calibration_test {
namespace {

using test::klipper_sets;
using test::KlipperSet;
using testing::Contains;
using testing::HasSubstr;

KlipperSet set_named(const std::string& id) {
  const std::vector<KlipperSet> sets = klipper_sets();
  return *std::ranges::find(sets, id, &KlipperSet::id);
}

TEST(PrinterCalibration, NamesTheGrossErrorOfThreePrinters) {
  for (const char* id : {"K09", "K10", "K11"}) {
    const KlipperSet set = set_named(id);
    const PrinterCalibration& found = calibrated(set);
    EXPECT_THAT(found.findings, Contains(HasSubstr("distance 11. Measure it again"))) << id;
    EXPECT_THAT(found.ladder.gross.distances, testing::ElementsAre(11)) << id;
    EXPECT_GT(found.firmware.rms_distance, 1.0) << id;
  }
}

/// Written down before: a wrong reading takes at most five times as many least-squares solves as none.
TEST(PrinterCalibration, AWrongReadingIsFoundWithLittleWork) {
  const KlipperSet set = set_named("K18");
  const auto solves = [&](const DeltaReadings& readings) {
    const std::uint64_t before = least_squares_solved();
    (void)calibrate_printer(set.geometry, readings);
    return least_squares_solved() - before;
  };
  const std::uint64_t usual = solves(set.readings);
  EXPECT_GT(usual, set.readings.heights.size());
  for (const double wrong : {0.5, 5.0, 1e8}) {
    DeltaReadings height = set.readings, distance = set.readings;
    height.heights[3].height += wrong;
    distance.distances[3].distance += wrong;
    EXPECT_LE(solves(height), 5 * usual) << wrong;
    EXPECT_LE(solves(distance), 5 * usual) << wrong;
  }
}

TEST(PrinterCalibration, SaysWhenTheSavedValuesDoNotBelongToTheReadings) {
  for (const KlipperSet& set : klipper_sets()) {
    const PrinterCalibration& found = calibrated(set);
    const auto belongs = std::ranges::none_of(found.details, [](const std::string& one) {
      return one.find("are not the firmware's fit of these") != std::string::npos;
    });
    EXPECT_EQ(belongs, set.saved_is_optimum) << set.id;
    EXPECT_LE(judge_as_firmware(found.firmware.geometry, set.readings).cost, found.saved.cost) << set.id;
  }
}

/// Three heights of three places: nothing is left to tell good values by.
TEST(PrinterCalibration, KeepsTheSavedValuesWhereReadingsAreTooFew) {
  KlipperSet set = set_named("K37");
  set.readings.heights.resize(3);
  const PrinterCalibration found = calibrate_printer(set.geometry, set.readings);
  EXPECT_EQ(found.advice, PrinterAdvice::keep_saved);
  EXPECT_THAT(found.findings, Contains(HasSubstr("13 heights over the whole bed would settle")));
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

/// Heights typed by hand count as readings, but the firmware weighs by the number of probed ones.
TEST(KlipperFile, HeightsByHandDoNotShareTheWeight) {
  KlipperSet set = set_named("K18");
  const double probed = judge_as_firmware(set.geometry, set.readings).cost;
  const BedReading& first = set.readings.heights[0];
  const double z = nozzle(set.geometry, first.drops)->z(), weight = 2.0 * 12.0 / 7.0;
  const double step = io::read_klipper({"printer.cfg", set.config}).step_size[0];
  const std::string typed =
      fmt::format("{}#*# manual_height0 = {}\n#*# manual_height0_pos = {:.3f},{:.3f},{:.3f}\n", set.config, z + 0.5,
                  first.drops[0] / step, first.drops[1] / step, first.drops[2] / step);
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", typed});
  ASSERT_EQ(printer.readings.heights.size(), 8u);
  EXPECT_TRUE(printer.readings.heights.back().by_hand);
  EXPECT_NEAR(judge_as_firmware(printer.geometry, printer.readings).cost, probed + weight * 0.25, 1e-4);
}

TEST(KlipperFile, WhatIsWrittenIsReadBack) {
  const KlipperSet set = set_named("K19");
  DeltaGeometry changed = set.geometry;
  changed.radius = 163.25;
  changed.rod = {345.5, 346.5, 347.5};
  const io::KlipperDelta again = io::read_klipper({"printer.cfg", set.config + io::klipper_save_config(changed)});
  EXPECT_NEAR(again.geometry.radius, changed.radius, 1e-6);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(again.geometry.rod[i], changed.rod[i], 1e-6);
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
  EXPECT_DOUBLE_EQ(printer.step_size[0], 40.0 / (200 * 16 * 3));
  EXPECT_DOUBLE_EQ(printer.step_size[1], 40.0 / (200 * 16));
  EXPECT_DOUBLE_EQ(printer.step_size[2], 40.0 / (400 * 16));
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
  refused("kinematics: delta", "kinematics: corexy",
          "printer.cfg:5: expected kinematics: delta or rotary_delta, got \"corexy\"");
  refused("#*# delta_radius = 161", "#*# delta_radius = x161", "expected a number for delta_radius");
  refused("#*# arm_length = 344.106553", "#*# arm_length = 34.4", "expected arm_length above delta_radius");
  refused("height0_pos = ", "height0_pos = 1,", "expected three step counts for height0_pos");
  refused("height0_pos = ", "height0_pos = 1", "expected steps for height0_pos that the printer can reach");
  refused("height0_pos = ", "height0_pos = 9", "steps (as far as a joint moves), got 9");
  refused("step_distance", "step_length", "expected rotation_distance in [stepper_a], got none");
}

// ---- rotary deltas

TEST(RotaryKlipperFile, IsThePrinterItWasWrittenFrom) {
  const test::RotaryPrinter made = test::rotary_printer();
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", made.config});
  EXPECT_EQ(printer.geometry.actuator, Actuator::revolute);
  EXPECT_NEAR(printer.step_size[0], 2.0 * 3.14159265358979 / (200 * 16 * 18.75), 1e-15);
  EXPECT_NEAR(
      judge_as_firmware(printer.geometry, printer.readings).cost / judge_as_firmware(made.saved, made.readings).cost,
      1.0, 1e-9);
  // What is written for the machine as it is, is read back.
  const io::KlipperDelta again =
      io::read_klipper({"printer.cfg", io::klipper_config({"printer.cfg", made.config}, made.actual)});
  EXPECT_LT((numbers_of(again.geometry) - numbers_of(made.actual)).cwiseAbs().maxCoeff(), 1e-6);
}

/// Step counts that Klipper itself worked out, from its test/klippy/rotary_delta_calibrate.cfg [klipper]: places on the
/// bed at 0 and at 95 to 70 % of 50 mm, every 60 deg from the rear. They are of an older configuration, steps of 1e-5
/// rad.
TEST(RotaryKlipperFile, StepsMeanWhatTheyMeanToTheFirmware) {
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", R"(
[printer]
kinematics: rotary_delta
[stepper_a]
step_distance: 0.00001
upper_arm_length: 170.000
lower_arm_length: 320.000
[stepper_b]
step_distance: 0.00001
[stepper_c]
step_distance: 0.00001

#*# <---------------------- SAVE_CONFIG ---------------------->
#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.
#*#
#*# [printer]
#*# shoulder_radius = 33.900000
#*# shoulder_height = 412.900000
#*# [stepper_a]
#*# angle = 30.000000
#*# position_endstop = 251.999999
#*# [stepper_b]
#*# angle = 150.000000
#*# position_endstop = 251.999973
#*# [stepper_c]
#*# angle = 270.000000
#*# position_endstop = 251.999902
#*# [delta_calibrate]
#*# height0 = 0.0
#*# height0_pos = 162606.000,162606.000,162605.000
#*# height1 = 0.0
#*# height1_pos = 157814.000,157814.000,177775.000
#*# height2 = 0.0
#*# height2_pos = 170956.000,151002.000,170956.000
#*# height3 = 0.0
#*# height3_pos = 176042.000,158122.000,158122.000
#*# height4 = 0.0
#*# height4_pos = 168774.000,168774.000,153337.000
#*# height5 = 0.0
#*# height5_pos = 158477.000,174341.000,158477.000
#*# height6 = 0.0
#*# height6_pos = 152152.000,169841.000,169841.000
)"});
  ASSERT_EQ(printer.readings.heights.size(), 7u);
  const std::array<double, 7> radius{0.0, 47.5, 45.0, 42.5, 35.0, 37.5, 40.0};
  for (std::size_t k = 0; k < radius.size(); ++k) {
    const double angle = to_radians(90.0 + 60.0 * (static_cast<double>(k) - 1.0));
    const auto place = nozzle(printer.geometry, printer.readings.heights[k].drops);
    ASSERT_TRUE(place);
    EXPECT_LT((*place - Workspace::on_circle(radius[k], angle, 0.0)).norm(), 0.01) << k;
  }
}

TEST(RotaryKlipperFile, IsRefusedWithItsLine) {
  const auto refused = [](const std::string& from, const std::string& to, const std::string& part) {
    std::string text = test::rotary_printer().config;
    text.replace(text.find(from), from.size(), to);
    EXPECT_THAT(
        [&] {
          (void)io::read_klipper({"printer.cfg", text});
        },
        testing::ThrowsMessage<InputFileError>(HasSubstr(part)));
  };
  refused("gear_ratio", "gear", "expected gear_ratio in [stepper_a], got none");
  refused("position_endstop: 252", "position_endstop: 950",
          "printer.cfg:10: expected a position_endstop that the arms reach, got 950 mm");
  refused("shoulder_height: 412.9", "shoulder_height: -1", "printer.cfg:4: expected shoulder_height above 0");
  refused("upper_arm_length", "arm_length", "expected upper_arm_length in [stepper_a], got none");
}

}  // namespace
}  // namespace paracal::printer_calibration_test
