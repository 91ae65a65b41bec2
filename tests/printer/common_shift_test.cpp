// What all heights of a bed have in common: a trigger height that nobody stated, a bed that was moved.

#include "paracal/printer/common_shift.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "paracal/printer/printer_calibration.hpp"
#include "printer/advice_rules.hpp"
#include "printer/klipper_sets.hpp"
#include "printer/rotary_printer.hpp"
#include "printer/virtual_printer.hpp"

namespace paracal::common_shift_test {
namespace {

using test::KlipperSet;
using test::PrinterWorld;
using test::virtual_printer;
using test::VirtualPrinter;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Every height read with the bed so much higher than it was.
DeltaReadings shifted(const DeltaReadings& readings, double by) { return without_shift(readings, -by); }

PrinterCalibration calibrated(const VirtualPrinter& printer, double shift, bool accepts = false) {
  return calibrate_printer(printer.saved, shifted(printer.readings, shift),
                           {.print_radius = printer.radius, .tries_gross = false, .accepts_shift = accepts});
}

/// 13 heights, or seven with distances.
PrinterWorld world_of(unsigned seed) {
  return seed % 4 != 0 ? PrinterWorld{.heights = 13} : PrinterWorld{.heights = 7, .distances = 12, .two_lengths = true};
}

class CommonShiftOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Signs, CommonShiftOf, testing::Values(-1, 1));

/// Twenty shifts from -10 to 10 mm, each on a printer of its own. Written down before: each is stated, to 0.05 mm of
/// what was added to what the printer had already, and no advised value moves the bed's centre by more than 0.2 mm:
/// what the firmware's fit and ours differ by there. Half a millimetre is what nothing may exceed.
TEST_P(CommonShiftOf, VirtualPrintersIsStatedAndNotAdvised) {
  int advised = 0;
  for (unsigned size = 1; size <= 10; ++size) {
    const int k = GetParam() * static_cast<int>(size);
    const unsigned seed = k > 0 ? size : 10 + size;
    const VirtualPrinter printer = virtual_printer(world_of(seed), seed);
    const double before = common_shift(printer.saved, fit_as_firmware(printer.saved, printer.readings).geometry);
    const PrinterCalibration found = calibrated(printer, k);
    EXPECT_TRUE(found.shift.is_stated) << k << " mm";
    EXPECT_FALSE(found.shift.is_accepted);
    EXPECT_NEAR(found.shift.value, before + k, 0.05) << k << " mm";
    EXPECT_THAT(found.findings,
                Contains(StartsWith(fmt::format("All heights are off by {:+.1f} mm", found.shift.value))));
    EXPECT_THAT(found.findings, Contains(HasSubstr("add --accept-shift")));
    EXPECT_LE(std::abs(common_shift(printer.saved, found.advised())), 0.2) << k << " mm";
    advised += found.is_advised();
  }
  EXPECT_GE(advised, 4);  // the shape is judged as ever: of printers as designed most are to be improved
}

/// The shift changes nothing of what is said about the shape: the same printer with three of them.
TEST(CommonShift, LeavesTheShapeAsItIs) {
  const VirtualPrinter printer = virtual_printer(world_of(2), 2);
  const PrinterCalibration one = calibrated(printer, -3.0);
  for (const double shift : {7.0, 32.0}) {
    const PrinterCalibration other = calibrated(printer, shift);
    EXPECT_EQ(other.advice, one.advice);
    EXPECT_NEAR(other.written.geometry.radius, one.written.geometry.radius, 1e-3);
    EXPECT_NEAR(other.written.geometry.endstop[0], one.written.geometry.endstop[0], 1e-3);
    EXPECT_NEAR(other.expected_shape, one.expected_shape, 1e-3);
    EXPECT_NEAR(other.held_out.height, one.held_out.height, 1e-3);
  }
}

/// Where the owner says that the bed stands there, every value follows it, and is advised even where the shape stays.
TEST(CommonShift, IsFollowedWhereItIsAccepted) {
  const PrinterWorld good{.heights = 13, .distances = 12, .two_lengths = true, .saved_is_fit = true};
  for (const VirtualPrinter& printer : {virtual_printer(world_of(2), 2), virtual_printer(good, 4)}) {
    const PrinterCalibration apart = calibrated(printer, 32.0), found = calibrated(printer, 32.0, true);
    EXPECT_TRUE(found.shift.is_accepted);
    EXPECT_TRUE(found.is_advised());
    EXPECT_EQ(found.advice == PrinterAdvice::accept_shift, apart.advice == PrinterAdvice::keep_saved);
    EXPECT_NEAR(common_shift(printer.saved, found.advised()), found.shift.value, 0.2);
    EXPECT_NEAR(found.advised().radius, apart.advised().radius, 1e-3);
    EXPECT_THAT(found.findings, Not(Contains(HasSubstr("add --accept-shift"))));
  }
}

/// Better or not, values that move the nozzle down are not advised.
TEST(CommonShift, OfTheValuesThemselvesForbidsThem) {
  const VirtualPrinter printer = virtual_printer({.heights = 13, .distances = 12, .two_lengths = true}, 2);
  PrinterCalibration found = calibrated(printer, 0.0);
  ASSERT_EQ(detail::advice_of(false, found), PrinterAdvice::accept_new);
  ASSERT_LT(std::abs(common_shift(found.saved.geometry, found.written.geometry)), 0.5);
  const double lower = -0.55 - common_shift(found.saved.geometry, found.written.geometry);
  found.written.geometry = with_bed_higher(found.written.geometry, lower);
  found.by_firmware.geometry = found.written.geometry;
  EXPECT_EQ(detail::advice_of(false, found), PrinterAdvice::keep_saved);
  EXPECT_EQ(detail::advice_of(true, found), PrinterAdvice::keep_saved);
}

TEST(CommonShift, OfHalfAMillimetreIsNoMatter) {
  const VirtualPrinter printer = virtual_printer({.heights = 13, .saved_is_fit = true}, 3);
  for (const double shift : {-0.45, 0.45}) {
    const PrinterCalibration found = calibrated(printer, shift);
    EXPECT_NEAR(found.shift.value, shift, 0.01);
    EXPECT_FALSE(found.shift.is_stated);
    EXPECT_THAT(found.shift.likely_causes(), IsEmpty());
    EXPECT_THAT(found.findings, Not(Contains(HasSubstr("All heights are off"))));
  }
  EXPECT_TRUE(calibrated(printer, -0.55).shift.is_stated);
}

/// No probe triggers 32 mm away from the bed.
TEST(CommonShift, HasTheLikelyCauseFirst) {
  CommonShift shift{.value = -3.0, .is_stated = true};
  EXPECT_THAT(shift.likely_causes().front(), HasSubstr("trigger height"));
  shift.value = 32.0;
  EXPECT_THAT(shift.likely_causes().front(), HasSubstr("bed was moved"));
  EXPECT_EQ(shift.likely_causes().size(), 3u);
}

/// Gross readings make no shift, and hide none.
TEST(CommonShift, IsNotThatOfGrossReadings) {
  VirtualPrinter printer = virtual_printer({.heights = 41, .saved_is_fit = true}, 5);
  for (const std::size_t k : {7u, 23u}) printer.readings.heights[k].height -= 12.0;
  const PrinterCalibration none = calibrated(printer, 0.0), there = calibrated(printer, -0.8);
  EXPECT_FALSE(none.shift.is_stated) << none.shift.value;
  EXPECT_NEAR(there.shift.value, -0.8, 0.05);
  EXPECT_TRUE(there.shift.is_stated);
}

/// Endstops of a published printer 60 mm too high in the file: a bed that stands higher, and nothing else.
TEST(CommonShift, OfAPublishedPrinterIsItsEndstops) {
  const std::vector<KlipperSet> sets = test::klipper_sets();
  KlipperSet set = *std::ranges::find(sets, "K34", &KlipperSet::id);
  const std::array<double, 3> right = set.geometry.endstop;
  for (double& endstop : set.geometry.endstop) endstop += 60.0;
  const PrinterCalibration found = calibrate_printer(set.geometry, set.readings, {.tries_gross = false});
  EXPECT_NE(found.advice, PrinterAdvice::check_input);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found.shift.endstop[i], right[i], 0.5);
}

/// A rotary delta's bed moves away from its shoulders.
TEST(CommonShift, OfARotaryDeltaMovesItsShoulders) {
  const DeltaGeometry saved = test::rotary_printer().saved;
  const DeltaGeometry moved = with_bed_higher(saved, 2.0);
  EXPECT_NEAR(common_shift(saved, moved), 2.0, 1e-9);
  EXPECT_NEAR(moved.shoulder[1], saved.shoulder[1] - 2.0, 1e-12);
  const auto drops = drops_to(moved, {40.0, 30.0, 0.0});
  ASSERT_TRUE(drops);
  EXPECT_LT((*nozzle(saved, *drops) - Eigen::Vector3d(40.0, 30.0, 2.0)).norm(), 1e-9);
}

}  // namespace
}  // namespace paracal::common_shift_test
