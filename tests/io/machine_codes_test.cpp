#include "paracal/io/machine_codes.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io::machine_codes_test {
namespace {

const DeltaGeometry kGeometry{.radius = 130.25,
                              .tower_angle = {to_radians(210.5), to_radians(329.75), to_radians(90.0)},
                              .rod = {290.5, 290.0, 289.75},
                              .endstop = {250.0, 250.5, 249.5}};

class EveryDialect : public testing::TestWithParam<CodeDialect> {};
INSTANTIATE_TEST_SUITE_P(Codes, EveryDialect, testing::Values(CodeDialect::reprapfirmware, CodeDialect::marlin));

/// The nozzle stands at the same place wherever the carriages hang.
TEST_P(EveryDialect, WhatIsWrittenIsTheSamePrinter) {
  const DeltaGeometry again = read_machine_codes({"config.g", machine_codes(kGeometry, GetParam())}, GetParam());
  for (const JointDrops& drops : {JointDrops{250, 250, 250}, JointDrops{200, 260, 240}, JointDrops{0, 0, 0}}) {
    EXPECT_LT((*nozzle(again, drops) - *nozzle(kGeometry, drops)).norm(), 5e-4);  // of four digits
  }
}

/// B is the printable radius in RepRapFirmware, a rod's trim in Marlin.
TEST_P(EveryDialect, AnExampleOfTheManualIsAPerfectDelta) {
  const std::string printable = GetParam() == CodeDialect::reprapfirmware ? "B85 " : "";
  const std::string text =
      fmt::format("; General\nM665 R105.6 L215.0 {}H235 ; delta radius, rods\nM666 X0 Y0 Z0 ; none\nG28\n", printable);
  const DeltaGeometry geometry = read_machine_codes({"config.g", text}, GetParam());
  EXPECT_EQ(geometry.radius, 105.6);
  EXPECT_EQ(geometry.rod, (std::array{215.0, 215.0, 215.0}));
  EXPECT_LT((*nozzle(geometry, {0, 0, 0}) - Eigen::Vector3d(0, 0, 235)).norm(), 1e-9);
  EXPECT_LT((*nozzle(geometry, {235, 235, 235})).norm(), 1e-9);
}

TEST(MachineCodes, AdjustmentsRaiseTheEndstopInOneFirmwareAndLowerItInTheOther) {
  const std::string text = "M665 L215 R105 H235\nM666 X-0.5 Y0 Z0\n";
  EXPECT_NEAR(read_machine_codes({"c", text}, CodeDialect::reprapfirmware).endstop[0], 234.5, 1e-9);
  EXPECT_NEAR(read_machine_codes({"c", text}, CodeDialect::marlin).endstop[0], 235.5, 1e-9);
}

TEST(MachineCodes, RodsMayDiffer) {
  EXPECT_EQ(read_machine_codes({"c", "M665 L260.1:260.2:260 R100 H200\n"}, CodeDialect::reprapfirmware).rod,
            (std::array{260.1, 260.2, 260.0}));
  EXPECT_EQ(read_machine_codes({"c", "M665 L260 R100 H200 A0.5 C-0.25\n"}, CodeDialect::marlin).rod,
            (std::array{260.5, 260.0, 259.75}));
}

void refused(CodeDialect dialect, const std::string& text, const std::string& part) {
  EXPECT_THAT(
      [&] {
        (void)read_machine_codes({"config.g", text}, dialect);
      },
      testing::ThrowsMessage<InputFileError>(testing::HasSubstr(part)));
}

/// As consoles print them, and as people type them.
TEST(MachineCodes, AreFoundInLogs) {
  for (const char* text :
       {"echo:  M665 L290.00 R130.25 H250.00 S160.00 X0.50 Y-0.25 Z0.00 A0.50 B0.00 C-0.25\n",
        "m665 l290 r130.25 h250 x0.5 y-0.25 z0 a0.5 c-0.25\n", "N12 M665L290R130.25H250X0.5Y-0.25Z0A.5C-.25*71\n",
        "Recv: echo:; Delta settings: L<rod> R<radius>\r\nRecv: echo:  M665 L290 R130.25 H250 X0.5 "
        "Y-0.25 Z0 A0.5 C-0.25\r\nSend: M6655 L1\nSend: M665\n"}) {
    const DeltaGeometry geometry = read_machine_codes({"log", text}, CodeDialect::marlin);
    EXPECT_EQ(geometry.radius, 130.25) << text;
    EXPECT_EQ(geometry.rod, (std::array{290.5, 290.0, 289.75})) << text;
    EXPECT_EQ(geometry.endstop[0], 250.0) << text;
    EXPECT_NEAR(to_degrees(geometry.tower_angle[1]), 329.75, 1e-9) << text;
  }
}

TEST(MachineCodes, StateTheBed) {
  const std::string text = "M665 R105.6 L215.0 B85.5 H235\n";
  EXPECT_EQ(print_radius_of_codes({"config.g", text}, CodeDialect::reprapfirmware), 85.5);
  EXPECT_EQ(print_radius_of_codes({"config.g", "M665 L215 R105 H235\n"}, CodeDialect::reprapfirmware), 0.0);
}

TEST(MachineCodes, AreRefusedWithTheirLine) {
  refused(CodeDialect::marlin, "M665 L200 R100 H200 Q1\n", "expected M665 with words of LRHSXYZABC, got \"Q1\"");
  refused(CodeDialect::reprapfirmware, "M665 L200 R100 H200\nM666 X0 A0.2 B0\n",
          "config.g:2: expected M666 without bed tilt, got A0.2");
  // A bed's radius is the trim of a rod to the other firmware.
  refused(CodeDialect::marlin, "M665 R105.6 L215.0 B85 H235\n", "differ too much");
  refused(CodeDialect::marlin, "G28\nM665 R100 H200\n", "config.g:2: expected M665 with L");
  refused(CodeDialect::marlin, "M665 L200 R100\n", "expected M665 with H");
  refused(CodeDialect::marlin, "\nM665 L2x0 R100 H200\n", "config.g:2: expected a number after L, got \"2x0\"");
  refused(CodeDialect::marlin, "M665 L200:201 R100 H200\n", "expected one number or three after L, got 2");
  refused(CodeDialect::marlin, "M665 L90 R100 H200\n", "rods longer than it");
  refused(CodeDialect::marlin, "M665 L200 R100 H200 X1e4\n", "tower angles up to 360 deg, got 10000");
  refused(CodeDialect::reprapfirmware, "M665 L217 R105 H240 X120 Y0 Z-120\n", "separate towers");
  refused(CodeDialect::marlin, "M665 L200 R100 H200\nM666 Xnan\n", "config.g:2: expected a number after X");
  refused(CodeDialect::reprapfirmware, "M669 K0\nM665 L200 R100 H200\nM666 X0\n",
          "config.g:1: expected M669 K3 (linear delta) or K10 (rotary delta), got K0");
}

// ---- rotary deltas

TEST(RotaryMachineCodes, WhatIsWrittenIsTheSamePrinter) {
  const DeltaGeometry printer{.actuator = Actuator::revolute,
                              .radius = 33.9,
                              .tower_angle = {to_radians(30.5), to_radians(149.75), to_radians(270.0)},
                              .rod = {320.5, 320.0, 319.75},
                              .endstop = {252.0, 253.5, 251.0},
                              .arm = {170.5, 170.0, 169.75},
                              .shoulder = {412.0, 413.0, 412.5}};
  const std::string codes = machine_codes(printer, CodeDialect::reprapfirmware);
  // The comment says what the line cannot: A with the printer's own lowest angle.
  const std::string highest = codes.substr(codes.find("then ") + 5, codes.find(" (angle") - codes.find("then ") - 5);
  const std::string text = fmt::format("{}M669 K10 A-40:{}\n", codes, highest);
  const DeltaGeometry again = read_machine_codes({"config.g", text}, CodeDialect::reprapfirmware);
  for (const JointDrops& drops : {JointDrops{0.8, 0.8, 0.8}, JointDrops{0.6, 0.9, 0.8}, JointDrops{0, 0, 0}}) {
    EXPECT_LT((*nozzle(again, drops) - *nozzle(printer, drops)).norm(), 5e-4);  // of four digits
  }
  EXPECT_THROW((void)machine_codes(printer, CodeDialect::marlin), InvalidArgument);
}

/// Arms level at the endstops: the nozzle hangs sqrt(L^2 - (R + U)^2) below the shoulders.
TEST(RotaryMachineCodes, LevelArmsMakeARightTriangle) {
  const std::string text = "M669 K10 U170 L320 R34 H412.5 A-30:0 X0.5 ; a comment with L1\n";
  const DeltaGeometry geometry = read_machine_codes({"config.g", text}, CodeDialect::reprapfirmware);
  EXPECT_EQ(geometry.actuator, Actuator::revolute);
  EXPECT_NEAR(to_degrees(geometry.tower_angle[0]), 210.5, 1e-12);
  for (const double endstop : geometry.endstop) EXPECT_NEAR(endstop, 412.5 - std::sqrt(320. * 320 - 204. * 204), 1e-9);
}

TEST(RotaryMachineCodes, AreRefusedWithTheirLine) {
  refused(CodeDialect::reprapfirmware, "G28\nM669 K10 U170 L320 R34 A-30:60\n",
          "config.g:2: expected M669 with H (height of the shoulders)");
  refused(CodeDialect::reprapfirmware, "M669 K10 U170 L320 R34 H412 A60\n",
          "config.g:1: expected two angles after A, got 1");
  refused(CodeDialect::reprapfirmware, "M669 K10 U170 L150 R34 H412 A-30:0\n",
          "expected rods that reach the centre when homed, got L 150");
  refused(CodeDialect::reprapfirmware, "M669 K10 U-1 L320 R34 H412 A-30:60\n",
          "expected R, U and L above 0, got 34, -1 and 320");
  refused(CodeDialect::reprapfirmware, "M669 K3\n", "expected M665 with L");
}

/// As owners have them: comments, blocks of them, and much else.
const std::string kConfiguration = R"(/**
 * Marlin 3D Printer Firmware
 * #define DELTA_RADIUS 1.0
 */
#define SERIAL_PORT 0
#if ENABLED(DELTA)
  #define PRINTABLE_RADIUS 95.5      // (mm)
  #define DELTA_DIAGONAL_ROD 260.0        // (mm)
  //#define DELTA_DIAGONAL_ROD 250.0
  # define DELTA_HEIGHT 200.25 /* from G33 */
  #define DELTA_ENDSTOP_ADJ { 0.0, -0.5, -1.25 } // Get these values from G33 auto calibrate
  #define DELTA_RADIUS 100.5
  #define DELTA_TOWER_ANGLE_TRIM { 0.3, -0.2, 0.0 }
  #define DELTA_RADIUS_TRIM_TOWER { 0.0, 0.0, 0.0 }
  #define DELTA_DIAGONAL_ROD_TRIM_TOWER { 0.5, 0.0, -0.25 }
#endif
)";

