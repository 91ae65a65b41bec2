// The ladder of corrections, on printers whose truth is known and on published ones.

#include "paracal/printer/ladder.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "paracal/printer/printer_calibration.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"
#include "printer/rotary_printer.hpp"
#include "printer/virtual_printer.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::ladder_test {
namespace {

using test::PrinterWorld;
using test::virtual_printer;
using test::VirtualPrinter;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// The shift of all heights is the bed's, as it is of virtual printers.
PrinterCalibration judged(const VirtualPrinter& printer) {
  return calibrate_printer(printer.saved, printer.readings, {.print_radius = printer.radius, .accepts_shift = true});
}

/// What came of many printers of a world, with the saved values as the ladder begins with them.
struct Outcome {
  int advised = 0, gains = 0, gains_advised = 0, worse = 0, larger = 0, deep = 0, held = 0;
};

Outcome outcome_of(const PrinterWorld& world, int count) {
  Outcome outcome;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(count); ++seed) {
    const VirtualPrinter printer = virtual_printer(world, seed);
    const PrinterCalibration found = judged(printer);
    const DeltaGeometry &saved = found.saved.geometry, &advised = found.advised();
    const bool is_new = found.advice == PrinterAdvice::accept_new;
    const double before = printer.first_layer(saved), after = printer.first_layer(advised);
    const bool gains = printer.first_layer(found.ladder.rungs.back().geometry) < 0.7 * before;
    outcome.advised += is_new;
    outcome.gains += gains;
    outcome.gains_advised += gains && is_new;
    outcome.worse += after > before + 0.01;
    outcome.larger += std::abs(printer.size_error(advised)) > std::abs(printer.size_error(saved)) + 5e-4;
    outcome.deep += is_new && printer.depth(advised) > 0.25;
    const LadderFigure& layer = found.ladder.saved().first_layer;
    outcome.held += layer.low - 0.02 <= before && before <= layer.high + 0.02;  // and what no shape holds
  }
  return outcome;
}

class LadderIn : public testing::TestWithParam<PrinterWorld> {};

/// Written down before: of printers that gain 30 % four in five are advised (of 20 that gain at least 13, of 8 five); a
/// first layer gets worse by more than 0.01 mm in at most one of 20, a size by more than 0.05 % in at most two; no
/// nozzle goes deeper into the bed than 0.25 mm. A promise of 95 % over all beds and callipers is one of 74 % for those
/// that are all at one standard deviation, to the same side: there a size gets worse in at most five of 20.
TEST_P(LadderIn, HelpsAndDoesNoHarm) {
  const int count = test::machines({.claim = 20, .quick = 8});
  const Outcome outcome = outcome_of(GetParam(), count);
  RecordProperty("outcome",
                 fmt::format("advised {}, gains {}, advised of these {}, worse {}, larger {}, held {}", outcome.advised,
                             outcome.gains, outcome.gains_advised, outcome.worse, outcome.larger, outcome.held));
  EXPECT_GE(outcome.gains_advised, 0.65 * outcome.gains - 1.0);
  EXPECT_LE(outcome.worse, 1);
  EXPECT_LE(outcome.larger, GetParam().bow != 0.0 || GetParam().bias != 0.0 ? 5 : 2);
  EXPECT_EQ(outcome.deep, 0);
  EXPECT_GE(outcome.held, 0.8 * count);
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, LadderIn,
    testing::Values(PrinterWorld{.heights = 7}, PrinterWorld{.heights = 13}, PrinterWorld{.heights = 41},
                    PrinterWorld{.heights = 13, .bow = 0.12}, PrinterWorld{.leaning = 3.0, .heights = 13},
                    PrinterWorld{.heights = 7, .distances = 12, .two_lengths = true},
                    PrinterWorld{.heights = 13, .distances = 12, .two_lengths = true, .bow = -0.12},
                    PrinterWorld{.bias = -0.2, .heights = 7, .distances = 12, .two_lengths = true},
                    PrinterWorld{.heights = 13, .distances = 24, .two_lengths = true, .calibrated_before = true}));

PrinterCalibration of_thirteen(bool distances) {
  return judged(virtual_printer({.heights = 13, .distances = distances ? 12 : 0, .two_lengths = true}, 2));
}

