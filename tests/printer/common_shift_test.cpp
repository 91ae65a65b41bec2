// What all heights of a bed have in common: a trigger height that nobody stated, a bed that was moved.

#include "paracal/printer/common_shift.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "paracal/printer/printer_calibration.hpp"
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

/// By values with endstops so much too high, so that the bed seems higher.
PrinterCalibration calibrated(const VirtualPrinter& printer, double shift, bool accepts = false) {
  return calibrate_printer(with_bed_higher(printer.saved, -shift), printer.readings,
                           {.print_radius = printer.radius, .accepts_shift = accepts});
}

/// 13 heights, or seven with distances.
PrinterWorld world_of(unsigned seed) {
  return seed % 4 != 0 ? PrinterWorld{.heights = 13} : PrinterWorld{.heights = 7, .distances = 12, .two_lengths = true};
}

class CommonShiftOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Signs, CommonShiftOf, testing::Values(-1, 1));

/// Heights of the bed by the saved values, mm.
std::vector<double> beds_of(const VirtualPrinter& printer) {
  std::vector<double> beds;
  for (const BedReading& one : printer.readings.heights) {
    beds.push_back(nozzle(printer.saved, one.drops)->z() - one.height);
  }
  return beds;
}

/// From the lowest to the highest of the bed and of zero, mm.
double range_of(const VirtualPrinter& printer) {
  const std::vector<double> beds = beds_of(printer);
  return std::max(std::ranges::max(beds), 0.0) - std::min(std::ranges::min(beds), 0.0);
}

/// The printer with its bed where the readings less their shift have it.
VirtualPrinter less_shift(VirtualPrinter printer, const CommonShift& shift) {
  printer.bed.height -= shift.is_stated ? shift.value : 0.0;
  return printer;
}

/// Twenty shifts from 0.8 to 20 mm up and down, each on a printer of its own. Written down before: each is stated, at
/// most the range of the shape and 0.05 mm away from what was added; and no advised value lets the nozzle scratch the
/// bed that the readings show without the shift: 0.2 mm, and 0.05 mm for what heights do not tell of a disk.
TEST_P(CommonShiftOf, VirtualPrintersIsStatedAndNotAdvised) {
  constexpr std::array kSizes{0.8, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 16.0, 20.0};  // mm
  int advised = 0;
  for (std::size_t k = 0; k < kSizes.size(); ++k) {
    const double added = GetParam() * kSizes.at(k);
    const auto seed = static_cast<unsigned>(k + (GetParam() > 0 ? 1 : 11));
    const VirtualPrinter printer = virtual_printer(world_of(seed), seed);
    if (range_of(printer) >= std::abs(added)) continue;  // the shape hides it
    const PrinterCalibration found = calibrated(printer, added);
    EXPECT_TRUE(found.shift.is_stated) << added << " mm";
    EXPECT_FALSE(found.shift.is_accepted);
    EXPECT_NEAR(found.shift.value, added, range_of(printer) + 0.05) << added << " mm";
    EXPECT_THAT(found.findings,
                Contains(StartsWith(fmt::format("All heights are off by {:+.2f} mm or more", found.shift.value))));
    EXPECT_THAT(found.findings, Contains(HasSubstr("add --accept-shift")));
    advised += found.is_advised();
    if (!found.is_advised()) continue;
    EXPECT_LE(less_shift(printer, found.shift).depth(found.advised()), 0.25) << added << " mm";
  }
  EXPECT_GE(advised, 3);  // the shape is judged as ever: of printers as designed most are to be improved
}

/// A shift changes nothing of what is said about the shape: the same printer with two of them.
TEST(CommonShift, LeavesTheShapeAsItIs) {
  const VirtualPrinter printer = virtual_printer(world_of(2), 2);
  const PrinterCalibration one = calibrated(printer, 7.0), other = calibrated(printer, 32.0);
  EXPECT_EQ(other.advice, one.advice);
  const DeltaGeometry &here = one.ladder.rungs.back().geometry, &there = other.ladder.rungs.back().geometry;
  EXPECT_NEAR(there.radius, here.radius, 1e-3);
  EXPECT_NEAR(there.endstop[0] - 25.0, here.endstop[0], 1e-3);
  EXPECT_NEAR(other.ladder.saved().first_layer.value, one.ladder.saved().first_layer.value, 1e-3);
}

