// From a calibration to the controller: corrected joints, corrected targets; broken input of compensate and export.

#include <cmath>

#include "broken_input.hpp"
#include "calibrated_machine.hpp"

namespace paracal::test::compensation_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::HasSubstr, testing::SizeIs, testing::StartsWith;

class CompensateCommand : public CalibratedMachine {
 protected:
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
  ASSERT_TRUE(has_keys(compensated, "names joints_deg targets remaining_tilt uncertainty way"));
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
  json by_errors = json_from("compensate --errors errors.toml --poses poses.csv"),
       by_calibration = json_from(kCompensate);
  EXPECT_EQ(by_errors["assumed"], json::array());  // these are of the machine, whatever a controller computes
  by_calibration.erase("assumed");
  by_errors.erase("assumed");
  EXPECT_EQ(by_errors, by_calibration);
}

TEST_F(CompensateCommand, SaysThatUncertaintyIsNotKnown) {
  EXPECT_THAT(folder.run(kCompensate).out, AllOf(StartsWith("# U of these poses is unknown, because the errors have no "
                                                            "covariance: use --calibration\n# assumed: the "),
                                                 HasSubstr(" deg\npose,q1_deg,")));
  const json compensated = json_from(kCompensate);
  for (const json& one : compensated.at("uncertainty")) EXPECT_TRUE(one.is_null());
}

/// What a closed controller does with the targets.
TEST_F(CompensateCommand, TheNominalInverseOfTheTargetsGivesTheJoints) {
  EXPECT_EQ(folder.run(kCompensate + " --targets --out targets.csv").exit_code, kDone);
  EXPECT_THAT(folder.read("targets.csv"), StartsWith("# U of these poses"));
  EXPECT_THAT(folder.read("targets.csv"), HasSubstr("\npose,x_mm,y_mm,z_mm,phi_deg\nhome,"));
  expect_near(json_from("inverse --poses targets.csv").at("joints_deg"), json_from(kCompensate).at("joints_deg"), 1e-9);
}

/// Where the calibration knows it, each target has its U beside it, as in JSON; the table is still one of poses.
TEST_F(CompensateCommand, TargetsHaveTheirU) {
  EXPECT_EQ(folder.run("poses --out plan.csv").exit_code, kDone);
  EXPECT_EQ(folder.run("simulate --poses plan.csv --machine 3 --noise-mm 0.02 --out read.csv").exit_code, kDone);
  EXPECT_EQ(folder.run("calibrate --measurements read.csv --out fitted.json").exit_code, kDone);
  const std::string compensate = "compensate --calibration fitted.json --poses poses.csv";
  EXPECT_EQ(folder.run(compensate + " --targets --out targets.csv").exit_code, kDone);
  const std::string table = folder.read("targets.csv");
  const std::size_t header = table.find("\npose,x_mm,y_mm,z_mm,phi_deg,U_x_mm,U_y_mm,U_z_mm,U_phi_deg\nhome,");
  ASSERT_NE(header, std::string::npos) << table;
  std::array<double, 8> numbers{};
  ASSERT_EQ(
      std::sscanf(table.c_str() + table.find("home,", header), "home,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &numbers[0],
                  &numbers[1], &numbers[2], &numbers[3], &numbers[4], &numbers[5], &numbers[6], &numbers[7]),
      8);
  const json stated = json_from(compensate).at("uncertainty").at(0);
  constexpr double kThreeDigits = 6e-3;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(numbers[4 + axis] / stated.at("U_mm").at(axis).get<double>(), 1.0, kThreeDigits);
  }
  EXPECT_NEAR(numbers[7] / stated.at("U_deg").get<double>(), 1.0, kThreeDigits);
  EXPECT_EQ(folder.run("inverse --poses targets.csv").exit_code, kDone);
}

// ---- broken input

BrokenInput broken(std::string name, const NamedText& file, std::string command, int exit_code,
                   std::vector<std::string> message) {
  return {std::move(name),
          with({{"calibration.json", kCalibration}, {"poses.csv", kPoses}, {"errors.toml", kErrors}}, file),
          std::move(command), exit_code, std::move(message)};
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

INSTANTIATE_TEST_SUITE_P(Compensation, BrokenInputTest, testing::ValuesIn(kBroken), name_of);

}  // namespace
}  // namespace paracal::test::compensation_test