/// Each rung changes its own numbers and those below, and from heights alone the rods stay.
TEST(Ladder, EachRungHoldsThoseBelowIt) {
  for (const bool distances : {false, true}) {
    const PrinterCalibration found = of_thirteen(distances);
    ASSERT_EQ(found.ladder.rungs.size(), distances ? 5u : 4u);
    const DeltaGeometry& saved = found.saved.geometry;
    for (const RungValues& one : found.ladder.rungs) {
      const DeltaNumbers by = numbers_of(one.geometry) - numbers_of(saved);
      EXPECT_EQ(by.head<3>().isZero(), one.rung < Rung::height);
      EXPECT_EQ(by(DeltaNumber::radius) == 0.0, one.rung < Rung::radius);
      EXPECT_EQ(by.segment<2>(DeltaNumber::angle).isZero(), one.rung < Rung::towers);
      EXPECT_EQ(by.segment<3>(DeltaNumber::rod).isZero(), one.rung < Rung::rods);
      EXPECT_LE(one.first_layer.low, one.first_layer.value);
      EXPECT_LE(one.first_layer.value, one.first_layer.high);
    }
  }
}

/// Every rung that is allowed meets every rule, and the highest of them is advised.
TEST(Ladder, AdvisesTheHighestRungThatMeetsEveryRule) {
  int refused = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Ladder ladder = judged(virtual_printer({.heights = seed % 2 == 0 ? 7 : 13}, seed)).ladder;
    std::size_t highest = 0;
    for (std::size_t k = 1; k < ladder.rungs.size(); ++k) {
      const RungValues& one = ladder.rungs[k];
      refused += !one.is_allowed;
      if (!one.is_allowed) continue;
      EXPECT_GE(one.chance, 0.95);
      EXPECT_LE(one.depth, 0.2);
      EXPECT_LE(one.first_layer.value, ladder.rungs[highest].first_layer.value);
      highest = k;
    }
    EXPECT_EQ(ladder.advised, highest);
  }
  EXPECT_GT(refused, 0);
}

/// Rules that nobody can meet let nothing be advised: each of them counts.
TEST(Ladder, EachRuleCounts) {
  const VirtualPrinter printer = virtual_printer({.heights = 13, .distances = 12, .two_lengths = true}, 2);
  PrinterCalibrationOptions options{.print_radius = printer.radius, .accepts_shift = true};
  EXPECT_NE(calibrate_printer(printer.saved, printer.readings, options).ladder.advised, 0u);
  options.rules.certain = 1.1;
  EXPECT_EQ(calibrate_printer(printer.saved, printer.readings, options).ladder.advised, 0u);
  options.rules = {.deepest = -1.0, .of_saved = -1.0};
  EXPECT_EQ(calibrate_printer(printer.saved, printer.readings, options).ladder.advised, 0u);
  options.rules = {.size = -1.0};
  const PrinterCalibration found = calibrate_printer(printer.saved, printer.readings, options);
  EXPECT_LE(found.ladder.best().rung, Rung::towers);
  EXPECT_EQ(found.ladder.best().geometry.radius, found.saved.geometry.radius);
}

/// A bed whose edge lies 0.2 mm high looks like a radius: heights alone do not follow it by more than nobody notices.
TEST(Ladder, ABowedBedIsNoRadius) {
  int held = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const PrinterCalibration found = judged(virtual_printer({.heights = 13, .saved_is_fit = true, .bow = 0.2}, seed));
    const Ladder& ladder = found.ladder;
    for (const RungValues& one : ladder.rungs) {
      if (!one.holds_radius) continue;
      ++held;
      EXPECT_LE(one.chance_size, 0.06);
    }
    if (ladder.advised == 0) continue;
    EXPECT_LE(std::abs(ladder.best().size.value - ladder.saved().size.value), 1e-3) << seed;
  }
  RecordProperty("held", held);
}

/// A radius 3 mm off with a levelled rim is levelled by no endstops: there the radius follows the heights, and the
/// answer says what the size will do.
TEST(Ladder, FollowsHeightsThatOnlyARadiusLevels) {
  const std::array<double, 3> angles{to_radians(210.0), to_radians(330.0), to_radians(90.0)};
  const DeltaGeometry actual{
      .radius = 137.8, .tower_angle = angles, .rod = {280, 280, 280}, .endstop = {300, 300, 300}};
  DeltaGeometry saved = actual;
  saved.radius = 140.8;
  DeltaReadings readings;
  for (const Eigen::Vector3d& place : printable_disk(80.0)) readings.heights.push_back({0.0, *drops_to(actual, place)});
  const PrinterCalibration found = calibrate_printer(saved, readings, {.accepts_shift = true});
  EXPECT_GE(found.ladder.best().rung, Rung::radius);
  EXPECT_NEAR(found.advised().radius, 137.8, 0.05);
  EXPECT_THAT(found.findings, Contains(HasSubstr("changes the size of prints by -")));
}