/// Where the owner says that the bed stands there, every value follows it, and is advised even where the shape stays.
TEST(CommonShift, IsFollowedWhereItIsAccepted) {
  const PrinterWorld good{.heights = 13, .distances = 12, .two_lengths = true, .saved_is_fit = true};
  for (const VirtualPrinter& printer : {virtual_printer(world_of(2), 2), virtual_printer(good, 4)}) {
    const PrinterCalibration apart = calibrated(printer, 32.0), found = calibrated(printer, 32.0, true);
    EXPECT_TRUE(found.shift.is_accepted);
    EXPECT_TRUE(found.is_advised());
    EXPECT_EQ(found.advice == PrinterAdvice::accept_shift, apart.advice == PrinterAdvice::keep_saved);
    EXPECT_NEAR(mean_of(found.advised().endstop), mean_of(apart.advised().endstop) - found.shift.value, 1e-3);
    EXPECT_NEAR(found.advised().radius, apart.advised().radius, 1e-3);
    EXPECT_THAT(found.findings, Not(Contains(HasSubstr("add --accept-shift"))));
  }
}

/// 0.3 mm are a shift where the shape is smaller; 0.04 mm are nothing that a user sees.
TEST(CommonShift, IsStatedFromATwentiethOfAMillimetreOn) {
  const VirtualPrinter printer = virtual_printer({.heights = 13, .saved_is_fit = true}, 3);
  const double range = range_of(printer);
  ASSERT_LT(range, 0.1);
  for (const double added : {-0.3, 0.3}) {
    const PrinterCalibration found = calibrated(printer, added);
    EXPECT_TRUE(found.shift.is_stated);
    EXPECT_NEAR(found.shift.value, added, range + 0.05);
    EXPECT_NEAR(mean_of(found.advised().endstop), mean_of(printer.saved.endstop) + added, 0.05);  // not applied
  }
  for (const double added : {-0.04, 0.04}) {
    const PrinterCalibration found = calibrated(printer, added);
    EXPECT_FALSE(found.shift.is_stated);
    EXPECT_THAT(found.shift.likely_causes(), IsEmpty());
    EXPECT_THAT(found.findings, Not(Contains(HasSubstr("All heights are off"))));
  }
}

/// The part that every height shares; one of ten or more may be wrong. Noise makes none.
TEST(CommonShift, IsTheSmallestHeightOfOneSign) {
  const VirtualPrinter printer = virtual_printer({.heights = 13, .saved_is_fit = true}, 3);
  DeltaReadings readings;
  const auto add = [&](double bed) {
    readings.heights.push_back(
        {0.0, *drops_to(printer.saved, {10.0 * static_cast<double>(readings.heights.size()) - 50.0, 5.0, bed})});
  };
  for (const double bed : {0.9, 0.5, 0.7, 1.4}) add(bed);
  EXPECT_NEAR(common_shift(printer.saved, readings, 0.01).value, 0.5, 1e-9);
  EXPECT_FALSE(common_shift(printer.saved, readings, 0.2).is_stated);  // three times the noise
  add(-0.1);
  EXPECT_EQ(common_shift(printer.saved, readings, 0.01).value, 0.0);
  for (const double bed : {0.6, 0.8, 0.9, 0.7, 0.6}) add(bed);
  EXPECT_NEAR(common_shift(printer.saved, readings, 0.01).value, 0.5, 1e-9);
  add(-0.2);
  EXPECT_EQ(common_shift(printer.saved, readings, 0.01).value, 0.0);
}

/// No probe triggers 32 mm away from the bed; paper needs no probe.
TEST(CommonShift, HasTheLikelyCauseFirst) {
  CommonShift shift{.value = -3.0, .is_stated = true};
  EXPECT_THAT(shift.likely_causes().front(), HasSubstr("trigger height"));
  shift.value = 32.0;
  EXPECT_THAT(shift.likely_causes().front(), HasSubstr("bed was moved"));
  EXPECT_THAT(shift.likely_causes(), Contains(HasSubstr("trigger height")));
  for (const char* cause : {"nozzle", "endstop", "steps per mm"}) {
    EXPECT_THAT(shift.likely_causes(), Contains(HasSubstr(cause)));
  }
  shift.is_by_hand = true;
  EXPECT_THAT(shift.likely_causes(), Not(Contains(HasSubstr("trigger height"))));
}

/// A negative trigger height is impossible: whatever else is found, nothing follows it.
TEST(CommonShift, OfAWrongSignIsNeverAccepted) {
  VirtualPrinter printer = virtual_printer(world_of(2), 2);
  for (BedReading& one : printer.readings.heights) one.height = -6.0;
  const PrinterCalibration found = calibrated(printer, 0.0, true);
  EXPECT_TRUE(found.shift.is_stated);
  EXPECT_FALSE(found.shift.is_accepted);
  EXPECT_THAT(found.shift.likely_causes().front(), HasSubstr("wrong sign"));
  EXPECT_THAT(found.findings, Contains(HasSubstr("correct the sign of z_offset")));
}

