// From a calibration to the controller: corrected joints, corrected targets, and the exported C99 header built with
// real compilers.

#include <cmath>
#include <cstdlib>
#include <random>

#include "broken_input.hpp"
#include "json_checks.hpp"

namespace paracal::test {
namespace {

using nlohmann::json;
using testing::HasSubstr, testing::IsEmpty, testing::SizeIs, testing::StartsWith;

const std::string kPoses =
    "pose,x_mm,y_mm,z_mm,phi_deg\n"
    "home,0,0,-888,0\n"
    "right,400,0,-900,120\n"
    "low,-200,300,-1000,-90\n";

const std::string kErrors = R"([[limb]]
theta_offset_deg = 0.2
alpha2_deg = 0.01
[[limb]]
e_mm = [0.1, -0.2, 0.3]
rod_difference_mm = 0.03
[[limb]]
arm_length_mm = 0.15
[[limb]]
rod_mean_mm = -0.4
alpha03_deg = -0.01
)";

/// The same errors as an accepted calibration.
const std::string kCalibration = R"({"format": "paracal calibration 1",
"accepted": true,
"verdict": "accepted",
"robot": {"name": "huang2016",
  "geometry": {"base_radius_mm": 200, "plate_radius_mm": 75, "arm_mm": 375, "rod_mm": 950,
    "parallelogram_width_mm": 100, "limb_azimuth_deg": [-45, 45, 135, 225], "actuator": "revolute"},
  "plate": {"slide_axis": [0, -1, 0], "slide_sign": [1, 1, -1, -1], "pinion_radius_mm": 12}},
"parameters": [
  {"name": "theta_offset", "limb": 1, "value": 0.2, "unit": "deg"},
  {"name": "alpha2", "limb": 1, "value": 0.01, "unit": "deg"},
  {"name": "e_x", "limb": 2, "value": 0.1, "unit": "mm"},
  {"name": "e_y", "limb": 2, "value": -0.2, "unit": "mm"},
  {"name": "e_z", "limb": 2, "value": 0.3, "unit": "mm"},
  {"name": "rod_difference", "limb": 2, "value": 0.03, "unit": "mm"},
  {"name": "arm_length", "limb": 3, "value": 0.15, "unit": "mm"},
  {"name": "rod_mean", "limb": 4, "value": -0.4, "unit": "mm"},
  {"name": "alpha03", "limb": 4, "value": -0.01, "unit": "deg"}
]})";

const std::string kCompensate = "compensate --calibration calibration.json --poses poses.csv";

class CompensateCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("poses.csv", kPoses);
    folder.write("errors.toml", kErrors);
    folder.write("calibration.json", kCalibration);
  }

  json json_from(const std::string& command) const { return json_of(folder.run(command + " --json")); }

  /// Largest distance of the poses that the machine takes with these joints from those wanted, mm.
  double left_by(const std::string& options) const {
    EXPECT_EQ(folder.run(kCompensate + options + " --out joints.csv").exit_code, kDone);
    const json reached = json_from("forward --joints joints.csv --errors errors.toml").at("poses");
    const double wanted[3][3] = {{0, 0, -888}, {400, 0, -900}, {-200, 300, -1000}};
    double worst = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      worst = std::max(worst, std::hypot(reached[k].at("x_mm").get<double>() - wanted[k][0],
                                         reached[k].at("y_mm").get<double>() - wanted[k][1],
                                         reached[k].at("z_mm").get<double>() - wanted[k][2]));
    }
    return worst;
  }

  const TemporaryFolder folder;
};

void expect_near(const json& one, const json& other, double tolerance) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    for (std::size_t i = 0; i < one[k].size(); ++i) {
      EXPECT_NEAR(one[k][i].get<double>(), other[k][i].get<double>(), tolerance) << k << ", " << i;
    }
  }
}

TEST_F(CompensateCommand, Keys) {
  const json compensated = json_from(kCompensate);
  ASSERT_TRUE(has_keys(compensated, "names joints_deg targets remaining_tilt way"));
  EXPECT_TRUE(is_matrix(compensated["joints_deg"], 3, 4));
  ASSERT_THAT(compensated["targets"], SizeIs(3));
  for (const json& target : compensated["targets"]) EXPECT_TRUE(has_keys(target, "x_mm y_mm z_mm phi_deg"));
  for (const json& tilt : compensated["remaining_tilt"]) EXPECT_TRUE(has_keys(tilt, "tilt_x_rad tilt_y_rad"));
}

