// Exports, each with the real thing: the C99 header built by compilers, and what all of them say of themselves.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "broken_input.hpp"
#include "exported.hpp"

namespace paracal::test::export_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// ---- C99

/// The C program around the header: reads poses (mm, rad) and prints joints in deg.
const std::string kKernel = R"(#include "compensator.h"
int self_test(void) { return paracal_self_test(); }
int joints_of(const double pose[4], double joints[4]) {
  const double all[6] = {pose[0], pose[1], pose[2], 0.0, 0.0, pose[3]};
  return paracal_compensate(all, joints, 0);
}
)";

const std::string kMain = R"(#include <math.h>
#include <stdio.h>
int self_test(void);
int joints_of(const double pose[4], double joints[4]);
int main(void) {
  double p[4], q[4] = {7.0, 7.0, 7.0, 7.0};
  const double degrees = 180.0 / 3.14159265358979323846;
  if (self_test() != 0) return 10;
  p[0] = p[1] = p[3] = 0.0;
  p[2] = -5000.0;
  if (joints_of(p, q) != 1 || q[0] != 7.0) return 11;
  p[2] = NAN;
  if (joints_of(p, q) != 2 || q[0] != 7.0) return 12;
  while (scanf("%lf %lf %lf %lf", &p[0], &p[1], &p[2], &p[3]) == 4) {
    p[3] /= degrees;
    if (joints_of(p, q) != 0) return 13;
    printf("%.17g %.17g %.17g %.17g\n", q[0] * degrees, q[1] * degrees, q[2] * degrees, q[3] * degrees);
  }
  return 0;
}
)";

class C99Export : public Export, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    Export::SetUp();
    if (*GetParam() == '\0') GTEST_SKIP() << "this compiler is not installed";
    export_to("c99", "compensator.h");
    folder.write("kernel.c", kKernel);
    folder.write("main.c", kMain);
  }
};

INSTANTIATE_TEST_SUITE_P(Compilers, C99Export, testing::Values(PARACAL_GCC, PARACAL_CLANG),
                         [](const auto& one) { return one.index == 0 ? "gcc" : "clang"; });

TEST_P(C99Export, GivesTheLibrarysJoints) {
  const std::string compile = std::string(GetParam()) + " -std=c99 -O2 -pedantic -Wall -Wextra -Werror ";
  ASSERT_EQ(shell(compile + "-ffreestanding -Wshadow -Wconversion -c kernel.c"), 0);
  ASSERT_EQ(shell(compile + "main.c kernel.o -lm -o program"), 0);
  const std::vector<PoseNumbers> poses = random_poses(every_machine() ? 10'000 : 2000);
  folder.write("poses.txt", lines(poses, " "));
  ASSERT_EQ(shell("./program < poses.txt > joints.txt"), 0);
  const json expected = library_joints(poses);
  const std::string text = folder.read("joints.txt");
  const char* at = text.c_str();
  double worst = 0.0;
  for (const json& row : expected) {
    for (const json& joint : row) {
      char* end = nullptr;
      worst = std::max(worst, std::abs(std::strtod(at, &end) - joint.get<double>()));
      ASSERT_NE(at, end);
      at = end;
    }
  }
  RecordProperty("worst_deg", json(worst).dump());
  EXPECT_LT(worst, 1e-9);
}

/// In two files of one C++ program, the oldest standard that compilers know and the newest, before and after the
/// library's own declarations.
TEST_P(C99Export, LinksFromCpp) {
  folder.write("first.cpp",
               "#include \"compensator.h\"\n#include <cmath>\n"
               "int other(const double pose[6], double joints[4]);\n"
               "int main() {\n  const double pose[6] = {0.0, 0.0, -900.0, 0.0, 0.0, std::sqrt(0.04)};\n"
               "  double a[4] = {0.0}, b[4] = {1.0};\n"
               "  if (paracal_compensate(pose, a, NULL) != PARACAL_OK) return 1;\n"
               "  return other(pose, b) != 0 || a[3] < b[3] || a[3] > b[3] || paracal_self_test() != 0;\n}\n");
  folder.write("second.cpp",
               "#include <cmath>\n#include \"compensator.h\"\n"
               "int other(const double pose[6], double joints[4]);\n"
               "int other(const double pose[6], double joints[4]) {\n"
               "  return paracal_compensate(pose, joints, NULL);\n}\n");
  for (const char* standard : {"c++98", "c++20"}) {
    const std::string compile = fmt::format(
        "{} -x c++ -std={} -pedantic -Wall -Wextra -Wshadow -Wconversion -Wold-style-cast -Werror first.cpp second.cpp "
        "-lstdc++ -lm -o program",
        GetParam(), standard);
    ASSERT_EQ(shell(compile), 0) << standard;
    EXPECT_EQ(shell("./program"), 0);
  }
}

/// Three limbs, and errors of the position group alone: the header's other half.
TEST_P(C99Export, OfALevelRigidPlatePassesItsSelfTest) {
  // As text: a calibration's robot keeps the order of its keys.
  const std::string robot = folder.run("robot --robot rotary_delta --json").out;
  folder.write("delta.json", R"({"accepted": true, "parameters": [
    {"name": "e_z", "limb": 3, "value": 0.4, "unit": "mm"}], "robot": )" +
                                 robot + "}");
  const std::string command = "export --robot rotary_delta --calibration delta.json --target c99 --out compensator.h";
  ASSERT_EQ(folder.run(command).exit_code, kDone);
  folder.write("test.c", "#include \"compensator.h\"\nint main(void) { return paracal_self_test(); }\n");
  const std::string compile = std::string(GetParam()) + " -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror ";
  ASSERT_EQ(shell(compile + "test.c -lm -o test"), 0);
  EXPECT_EQ(shell("./test"), 0);
}

