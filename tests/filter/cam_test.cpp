// Programs in the styles of CAM systems and of laser software: all but drilling convert.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "filtered_program.hpp"
#include "paracal/error.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::io::cam_test {
namespace {

using testing::HasSubstr;

constexpr auto kAny = GcodeDialect::any, kLinuxcnc = GcodeDialect::linuxcnc, kFanuc = GcodeDialect::fanuc_like;

struct Program {
  const char* name;
  GcodeDialect dialect;
  bool states_z = true;  ///< else --start does
  bool has_two_tools = false;
};

constexpr std::array kPrograms{Program{"cambam", kAny},
                               Program{"carbide_create", kAny},
                               Program{"estlcam", kAny},
                               Program{"freecad_grbl", kAny},
                               Program{"freecad_linuxcnc", kLinuxcnc},
                               Program{"fusion_fanuc", kFanuc},
                               Program{"fusion_haas", kFanuc},
                               Program{"fusion_linuxcnc", kLinuxcnc},
                               Program{"fusion_mach3", kAny},
                               Program{"haas_two_tools_inch", kFanuc, true, true},
                               Program{"inkscape_laser", kAny},
                               Program{"jscut", kAny},
                               Program{"kiri_moto", kAny},
                               Program{"lightburn_grbl", kAny, false},
                               Program{"lightburn_raster", kAny, false},
                               Program{"sheetcam_plasma", kAny, false},
                               Program{"two_tools", kLinuxcnc, true, true},
                               Program{"vectric_grbl", kAny},
                               Program{"vectric_mach3", kAny}};

std::string text_of(const std::string& name) {
  std::ifstream in(test::source_folder() / "tests/filter/cam" / (name + ".nc"), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Cam : public testing::Test {
 protected:
  test::Filtered converted(const Program& program, const std::string& text) const {
    GcodeOptions options{.origin = {0, 0, -900}, .dialect = program.dialect};
    if (!program.states_z) options.start = Pose{{0, 0, 0}, 0.0};
    if (program.has_two_tools) options.tools = ToolTable{{1, {0, 0, 40, 0}}, {2, {0, 0, 25, 0}}};
    return test::filtered_gcode(text, correction, options);
  }

  const Robot robot = catalogue::find("huang2016");
  const TargetCorrection correction{robot, test::table4_machine(robot, 1)};
};

/// Every feed that states X or Y is corrected; what is left are approach and retreat.
TEST_F(Cam, ProgramsOfManyStylesConvert) {
  std::set<std::string> tried{"bobcad_drill"};
  for (const Program& program : kPrograms) {
    SCOPED_TRACE(program.name);
    tried.insert(program.name);
    const std::string text = text_of(program.name);
    const test::Filtered result = converted(program, text);
    EXPECT_TRUE(result.summary.whole());
    EXPECT_GT(result.summary.corrected, 4);
    for (const PassedThrough& one : result.summary.passed) {
      EXPECT_EQ(one.between, 0) << one.reason << " line " << one.first_line;
    }
    EXPECT_TRUE(result.text.ends_with(text.substr(text.rfind('\n', text.size() - 2))));
  }
  for (const auto& entry : std::filesystem::directory_iterator(test::source_folder() / "tests/filter/cam")) {
    EXPECT_TRUE(tried.contains(entry.path().stem())) << entry.path();
  }
  EXPECT_THAT(
      [&] {
        converted({"bobcad_drill", kLinuxcnc}, text_of("bobcad_drill"));
      },
      testing::ThrowsMessage<InputFileError>(HasSubstr("part.ngc:7: ")));
}

/// What they need is said: a laser's height, the length of a second tool.
TEST_F(Cam, WhatIsMissingIsSaid) {
  for (const Program& program : kPrograms) {
    SCOPED_TRACE(program.name);
    const test::Filtered result = converted({program.name, program.dialect}, text_of(program.name));
    if (!program.states_z) {
      EXPECT_TRUE(result.has("give --start"));
    }
    if (program.has_two_tools) {
      EXPECT_TRUE(result.has("another tool than at the first corrected target (give --tools)"));
    }
    EXPECT_EQ(result.summary.whole(), program.states_z && !program.has_two_tools);
  }
}

}  // namespace
}  // namespace paracal::io::cam_test