TEST_F(CompensateCommand, TheMachineComesToThePose) {
  EXPECT_GT(left_by(" --way linear"), 1e-3);
  EXPECT_LT(left_by(" --way tilt-aware"), 0.05);
  EXPECT_LT(left_by(""), 1e-6);
}

TEST_F(CompensateCommand, TheExactWayIsTheInverseOfTheMachine) {
  expect_near(json_from(kCompensate).at("joints_deg"),
              json_from("inverse --poses poses.csv --errors errors.toml").at("joints_deg"), 1e-9);
}

TEST_F(CompensateCommand, ErrorsInTomlDoTheSame) {
  EXPECT_EQ(json_from("compensate --errors errors.toml --poses poses.csv"), json_from(kCompensate));
}

/// What a closed controller does with the targets.
TEST_F(CompensateCommand, TheNominalInverseOfTheTargetsGivesTheJoints) {
  EXPECT_EQ(folder.run(kCompensate + " --targets --out targets.csv").exit_code, kDone);
  EXPECT_THAT(folder.read("targets.csv"), StartsWith("pose,x_mm,y_mm,z_mm,phi_deg\nhome,"));
  expect_near(json_from("inverse --poses targets.csv").at("joints_deg"), json_from(kCompensate).at("joints_deg"), 1e-9);
}

// ---- export

/// The C program around the header: reads poses (mm, rad) and prints joints in deg.
const std::string kKernel = R"(#include "compensator.h"
int self_test(void) { return paracal_self_test(); }
int joints_of(const double pose[4], double joints[4]) {
  return paracal_compensate(pose[0], pose[1], pose[2], pose[3], joints, 0);
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

class C99Export : public CompensateCommand, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    CompensateCommand::SetUp();
    if (*GetParam() == '\0') GTEST_SKIP() << "this compiler is not installed";
    ASSERT_EQ(folder.run("export --calibration calibration.json --target c99 --out compensator.h").exit_code, kDone);
    folder.write("kernel.c", kKernel);
    folder.write("main.c", kMain);
  }

  int shell(const std::string& command) const {
    return std::system(("cd '" + folder.path().string() + "' && " + command).c_str());  // NOLINT(*-env33-c)
  }
};

INSTANTIATE_TEST_SUITE_P(Compilers, C99Export, testing::Values(PARACAL_GCC, PARACAL_CLANG),
                         [](const auto& one) { return one.index == 0 ? "gcc" : "clang"; });