/// Where paper and probe touch the same place, the paper counts: the probe's heights follow it, and the answer says so.
TEST(CommonShift, PaperCountsBeforeTheProbe) {
  VirtualPrinter printer = virtual_printer({.heights = 13, .saved_is_fit = true}, 3);
  BedReading paper = printer.readings.heights.front();
  paper.by_hand = true;
  paper.drops = *drops_to(printer.saved, *nozzle(printer.saved, paper.drops) + Eigen::Vector3d(0.0, 0.0, -0.5));
  printer.readings.heights.push_back(paper);
  const PrinterCalibration found = calibrated(printer, 0.0);
  EXPECT_NEAR(found.trigger.value, -0.5, 1e-6);
  EXPECT_NEAR(found.shift.value, -0.5, range_of(virtual_printer({.heights = 13, .saved_is_fit = true}, 3)) + 0.05);
  EXPECT_THAT(found.findings, Contains(StartsWith("Paper and probe differ by 0.50 mm at 1 place")));
  EXPECT_THAT(found.findings, Contains(HasSubstr("by +0.50 mm")));
  EXPECT_THAT(found.findings, Contains(HasSubstr("heights by hand confirm it")));
  EXPECT_TRUE(found.ladder.gross.heights.empty());
  // What agrees is not corrected, and what touched elsewhere is no other height of the same place.
  printer.readings.heights.back().drops =
      *drops_to(printer.saved, *nozzle(printer.saved, paper.drops) + Eigen::Vector3d(0.0, 0.0, 0.47));
  EXPECT_FALSE(trigger_error(printer.saved, printer.readings).is_stated);
  printer.readings.heights.back().drops =
      *drops_to(printer.saved, *nozzle(printer.saved, paper.drops) + Eigen::Vector3d(3.0, 0.0, 0.0));
  EXPECT_EQ(trigger_error(printer.saved, printer.readings).places, 0u);
}

/// A trigger height that varies from place to place: only the paper counts, and the answer says what to do. One trigger
/// height, or paper that agrees with the probe, is no such thing.
TEST(CommonShift, AProbeWhoseTriggerVariesDoesNotCount) {
  for (const double tilt : {0.0, 4e-3}) {
    VirtualPrinter printer = virtual_printer({.heights = 13, .saved_is_fit = true}, 3);
    for (const std::size_t k : {0u, 1u, 5u, 9u}) {
      BedReading paper = printer.readings.heights[k];
      paper.by_hand = true;
      printer.readings.heights.push_back(paper);
    }
    for (BedReading& one : printer.readings.heights) {
      if (!one.by_hand) one.height += 0.3 + tilt * nozzle(printer.saved, one.drops)->x();
    }
    const TriggerError error = trigger_error(printer.saved, printer.readings);
    EXPECT_EQ(error.varies, tilt > 0.0) << error.spread;
    EXPECT_EQ(error.is_stated, tilt == 0.0);
    const PrinterCalibration found = calibrated(printer, 0.0);
    EXPECT_EQ(found.advice, PrinterAdvice::keep_saved);
    if (!error.varies) continue;
    EXPECT_EQ(by_paper(printer.readings, error).heights.size(), 4u);
    EXPECT_THAT(found.findings, Contains(StartsWith("The trigger height of the probe varies by ")));
  }
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
  const PrinterCalibration found = calibrate_printer(set.geometry, set.readings);
  EXPECT_NE(found.advice, PrinterAdvice::check_input);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found.shift.endstop[i], right[i], 0.5);
}

/// A rotary delta's bed moves away from its shoulders.
TEST(CommonShift, OfARotaryDeltaMovesItsShoulders) {
  const DeltaGeometry saved = test::rotary_printer().saved;
  const DeltaGeometry moved = with_bed_higher(saved, 2.0);
  EXPECT_NEAR(moved.shoulder[1], saved.shoulder[1] - 2.0, 1e-12);
  const auto drops = drops_to(moved, {40.0, 30.0, 0.0});
  ASSERT_TRUE(drops);
  EXPECT_LT((*nozzle(saved, *drops) - Eigen::Vector3d(40.0, 30.0, 2.0)).norm(), 1e-9);
}

}  // namespace
}  // namespace paracal::common_shift_test
