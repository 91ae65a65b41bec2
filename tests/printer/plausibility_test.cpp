#include "paracal/printer/plausibility.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "paracal/error.hpp"
#include "paracal/printer/printer_calibration.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"

namespace paracal::plausibility_test {
namespace {

using test::KlipperSet;
using testing::Contains;
using testing::HasSubstr;

KlipperSet set_named(const std::string& id) {
  const std::vector<KlipperSet> sets = test::klipper_sets();
  return *std::ranges::find(sets, id, &KlipperSet::id);
}

/// Every drop of the readings through a function.
void change(DeltaReadings& readings, const std::function<JointDrops(const JointDrops&)>& by) {
  for (BedReading& one : readings.heights) one.drops = by(one.drops);
  for (PrintedDistance& one : readings.distances) {
    one.from = by(one.from);
    one.to = by(one.to);
  }
}

std::function<JointDrops(const JointDrops&)> times(double factor) {
  return [factor](const JointDrops& drops) {
    return JointDrops{factor * drops[0], factor * drops[1], factor * drops[2]};
  };
}

struct Wrong {
  const char* what;
  const char* set;
  std::function<void(KlipperSet&)> spoil;
  const char* said;
};

void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.what << " of " << wrong.set; }

class ImplausiblePrinter : public testing::TestWithParam<Wrong> {};

/// Nothing is advised, and what is likely to be wrong is named; where no machine closes at all, it is refused.
TEST_P(ImplausiblePrinter, IsNotAdvised) {
  KlipperSet set = set_named(GetParam().set);
  GetParam().spoil(set);
  try {
    const PrinterCalibration found = calibrate_printer(set.geometry, set.readings);
    EXPECT_EQ(found.advice, PrinterAdvice::check_input);
    EXPECT_THAT(found.findings.front(), HasSubstr("Check your file and your readings"));
    EXPECT_THAT(found.findings.at(1), HasSubstr(GetParam().said));
    EXPECT_EQ(numbers_of(found.advised()), numbers_of(set.geometry));
    EXPECT_FALSE(found.programs.calibration.accepted());  // no program is corrected by it
    EXPECT_FALSE(found.programs.calibration.reasons.empty());
  } catch (const Unreachable& refused) {
    EXPECT_THAT(refused.what(), HasSubstr(GetParam().said));
  }
}

void scale_steps(KlipperSet& set, double factor) { change(set.readings, times(factor)); }

INSTANTIATE_TEST_SUITE_P(
    Files, ImplausiblePrinter,
    testing::Values(
        Wrong{"gear ratio of 2", "K18", [](KlipperSet& set) { scale_steps(set, 0.5); }, ""},
        Wrong{"gear ratio of 2", "K35", [](KlipperSet& set) { scale_steps(set, 0.5); },
              "of all towers are 2 times as large"},
        Wrong{"half the micro-steps", "K18", [](KlipperSet& set) { scale_steps(set, 2.0); },
              "of all towers are 0.5 times as large"},
        Wrong{"half the micro-steps", "K09", [](KlipperSet& set) { scale_steps(set, 2.0); },
              "of all towers are 0.5 times as large"},
        Wrong{"rotation_distance of 32, not 40", "K18", [](KlipperSet& set) { scale_steps(set, 0.8); },
              "of all towers are 1.25 times as large"},
        Wrong{"16 teeth, not 17", "K34", [](KlipperSet& set) { scale_steps(set, 16.0 / 17.0); },
              "of all towers are 1.062 times as large"},
        Wrong{"motor of 0.9 deg on one tower", "K18",
              [](KlipperSet& set) {
                change(set.readings, [](const JointDrops& d) { return JointDrops{d[0], 0.5 * d[1], d[2]}; });
              },
              "of tower B are 2 times as large"},
        Wrong{"towers A and B exchanged", "K18",
              [](KlipperSet& set) {
                change(set.readings, [](const JointDrops& d) { return JointDrops{d[1], d[0], d[2]}; });
              },
              "the towers in the order BAC"},
        Wrong{"towers turned on", "K48",
              [](KlipperSet& set) {
                change(set.readings, [](const JointDrops& d) { return JointDrops{d[1], d[2], d[0]}; });
              },
              "the towers in the order CAB"},
        Wrong{"radius 10 % too large", "K18", [](KlipperSet& set) { set.geometry.radius *= 1.1; },
              "the radius is 178.00 mm in the file but"},
        Wrong{"radius 6 % too small", "K35", [](KlipperSet& set) { set.geometry.radius *= 0.94; }, "the radius is"},
        Wrong{"rods of another printer", "K18",
              [](KlipperSet& set) {
                for (double& rod : set.geometry.rod) rod *= 1.1;
              },
              "a rod is"},
        Wrong{"one rod of another printer", "K35", [](KlipperSet& set) { set.geometry.rod[0] += 40.0; },
              "differ too much"},
        Wrong{"rods shorter than three radii of 4", "K36",
              [](KlipperSet& set) { set.geometry.radius = 0.8 * set.geometry.rod[0]; }, "does not match rods"},
        Wrong{"tower 30 deg off", "K18", [](KlipperSet& set) { set.geometry.tower_angle[0] += to_radians(30.0); },
              "tower A is -30.0 deg from its design angle"},
        Wrong{"tower 8 deg off", "K18", [](KlipperSet& set) { set.geometry.tower_angle[1] += to_radians(8.0); },
              "tower B is +7.9 deg from its design angle"},
        Wrong{"an endstop 30 mm too high", "K47", [](KlipperSet& set) { set.geometry.endstop[2] += 30.0; },
              "endstops at"},
        Wrong{"distances in inches", "K18",
              [](KlipperSet& set) {
                for (PrintedDistance& one : set.readings.distances) one.distance /= 25.4;
              },
              ""},
        Wrong{"heights with a wrong probe", "K37",
              [](KlipperSet& set) {
                for (std::size_t k = 0; k < set.readings.heights.size(); ++k) {
                  set.readings.heights[k].height += k % 2 == 0 ? 6.0 : -6.0;
                }
              },
              "no delta printer explains these readings"},
        Wrong{"heights twice", "K37",
              [](KlipperSet& set) {
                const std::vector<BedReading> once = set.readings.heights;
                for (BedReading one : once) {
                  one.height += 0.5;
                  set.readings.heights.push_back(one);
                }
              },
              "mm differ by 0.50 mm"}));

/// And published printers, one of which has towers 2.3 deg and rods 5 % off, pass.
TEST(Plausibility, OfPublishedPrintersIsNotDoubted) {
  for (const KlipperSet& set : test::klipper_sets()) {
    EXPECT_THAT(implausible(set.geometry), testing::IsEmpty()) << set.id;
    EXPECT_NE(test::calibrated(set).advice, PrinterAdvice::check_input) << set.id;
  }
}

/// A probe cannot trigger below the bed; with the other sign the endstops are those of the bed.
TEST(ImplausibleReadings, HeightsBelowTheBedHaveTheWrongSign) {
  KlipperSet set = set_named("K18");
  DeltaReadings readings = set.readings;
  const double stated = readings.heights.front().height;
  for (BedReading& one : readings.heights) one.height = -6.0;
  const DeltaGeometry saved = with_bed_higher(set.geometry, stated + 6.0);  // follows the sign
  const PrinterCalibration found = calibrate_printer(saved, readings);
  EXPECT_EQ(found.advice, PrinterAdvice::check_input);
  const std::string& sentence = found.findings.at(1);
  EXPECT_THAT(sentence, HasSubstr("check the sign of z_offset (column height_mm). With +6.0 mm the endstops are "));
  const double first = std::stod(sentence.substr(sentence.find("endstops are ") + 13));
  EXPECT_NEAR(first, saved.endstop[0] + 2.0 * 6.0, 0.15);
  for (BedReading& one : readings.heights) one.height = -0.5;  // as beds give way
  EXPECT_FALSE(wrong_sign(set.geometry, readings));
  for (BedReading& one : readings.heights) one.by_hand = true;
  EXPECT_FALSE(wrong_sign(set.geometry, readings));
}

TEST(ImplausibleReadings, HeightsOfOnePlaceShowNoShape) {
  KlipperSet set = set_named("K18");
  const Eigen::Vector3d centre = *nozzle(set.geometry, set.readings.heights.front().drops);
  for (BedReading& one : set.readings.heights) one.drops = *drops_to(set.geometry, centre);
  EXPECT_THAT([&] { calibrate_printer(set.geometry, set.readings); },
              testing::ThrowsMessage<InvalidArgument>(HasSubstr("expected heights across the bed")));
}

/// Heights and distances that were measured with two sizes of steps.
TEST(ImplausibleReadings, KindsWithStepsOfTheirOwnAreNamed) {
  for (const double ratio : {2.0, 0.5}) {
    for (const bool heights : {true, false}) {
      KlipperSet set = set_named("K18");
      for (BedReading& one : set.readings.heights) one.drops = heights ? times(ratio)(one.drops) : one.drops;
      for (PrintedDistance& one : set.readings.distances) {
        if (heights) continue;
        one.from = times(ratio)(one.from);
        one.to = times(ratio)(one.to);
      }
      const PrinterCalibration found = calibrate_printer(set.geometry, set.readings);
      EXPECT_EQ(found.advice, PrinterAdvice::check_input);
      const std::string which = heights ? "heights" : "distances", others = heights ? "distances" : "heights";
      EXPECT_THAT(found.findings.at(1),
                  HasSubstr(fmt::format("the {} fit the file, and the {} fit it if their steps are {:.4g} times",
                                        others, which, 1.0 / ratio)));
    }
  }
}

}  // namespace
}  // namespace paracal::plausibility_test
