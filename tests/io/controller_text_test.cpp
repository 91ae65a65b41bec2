// What firmwares print and owners write: each case is the same printer as in plain M-codes.

#include <gmock/gmock.h>

#include <string>

#include "paracal/error.hpp"
#include "paracal/io/machine_codes.hpp"
#include "paracal/io/printer_tables.hpp"
#include "paracal/units.hpp"

namespace paracal::controller_text_test {
namespace {

using io::CodeDialect;
using testing::HasSubstr;

DeltaGeometry read(const std::string& text, CodeDialect dialect) {
  return io::read_machine_codes({"settings", text}, dialect);
}

void expect_same(const DeltaGeometry& one, const DeltaGeometry& other) {
  EXPECT_LT((numbers_of(one) - numbers_of(other)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ControllerText, AnswersOfRepRapFirmware) {
  const std::string answers =
      "5.11.2019, 19:31:24\tM666\nEndstop adjustments X-1.36 Y1.11 Z0.25, tilt X0.00% Y0.00%\n5.11.2019, "
      "19:31:21\tM665\n"
      "Diagonals 288.140:288.140:288.130, delta radius 144.300, homed height 201.078, bed radius 105.0, X "
      "-0.084\xC2\xB0, "
      "Y 0.141\xC2\xB0, Z 0.000\xC2\xB0\n";
  const std::string codes =
      "M665 L288.140:288.140:288.130 R144.300 H201.078 B105.0 X-0.084 Y0.141 Z0\nM666 X-1.36 Y1.11 Z0.25 A0 B0\n";
  expect_same(read(answers, CodeDialect::reprapfirmware), read(codes, CodeDialect::reprapfirmware));
  EXPECT_EQ(io::print_radius_of_codes({"settings", answers}, CodeDialect::reprapfirmware), 105.0);
  std::string tilted = answers;
  tilted.replace(tilted.find("tilt X0.00%"), 11, "tilt X0.10%");
  EXPECT_THROW((void)read(tilted, CodeDialect::reprapfirmware), InputFileError);
}

TEST(ControllerText, GlobalsStandForTheirValues) {
  const std::string text =
      "global rod = 300.5 ; mm\nglobal bed=130\nset global.bed = 120\nM665 R142 L{global.rod} B{global.bed} H405.2\n";
  EXPECT_NEAR(read(text, CodeDialect::reprapfirmware).rod[1], 300.5, 1e-12);
  EXPECT_EQ(io::print_radius_of_codes({"settings", text}, CodeDialect::reprapfirmware), 120.0);
  EXPECT_THAT([] { (void)read("M665 R142 L{global.rod} H405\n", CodeDialect::reprapfirmware); },
              testing::ThrowsMessage<InputFileError>(HasSubstr("settings:1: expected a number after L")));
}

/// Before 2.0.6, B is no trim of a rod: the header line says so.
TEST(ControllerText, TheCalibrationRadiusOfMarlinIsNoTrim) {
  const std::string head = "echo:Delta settings: L<diagonal_rod> R<radius> H<height> B<calibration radius>\n";
  const std::string codes = "echo:  M665 L254.00 R131.00 H222.60 S200.00 B80.00 X0.00 Y0.00 Z0.00\n";
  EXPECT_EQ(read(head + codes, CodeDialect::marlin).rod[1], 254.0);
  EXPECT_THROW((void)read(codes, CodeDialect::marlin), InputFileError);
}

TEST(ControllerText, DefinitionsMayBeSumsOfOthers) {
  const auto radius = [](const std::string& value) {
    return read(
               "#define A_OFFSET 157.804\n#define B_OFFSET 23.816\n#define SAME DELTA_RADIUS\n#define DELTA\n"
               "#define DELTA_DIAGONAL_ROD 250.0\n#define DELTA_HEIGHT 270.0\n#define DELTA_RADIUS " +
                   value + "\n",
               CodeDialect::marlin)
        .radius;
  };
  EXPECT_NEAR(radius("(A_OFFSET - B_OFFSET - 8.988)"), 125.0, 1e-9);
  EXPECT_NEAR(radius("A_OFFSET - B_OFFSET + 1"), 134.988, 1e-9);
  EXPECT_THROW((void)radius("(SAME - B_OFFSET)"), InputFileError);  // it stands for itself
  EXPECT_THROW((void)radius("(UNKNOWN - 8.988)"), InputFileError);
}

TEST(ControllerText, FilesOfOtherFirmwaresAreNamed) {
  const auto refused = [](const std::string& text, const std::string& name) {
    EXPECT_THAT([&] { (void)read(text, CodeDialect::marlin); },
                testing::ThrowsMessage<InputFileError>(HasSubstr("got a file of " + name)));
  };
  refused("arm_solution linear_delta\narm_length 250\n", "Smoothieware");
  refused("EPR:3 881 250.000 Diagonal rod length [mm]\n", "Repetier");
  refused("[KINS]\nKINEMATICS = lineardeltakins\n", "LinuxCNC");
  EXPECT_THAT([] { (void)read("M665 L250 R125\n", CodeDialect::marlin); },
              testing::ThrowsMessage<InputFileError>(HasSubstr("add the height that G28 shows")));
}

/// Versions 1 to 3 name the columns of the grid differently; a plain 0 was not probed.
TEST(HeightMap, IsReadAsHeights) {
  const DeltaGeometry geometry = read("M665 R125 L250 H270 B85\n", CodeDialect::reprapfirmware);
  const std::string head = "RepRapFirmware height map file v2 generated at 2026-01-01 10:00\n";
  const std::string rows = "     0,  0.100,     0\n-0.213,  0.000,  0.014\n     0, -0.422,     0\n";
  for (const std::string& grid :
       {std::string("xmin,xmax,ymin,ymax,radius,spacing,xnum,ynum\n-80.00,80.00,-80.00,80.00,85.00,80.00,3,3\n"),
        std::string("xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n-80,80,-80,80,85,80,80,3,3\n"),
        std::string(
            "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1\nX,Y,-80,80,-80,80,85,80,80,3,3\n")}) {
    const DeltaReadings readings = io::read_printer_table({"map.csv", head + grid + rows}, geometry);
    ASSERT_EQ(readings.heights.size(), 5u) << grid;
    const auto first = nozzle(geometry, readings.heights[0].drops),
               second = nozzle(geometry, readings.heights[1].drops);
    EXPECT_LT((*first - Eigen::Vector3d(0.0, -80.0, 0.1)).norm(), 1e-6);
    EXPECT_LT((*second - Eigen::Vector3d(-80.0, 0.0, -0.213)).norm(), 1e-6);
    EXPECT_EQ(readings.heights[2].height, 0.0);
  }
  const auto refused = [&](const std::string& text, const std::string& part) {
    EXPECT_THAT(
        [&] {
          (void)io::read_printer_table({"map.csv", head + text}, geometry);
        },
        testing::ThrowsMessage<InputFileError>(HasSubstr(part)));
  };
  refused("", "expected rows of heights, got none");
  refused("xmax,radius\n80,85\n0.1,0.2\n", "map.csv:3: expected xmin of the height map, got none");
  refused("xmin,ymin,spacing\n-80,-80,80\n0.1,x\n", "map.csv:4: expected a height of the bed, got \"x\"");
  refused("xmin,ymin,spacing\n-500,-80,80\n0.1\n", "map.csv:4: expected a position that the printer reaches");
}

}  // namespace
}  // namespace paracal::controller_text_test