/// Carriages on rails, with and without tilt.
TEST_P(C99Export, OfARobotOnRailsPassesItsSelfTest) {
  const std::string robot = folder.run("robot --robot linear_delta --json").out;
  const std::string level = R"({"name": "beta0", "limb": 3, "value": 0.2, "unit": "deg"})";
  const std::string tilting = R"({"name": "rod_difference", "limb": 1, "value": 0.3, "unit": "mm"})";
  for (const std::string& errors : {level, fmt::format("{}, {}", level, tilting)}) {
    folder.write("delta.json", fmt::format(R"({{"accepted": true, "parameters": [{}], "robot": {}}})", errors, robot));
    const std::string command = "export --robot linear_delta --calibration delta.json --target c99 --out compensator.h";
    ASSERT_EQ(folder.run(command).exit_code, kDone);
    folder.write("test.c", "#include \"compensator.h\"\nint main(void) { return paracal_self_test(); }\n");
    const std::string compile = std::string(GetParam()) + " -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror ";
    ASSERT_EQ(shell(compile + "test.c -lm -o test"), 0);
    EXPECT_EQ(shell("./test"), 0);
  }
}

TEST_F(Export, TheHeaderSaysWhereItComesFrom) {
  const std::string header = folder.run("export --calibration calibration.json --target c99").out;
  for (const char* said :
       {"robot        huang2016", "calibration  calibration.json", "mm and rad", "SHA-256", "date"}) {
    EXPECT_THAT(header, HasSubstr(said));
  }
  EXPECT_EQ(header.find('$'), std::string::npos);
  const json exported = json_from("export --calibration calibration.json --target c99");
  EXPECT_THAT(header, HasSubstr(exported.at("calibration_sha256").get<std::string>()));
}

/// The header names the rules of MISRA C:2012 that it does not keep.
TEST_F(Export, TheHeaderKeepsToMisra) {
  if (*PARACAL_CPPCHECK == '\0') GTEST_SKIP() << "cppcheck is not installed";
  const std::string check = std::string(PARACAL_CPPCHECK) +
                            " --addon=misra --enable=style,warning,performance,portability --std=c99 --quiet "
                            "--error-exitcode=1 --suppress=misra-c2012-2.5 --suppress=misra-c2012-15.5 "
                            "--suppress=misra-c2012-21.2 ";
  folder.write("careless.c", "int f(int a);\nint f(int a) { if (a) { return 1; } return 2; }\n");
  EXPECT_NE(shell(check + "careless.c 2> careless.txt"), 0);
  EXPECT_THAT(folder.read("careless.txt"), HasSubstr("misra-c2012-14.4"));
  export_to("c99", "compensator.h");
  EXPECT_THAT(folder.read("compensator.h"), HasSubstr("except 2.5"));
  folder.write("kernel.c",
               "#include \"compensator.h\"\nint self_test(void);\n"
               "int self_test(void) { return paracal_self_test(); }\n");
  // Rules on the program as a whole do not count for its exit code.
  EXPECT_EQ(shell(check + "kernel.c 2> said.txt"), 0);
  EXPECT_EQ(folder.read("said.txt"), "");
}

// ---- Structured Text, whose laws are in tests/compensation

TEST_F(Export, StructuredTextSaysWhereItComesFrom) {
  const Surroundings fixed_date{.folder = folder.path(), .environment = {"SOURCE_DATE_EPOCH=0"}};
  const std::string command = "export --calibration calibration.json --target st";
  const json exported = json::parse(run_program(of_huang2016(command + " --json"), fixed_date).out);
  const std::string text = exported.at("text");
  EXPECT_EQ(text, run_program(of_huang2016(command), fixed_date).out);
  for (const char* said : {"robot        huang2016", "calibration  calibration.json", "joints in rad",
                           "FUNCTION_BLOCK paracal_compensator", "FUNCTION_BLOCK paracal_self_test"}) {
    EXPECT_THAT(text, HasSubstr(said));
  }
  EXPECT_THAT(text, HasSubstr(exported.at("calibration_sha256").get<std::string>()));
  EXPECT_EQ(text.find('$'), std::string::npos);
}

/// One computation: the same numbers to the last bit.
TEST_F(Export, InverseWithACalibrationIsCompensate) {
  const json compensated = library_joints(random_poses(200));
  EXPECT_EQ(json_from("inverse --errors calibration.json --poses poses.csv").at("joints_deg"), compensated);
}

/// A name cannot end the comment or the string that it stands in.
TEST_F(Export, AFilesNameStaysAName) {
  folder.write("*\" #error.json", kCalibration);
  const std::string header =
      folder.run(std::vector<std::string>{"export", "--target", "c99", "--calibration", "*\" #error.json"}).out;
  EXPECT_THAT(header, HasSubstr("calibration  __ #error.json"));
}

}  // namespace
}  // namespace paracal::test::export_test