/// A reading that contradicts all others leaves every fit, by number; one that no other checks is named.
TEST(Ladder, ExcludesGrossReadings) {
  VirtualPrinter printer = virtual_printer({.heights = 41, .distances = 12, .two_lengths = true}, 5);
  for (const std::size_t k : {7u, 23u}) printer.readings.heights[k].height -= 10.0;
  printer.readings.distances[4].distance += 2.0;
  const PrinterCalibration found = judged(printer);
  EXPECT_THAT(found.ladder.gross.heights, ElementsAre(7, 23));
  EXPECT_THAT(found.ladder.gross.distances, ElementsAre(4));
  EXPECT_THAT(found.findings, Contains(HasSubstr("heights 7, 23. Measure them again")));
  EXPECT_LT(found.ladder.noise_height, 0.06);
  EXPECT_TRUE(found.ladder.unchecked.heights.empty());
  const PrinterCalibration few = judged(virtual_printer({.heights = 7}, 5));
  EXPECT_FALSE(few.ladder.unchecked.heights.empty());
  EXPECT_THAT(few.details, Contains(HasSubstr("Not checked by any other reading: heights ")));
}

/// Readings left out one by one, predicted by the firmware's formula: over the errors of the firmware's own fit.
struct LeftOut {
  double height = 0.0, distance = 0.0;
};

LeftOut left_out(const DeltaGeometry& saved, const DeltaReadings& readings) {
  LeftOut ours, theirs;
  for (std::size_t k = 0; k < readings.heights.size() + readings.distances.size(); ++k) {
    const bool is_height = k < readings.heights.size();
    const std::size_t at = is_height ? k : k - readings.heights.size();
    const DeltaReadings rest =
        without(readings, is_height ? ReadingNumbers{.heights = {at}} : ReadingNumbers{.distances = {at}});
    const auto add = [&](const DeltaGeometry& values, LeftOut& to) {
      if (is_height) {
        const BedReading& one = readings.heights[at];
        to.height += std::pow(nozzle(values, one.drops)->z() - one.height, 2);
      } else {
        const PrintedDistance& one = readings.distances[at];
        to.distance += std::pow((*nozzle(values, one.to) - *nozzle(values, one.from)).norm() - one.distance, 2);
      }
    };
    add(*fit_rung(saved, rest, Rung::rods), ours);
    add(fit_as_firmware(saved, rest).geometry, theirs);
  }
  return {std::sqrt(ours.height / theirs.height), std::sqrt(ours.distance / theirs.distance)};
}

/// Written down before: at most 0.80 (heights) and 0.83 (distances) in the median of seven published printers.
TEST(Ladder, PredictsPublishedPrintersBetterThanTheFirmwaresFit) {
  std::vector<double> heights, distances;
  for (const test::KlipperSet& set : test::klipper_sets()) {
    if (set.readings.distances.empty()) continue;
    const LeftOut ratios = left_out(set.geometry, set.readings);
    heights.push_back(ratios.height);
    distances.push_back(ratios.distance);
    EXPECT_LT(ratios.height, 1.0) << set.id;
    EXPECT_LT(ratios.distance, 1.0) << set.id;
  }
  ASSERT_EQ(heights.size(), 7u);
  RecordProperty("ratios", fmt::format("{:.2f}, {:.2f}", test::quantile(heights, 0.5), test::quantile(distances, 0.5)));
  EXPECT_LE(test::quantile(heights, 0.5), 0.80);
  EXPECT_LE(test::quantile(distances, 0.5), 0.83);
}

/// Rotary deltas climb the same ladder: endstops with shoulders, radius, towers, rods with arms.
TEST(Ladder, OfRotaryDeltas) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const test::RotaryPrinter made = test::rotary_printer(seed);
    const PrinterCalibration found = calibrate_printer(made.saved, made.readings, {.accepts_shift = true});
    EXPECT_EQ(found.firmware.parameters, 7);
    EXPECT_EQ(found.ladder.rungs.size(), 5u);
    EXPECT_LT(found.ladder.rungs.back().first_layer.value, found.ladder.saved().first_layer.value) << seed;
  }
}