TEST(MarlinConfiguration, SaysWhatTheCodesSay) {
  const DeltaGeometry compiled = read_machine_codes({"Configuration.h", kConfiguration}, CodeDialect::marlin);
  const DeltaGeometry told = read_machine_codes(
      {"c", "M665 L260 R100.5 H200.25 X0.3 Y-0.2 Z0 A0.5 B0 C-0.25\nM666 X0 Y-0.5 Z-1.25\n"}, CodeDialect::marlin);
  EXPECT_EQ(compiled.rod, told.rod);
  EXPECT_EQ(compiled.radius, told.radius);
  EXPECT_EQ(compiled.endstop, told.endstop);
  EXPECT_EQ(compiled.tower_angle, told.tower_angle);
  EXPECT_EQ(print_radius_of_codes({"Configuration.h", kConfiguration}, CodeDialect::marlin), 95.5);
}

TEST(MarlinConfiguration, IsRefusedWithItsLine) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kConfiguration;
    return text.replace(text.find(from), from.size(), to);
  };
  const auto is_refused = [](const std::string& text, const std::string& part) {
    refused(CodeDialect::marlin, text, part);
  };
  is_refused(with("#define DELTA_RADIUS 100.5", "#define DELTA_RADIUS wide"), "config.g:12: expected a number after R");
  is_refused(with("{ 0.3, -0.2, 0.0 }", "{ 0.3, -0.2 }"), "config.g:13: expected 3 numbers for DELTA_TOWER_ANGLE_TRIM");
  is_refused(with("{ 0.0, 0.0, 0.0 }", "{ 0.0, 0.4, 0.0 }"), "config.g:14: expected one radius for all towers");
  is_refused(with("  //#define DELTA_DIAGONAL_ROD 250.0", "  #define DELTA_DIAGONAL_ROD 250.0"),
             "config.g:9: expected DELTA_DIAGONAL_ROD as in line 8 (260.0), got 250.0");
  is_refused("//#define DELTA // a printer of another kind\n" + std::string(kConfiguration),
             "config.g:1: expected #define DELTA, got it in a comment");
  EXPECT_NO_THROW((void)read_machine_codes({"c", "//#define DELTA\n#define DELTA\n" + std::string(kConfiguration)},
                                           CodeDialect::marlin));
  is_refused(with("  # define DELTA_HEIGHT 200.25 /* from G33 */", ""), "with H (homed height");
}

}  // namespace
}  // namespace paracal::io::machine_codes_test
