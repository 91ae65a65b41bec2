// Which values of a printer.cfg are in force, and a printer.cfg with others.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "paracal/error.hpp"
#include "paracal/io/klipper.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"
#include "printer/rotary_printer.hpp"

namespace paracal::klipper_config_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

test::KlipperSet set_named(const std::string& id) {
  const std::vector<test::KlipperSet> sets = test::klipper_sets();
  return *std::ranges::find(sets, id, &test::KlipperSet::id);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The firmware takes lines off its block whose keys are typed elsewhere.
TEST(KlipperConfig, TypedValuesAreInForceAndTheOverriddenLineIsNamed) {
  const test::KlipperSet set = set_named("K18");
  EXPECT_THAT(io::read_klipper({"printer.cfg", set.config}).notes, IsEmpty());
  const std::string text = with(set.config, "max_velocity: 300\n", "max_velocity: 300\ndelta_radius: 160.5 ; typed\n");
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", text});
  EXPECT_EQ(printer.geometry.radius, 160.5);
  ASSERT_EQ(printer.notes.size(), 1u);
  EXPECT_THAT(
      printer.notes[0],
      HasSubstr("printer.cfg:7: delta_radius 160.5 of [printer] is in force, because a typed line overrides the "
                "saved 161.820563 (line "));
}

TEST(KlipperConfig, TheSameNumberTypedIsNoContradiction) {
  const test::KlipperSet set = set_named("K18");
  const std::string text = with(set.config, "max_velocity: 300\n", "max_velocity: 300\ndelta_radius: 161.8205630\n");
  EXPECT_THAT(io::read_klipper({"printer.cfg", text}).notes, IsEmpty());
}

TEST(KlipperConfig, AMissingIncludeIsANoteUnlessItIsNeeded) {
  const test::KlipperSet set = set_named("K18");
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", "[include mainsail.cfg]\n" + set.config});
  ASSERT_EQ(printer.notes.size(), 1u);
  EXPECT_THAT(printer.notes[0], HasSubstr("printer.cfg:1: the included mainsail.cfg is missing here"));
  const std::string text = "[include steppers.cfg]\n[printer]\nkinematics: delta\ndelta_radius: 100\n";
  EXPECT_THAT(
      [&] {
        (void)io::read_klipper({"printer.cfg", text});
      },
      testing::ThrowsMessage<InputFileError>(
          HasSubstr("expected arm_length in [stepper_a], got none; it may be in steppers.cfg, which printer.cfg:1")));
}

DeltaGeometry other_values(DeltaGeometry geometry) {
  geometry.radius += 0.123456789;
  for (std::size_t i = 0; i < 3; ++i) {
    const double more = 0.1 * static_cast<double>(i + 1);
    geometry.rod[i] += more;
    geometry.endstop[i] -= more;
    if (geometry.actuator == Actuator::revolute) geometry.arm[i] += more;
    if (i < 2) geometry.tower_angle[i] += 1e-3 * more;
  }
  return geometry;
}

/// The nozzle goes where it was promised to, to 1e-6 mm.
void expect_in_force(const std::string& text, const DeltaGeometry& geometry, const std::vector<JointDrops>& drops) {
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", text});
  ASSERT_FALSE(drops.empty());
  for (const JointDrops& one : drops) {
    EXPECT_LT((*nozzle(printer.geometry, one) - *nozzle(geometry, one)).norm(), 1e-6);
  }
}

std::vector<JointDrops> drops_of(const DeltaReadings& readings) {
  std::vector<JointDrops> drops;
  for (const BedReading& one : readings.heights) drops.push_back(one.drops);
  for (const PrintedDistance& one : readings.distances) drops.insert(drops.end(), {one.from, one.to});
  return drops;
}

TEST(KlipperConfig, AWholeOneHoldsTheValuesAndEverythingElse) {
  for (const test::KlipperSet& set : test::klipper_sets()) {
    const std::string before = with(set.config, "max_velocity: 300\n", "max_velocity: 300\ndelta_radius: 1e2 # mine\n");
    const DeltaGeometry geometry = other_values(set.geometry);
    const std::string after = io::klipper_config({"printer.cfg", before}, geometry);
    expect_in_force(after, geometry, drops_of(set.readings));
    EXPECT_THAT(after, HasSubstr(fmt::format("delta_radius: {:.9f} # mine\n", geometry.radius)));
    EXPECT_THAT(after, HasSubstr("serial: /dev/ttyUSB0  # not ours\n"));
    // Line by line nothing else is touched.
    EXPECT_EQ(std::ranges::count(before, '\n'), std::ranges::count(after, '\n')) << set.id;
    EXPECT_EQ(io::klipper_config({"printer.cfg", after}, geometry), after);
  }
}

/// The rules of klippy/configfile.py: where anything else stands among the lines of the block or below them, or where
/// they do not begin as they should, the firmware reads none of them. Their readings are true all the same.
TEST(KlipperConfig, ABlockThatTheFirmwarePassesOverIsNotInForce) {
  const test::KlipperSet set = set_named("K18");
  const std::string head = "#*# <---------------------- SAVE_CONFIG ---------------------->\n";
  const std::string typed = fmt::format(
      "[printer]\nkinematics: delta\ndelta_radius: 160.5\n[stepper_a]\narm_length: 330\nangle: 210\nposition_endstop: "
      "400\n[stepper_b]\nangle: 330\n[stepper_c]\nangle: 90\n");
  const std::string all = typed + set.config;
  ASSERT_THAT(io::read_klipper({"printer.cfg", all}).notes, testing::Not(Contains(HasSubstr("ignores the whole"))));
  for (const auto& [broken, why] : std::map<std::string, std::string>{
           {all + "[gcode_macro START]\ngcode:\n  G28\n", "\"[gcode_macro START]\", which does not begin with #*#"},
           {all + "\n[fan]\n", "an empty line, which does not begin"},
           {all + "#*#[printer]\n", "\"#*#[printer]\", which does not begin"},
           {with(all, head, "#*# SAVE_CONFIG\n"), "\"#*# SAVE_CONFIG\", which is above the three lines"},
           {"#*# mine\n" + all, "\"#*# mine\", which is above the three lines"},
           {all + "#*#\n" + head + "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n#*#\n",
            "which begins a second block"}}) {
    const std::string& text = broken;
    const io::KlipperDelta printer = io::read_klipper({"printer.cfg", text});
    EXPECT_THAT(printer.notes, Contains(testing::AllOf(HasSubstr("ignores the whole SAVE_CONFIG"), HasSubstr(why))));
    EXPECT_EQ(printer.geometry.rod, (std::array<double, 3>{330.0, 330.0, 330.0})) << why;
    EXPECT_EQ(printer.readings.heights.size(), set.readings.heights.size()) << why;
    EXPECT_THAT(
        [&] {
          (void)io::klipper_config({"printer.cfg", text}, printer.geometry);
        },
        testing::ThrowsMessage<InputFileError>(HasSubstr("expected a SAVE_CONFIG block that Klipper reads")));
  }
  // Blank lines at the end do not matter, nor does what a file of Windows ends lines with.
  std::string windows;
  for (const char one : all + "\n\n") windows += one == '\n' ? std::string("\r\n") : std::string(1, one);
  EXPECT_THAT(io::read_klipper({"printer.cfg", windows}).notes, testing::Not(Contains(HasSubstr("ignores the whole"))));
  // Where nothing else states the geometry, the firmware does not start.
  EXPECT_THAT(
      [&] {
        (void)io::read_klipper({"printer.cfg", set.config + "[fan]\n"});
      },
      testing::ThrowsMessage<InputFileError>(testing::AllOf(
          HasSubstr("that the firmware reads: it ignores the whole SAVE_CONFIG block"), HasSubstr("[fan]"))));
}

TEST(KlipperConfig, ReadingsBehindAGapAreCounted) {
  const test::KlipperSet set = set_named("K18");
  const std::string text = with(set.config, "#*# height2 = ", "#*# hight2 = ");
  const io::KlipperDelta printer = io::read_klipper({"printer.cfg", text});
  EXPECT_EQ(printer.readings.heights.size(), 2u);
  EXPECT_THAT(printer.notes, Contains(HasSubstr(fmt::format("height2 is missing: {} later readings are ignored",
                                                            set.readings.heights.size() - 3))));
}

/// Arms are typed: lines of the block alone would not move them.
TEST(KlipperConfig, ChangesTypedArmsOfARotaryDelta) {
  const test::RotaryPrinter made = test::rotary_printer();
  const DeltaGeometry geometry = other_values(made.saved);
  expect_in_force(io::klipper_config({"printer.cfg", made.config}, geometry), geometry, drops_of(made.readings));
  // As the block's lines alone do not.
  const std::string lines = made.config + io::klipper_save_config(geometry);
  EXPECT_EQ(io::read_klipper({"printer.cfg", lines}).geometry.arm, made.saved.arm);
}

/// B and C have the rod of A where they state none: then each gets its own line in a block.
TEST(KlipperConfig, AddsABlockForWhatIsNowhereStated) {
  const std::string tower = "step_distance: 0.00625\n";
  const std::string text = "[printer]\nkinematics: delta\ndelta_radius: 105\n[stepper_a]\nposition_endstop: 250\n" +
                           tower + "arm_length: 217\n[stepper_b]\n" + tower + "[stepper_c]\n" + tower;
  const DeltaGeometry geometry = other_values(io::read_klipper({"printer.cfg", text}).geometry);
  const std::string after = io::klipper_config({"printer.cfg", text}, geometry);
  const auto bed = [&](double x, double y) { return *drops_to(geometry, {x, y, 0.0}); };
  expect_in_force(after, geometry, {bed(0, 0), bed(60, 0), bed(-40, 50)});
  EXPECT_THAT(after, HasSubstr("<---------------------- SAVE_CONFIG ---------------------->\n"));
  EXPECT_THAT(after, HasSubstr("#*# [stepper_b]\n#*# angle = "));
  EXPECT_TRUE(after.starts_with("[printer]\nkinematics: delta\ndelta_radius: 105.123456789\n"));
}

/// An independent reading of the rules: typed lines first, then those of the block, B and C as A.
TEST(KlipperConfig, IsReadAsTheFirmwareReadsIt) {
  const test::KlipperSet set = set_named("K19");
  const DeltaGeometry geometry = other_values(set.geometry);
  const std::string after = io::klipper_config(
      {"printer.cfg", with(set.config, "step_pin: PF1\n", "step_pin: PF1\narm_length = 1 ; own\n")}, geometry);
  std::map<std::string, double> typed, saved;
  std::string section;
  for (std::size_t at = 0; at < after.size();) {
    std::string line = after.substr(at, after.find('\n', at) - at);
    at += line.size() + 1;
    const bool block = line.starts_with("#*# ");
    if (block) line.erase(0, 4);
    line.resize(std::min(line.find_first_of("#;"), line.size()));
    if (line.starts_with('[')) section = line.substr(1, line.find(']') - 1);
    const std::size_t mark = line.find_first_of(":=");
    if (mark == std::string::npos || line.starts_with('[')) continue;
    std::string key = line.substr(0, mark);
    key.resize(key.find_last_not_of(' ') + 1);
    (block ? saved : typed)[section + " " + key] = std::atof(line.c_str() + mark + 1);
  }
  const auto value = [&](const std::string& key) { return typed.contains(key) ? typed.at(key) : saved.at(key); };
  EXPECT_NEAR(value("printer delta_radius"), geometry.radius, 1e-9);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string tower = fmt::format("stepper_{} ", "abc"[i]);
    EXPECT_NEAR(value(tower + "arm_length"), geometry.rod[i], 1e-9);
    EXPECT_NEAR(value(tower + "position_endstop"), geometry.endstop[i], 1e-9);
    EXPECT_NEAR(value(tower + "angle"), to_degrees(geometry.tower_angle[i]), 1e-9);
  }
}

}  // namespace
}  // namespace paracal::klipper_config_test