/// What was accepted leaves nothing to change.
TEST(PrinterAdvice, OfItsOwnValuesIsThatNothingIsToBeChanged) {
  const VirtualPrinter printer = virtual_printer({.heights = 13, .distances = 12, .two_lengths = true}, 2);
  const PrinterCalibration first = judged(printer);
  ASSERT_EQ(first.advice, PrinterAdvice::accept_new);
  const PrinterCalibration again =
      calibrate_printer(first.advised(), printer.readings, {.print_radius = printer.radius});
  EXPECT_EQ(again.advice, PrinterAdvice::keep_saved);
  EXPECT_THAT(again.findings.front(), StartsWith("Keep your values: "));
}

/// The answer: one sentence with both figures, then at most five notes.
TEST(PrinterAdvice, SaysWhatToDoFirst) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const PrinterCalibration found = judged(virtual_printer({.heights = seed % 2 == 0 ? 7 : 13}, seed));
    const std::string& first = found.findings.front();
    const Ladder& ladder = found.ladder;
    EXPECT_LE(found.findings.size(), 6u);
    EXPECT_EQ(first.starts_with("Change "), found.advice == PrinterAdvice::accept_new) << first;
    if (found.advice == PrinterAdvice::accept_shift) continue;
    EXPECT_THAT(first, HasSubstr(fmt::format("{:.3f}", ladder.best().first_layer.value)));
    EXPECT_THAT(first, HasSubstr(fmt::format("{:+.2f} %", 1e2 * ladder.best().size.value)));
    EXPECT_THAT(found.findings, Contains(HasSubstr("would settle")));
  }
}

/// Why nothing is advised is said of what was asked, and is so.
TEST(PrinterAdvice, SaysWhatKeepsTheSavedValues) {
  int said = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const PrinterCalibration found = judged(virtual_printer({.heights = 13, .saved_is_fit = true}, seed));
    if (found.advice != PrinterAdvice::keep_saved) continue;
    const std::string& first = found.findings.front();
    const auto& rungs = found.ladder.rungs;
    const RungValues& best = *std::min_element(rungs.begin() + 1, rungs.end(), [](const auto& one, const auto& other) {
      return one.first_layer.value < other.first_layer.value;
    });
    const auto says = [&](const char* words) { return first.find(words) != std::string::npos; };
    if (says("nothing to change")) continue;
    ++said;
    EXPECT_EQ(says("95 % is required"), best.chance < 0.95) << first;
    EXPECT_EQ(says("below the bed"), best.chance >= 0.95 && best.depth > 0.2) << first;
  }
  EXPECT_GT(said, 3);
}

/// Distances of one length: an offset of the calliper looks like a size, and the answer asks for another length.
TEST(PrinterAdvice, AsksForASecondLength) {
  const PrinterCalibration one = judged(virtual_printer({.heights = 7, .distances = 12}, 1));
  const PrinterCalibration two = judged(virtual_printer({.heights = 7, .distances = 12, .two_lengths = true}, 1));
  const auto width = [](const PrinterCalibration& found) {
    const LadderFigure& size = found.ladder.rungs.back().size;
    return size.high - size.low;
  };
  EXPECT_GT(width(one), 1.5 * width(two));
  if (one.ladder.advised + 1 < one.ladder.rungs.size()) {
    EXPECT_THAT(one.findings, Contains(HasSubstr("look the same: also measure a length of about ")));
  }
}

/// Beyond five notes the rest are details.
TEST(PrinterAdvice, HasAtMostFiveNotes) {
  VirtualPrinter printer = virtual_printer({.heights = 41}, 5);
  printer.readings.heights[7].height -= 10.0;
  printer.saved.rod[0] -= 3.0;
  const PrinterCalibration found =
      calibrate_printer(with_bed_higher(printer.saved, -20.0), printer.readings, {.print_radius = printer.radius});
  EXPECT_EQ(found.findings.size(), 6u);
  EXPECT_THAT(found.details, Contains(HasSubstr("would settle")));
}

/// Rods that nobody cuts so are named.
TEST(PrinterAdvice, NamesRodsThatDiffer) {
  VirtualPrinter printer = virtual_printer({.heights = 13}, 2);
  EXPECT_THAT(judged(printer).findings, Not(Contains(HasSubstr("The rods are entered as"))));
  printer.saved.rod[0] -= 3.0;
  EXPECT_THAT(judged(printer).findings, Contains(HasSubstr("The rods are entered as")));
}

}  // namespace
}  // namespace paracal::ladder_test