TEST_P(C99Export, GivesTheLibrarysJoints) {
  const std::string compile = std::string(GetParam()) + " -std=c99 -O2 -pedantic -Wall -Wextra -Werror ";
  ASSERT_EQ(shell(compile + "-ffreestanding -Wshadow -Wconversion -c kernel.c"), 0);
  ASSERT_EQ(shell(compile + "main.c kernel.o -lm -o program"), 0);
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> side(-350.0, 350.0), z(-1013.0, -763.0), phi(-180.0, 180.0);
  std::string table = "x_mm,y_mm,z_mm,phi_deg\n", plain;
  for (int k = 0; k < 10'000; ++k) {
    const std::string numbers = json{side(engine), side(engine), z(engine), phi(engine)}.dump();
    std::string line = numbers.substr(1, numbers.size() - 2) + "\n";
    table += line;
    for (char& c : line) c = c == ',' ? ' ' : c;
    plain += line;
  }
  folder.write("poses.csv", table);
  folder.write("poses.txt", plain);
  ASSERT_EQ(shell("./program < poses.txt > joints.txt"), 0);
  const json expected = json_from(kCompensate).at("joints_deg");
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

TEST_F(CompensateCommand, TheHeaderSaysWhereItComesFrom) {
  const std::string header = folder.run("export --calibration calibration.json --target c99").out;
  for (const char* said :
       {"robot        huang2016", "calibration  calibration.json", "mm and rad", "SHA-256", "date"}) {
    EXPECT_THAT(header, HasSubstr(said));
  }
  EXPECT_EQ(header.find('$'), std::string::npos);
  const json exported = json_from("export --calibration calibration.json --target c99");
  EXPECT_THAT(header, HasSubstr(exported.at("calibration_sha256").get<std::string>()));
}

/// A name cannot end the comment or the string that it stands in.
TEST_F(CompensateCommand, AFilesNameStaysAName) {
  folder.write("*\" #error.json", kCalibration);
  const std::string header =
      folder.run(std::vector<std::string>{"export", "--target", "c99", "--calibration", "*\" #error.json"}).out;
  EXPECT_THAT(header, HasSubstr("calibration  __ #error.json"));
}

// ---- broken input

BrokenInput broken(std::string name, const NamedText& file, std::string command, int exit_code,
                   std::vector<std::string> message) {
  std::vector<NamedText> files{{"calibration.json", kCalibration}, {"poses.csv", kPoses}, {"errors.toml", kErrors}};
  for (NamedText& one : files) {
    if (one.name == file.name) one.text = file.text;
  }
  return {std::move(name), std::move(files), std::move(command), exit_code, std::move(message)};
}

const std::string kExport = "export --calibration calibration.json --target c99";
const NamedText kNothing{};
const NamedText kRejected{"calibration.json",
                          replaced(replaced(kCalibration, "\"accepted\": true", "\"accepted\": false"),
                                   "\"verdict\": \"accepted\"", "\"verdict\": \"rejected\"")};
const NamedText kNotCalibration{"calibration.json", "{}"};

const std::vector<BrokenInput> kBroken{
    broken("rejected", kRejected, kCompensate, kBadInputFile, {"calibration.json", "accepted", "rejected"}),
    broken("rejected_export", kRejected, kExport, kBadInputFile, {"calibration.json", "accepted", "rejected"}),
    broken("no_calibration", kNotCalibration, kCompensate, kBadInputFile,
           {"calibration.json", "expected a calibration"}),
    broken("no_calibration_export", kNotCalibration, kExport, kBadInputFile, {"calibration.json"}),
    broken("other_robot", kNothing, kCompensate + " --robot rotary_delta", kBadInputFile, {"rotary_delta"}),
    broken("pose_text", {"poses.csv", replaced(kPoses, "400", "far")}, kCompensate, kBadInputFile,
           {"poses.csv:3: ", "x_mm", "far"}),
    broken("pose_nan", {"poses.csv", replaced(kPoses, "400", "nan")}, kCompensate, kBadInputFile, {"poses.csv:3: "}),
    broken("pose_short", {"poses.csv", replaced(kPoses, "400,", "")}, kCompensate, kBadInputFile, {"poses.csv:3: "}),
    broken("errors_key", {"errors.toml", replaced(kErrors, "alpha2_deg", "alpha_2")},
           "compensate --errors errors.toml --poses poses.csv", kBadInputFile, {"errors.toml:3: ", "alpha_2"}),
    broken("out_of_reach", {"poses.csv", replaced(kPoses, "400", "4000")}, kCompensate, kMathematicsSaysNo,
           {"pose right", "4000", "out of reach"}),
    broken("out_of_reach_linear", {"poses.csv", replaced(kPoses, "400", "4000")}, kCompensate + " --way linear",
           kMathematicsSaysNo, {"pose right", "4000", "out of reach"}),
    broken("no_errors", kNothing, "compensate --poses poses.csv", kWrongUsage, {"--calibration", "--errors"}),
    broken("two_errors", kNothing, kCompensate + " --errors errors.toml", kWrongUsage, {"--calibration", "--errors"}),
    broken("other_way", kNothing, kCompensate + " --way best", kWrongUsage, {"--way", "best"}),
    broken("other_target", kNothing, "export --calibration calibration.json --target c64", kWrongUsage,
           {"--target", "c64"}),
};

class BrokenCompensation : public BrokenInputTest {};

TEST_P(BrokenCompensation, IsRefused) {
  folder.write("result", "earlier\n");
  const ProgramResult result = run_with(" --out result");
  EXPECT_EQ(result.exit_code, GetParam().exit_code) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  for (const std::string& fragment : GetParam().message) EXPECT_THAT(result.err, HasSubstr(fragment));
  EXPECT_EQ(folder.read("result"), "earlier\n");
}

INSTANTIATE_TEST_SUITE_P(Compensation, BrokenCompensation, testing::ValuesIn(kBroken), name_of);

}  // namespace
}  // namespace paracal::test
