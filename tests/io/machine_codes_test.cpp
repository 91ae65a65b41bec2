#include "paracal/io/machine_codes.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

const DeltaGeometry kGeometry{.radius = 130.25,
                              .tower_angle = {to_radians(210.5), to_radians(329.75), to_radians(90.0)},
                              .arm = {290.5, 290.0, 289.75},
                              .endstop = {250.0, 250.5, 249.5}};

class EveryDialect : public testing::TestWithParam<CodeDialect> {};
INSTANTIATE_TEST_SUITE_P(Codes, EveryDialect, testing::Values(CodeDialect::reprapfirmware, CodeDialect::marlin));

/// The nozzle stands at the same place wherever the carriages hang.
TEST_P(EveryDialect, WhatIsWrittenIsTheSamePrinter) {
  const DeltaGeometry again = read_machine_codes({"config.g", machine_codes(kGeometry, GetParam())}, GetParam());
  for (const CarriageDrops& drops :
       {CarriageDrops{250, 250, 250}, CarriageDrops{200, 260, 240}, CarriageDrops{0, 0, 0}}) {
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
  EXPECT_EQ(geometry.arm, (std::array{215.0, 215.0, 215.0}));
  EXPECT_LT((*nozzle(geometry, {0, 0, 0}) - Eigen::Vector3d(0, 0, 235)).norm(), 1e-9);
  EXPECT_LT((*nozzle(geometry, {235, 235, 235})).norm(), 1e-9);
}

TEST(MachineCodes, AdjustmentsRaiseTheEndstopInOneFirmwareAndLowerItInTheOther) {
  const std::string text = "M665 L215 R105 H235\nM666 X-0.5 Y0 Z0\n";
  EXPECT_NEAR(read_machine_codes({"c", text}, CodeDialect::reprapfirmware).endstop[0], 234.5, 1e-9);
  EXPECT_NEAR(read_machine_codes({"c", text}, CodeDialect::marlin).endstop[0], 235.5, 1e-9);
}

TEST(MachineCodes, RodsMayDiffer) {
  EXPECT_EQ(read_machine_codes({"c", "M665 L260.1:260.2:260 R100 H200\n"}, CodeDialect::reprapfirmware).arm,
            (std::array{260.1, 260.2, 260.0}));
  EXPECT_EQ(read_machine_codes({"c", "M665 L260 R100 H200 A0.5 C-0.25\n"}, CodeDialect::marlin).arm,
            (std::array{260.5, 260.0, 259.75}));
}

TEST(MachineCodes, AreRefusedWithTheirLine) {
  const auto refused = [](const std::string& text, const std::string& part) {
    EXPECT_THAT(
        [&] {
          (void)read_machine_codes({"config.g", text}, CodeDialect::marlin);
        },
        testing::ThrowsMessage<InputFileError>(testing::HasSubstr(part)));
  };
  refused("G28\nM665 R100 H200\n", "config.g:2: expected M665 with L");
  refused("M665 L200 R100\n", "expected M665 with H");
  refused("\nM665 L2x0 R100 H200\n", "config.g:2: expected a number after L, got \"2x0\"");
  refused("M665 L200:201 R100 H200\n", "expected one length or three");
  refused("M665 L90 R100 H200\n", "rods longer than it");
  refused("M665 L200 R100 H200\nM666 Xnan\n", "config.g:2: expected a number after X");
}

}  // namespace
}  // namespace paracal::io
