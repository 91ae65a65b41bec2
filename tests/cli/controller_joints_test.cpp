// Who computes the joints: a machine whose controller has rods 10 mm shorter than its robot file says.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "json_checks.hpp"
#include "run_program.hpp"

namespace paracal::test::controller_joints_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::Contains, testing::Each, testing::HasSubstr, testing::IsEmpty, testing::Not,
    testing::SizeIs, testing::StartsWith;

std::string robot_file(const std::string& rod) {
  return "name = \"packer\"\n[geometry]\nbase_radius_mm = 210\nplate_radius_mm = 55\narm_mm = 310\nrod_mm = " + rod +
         "\nparallelogram_width_mm = 80\nlimb_azimuth_deg = [0, 120, 240]\nactuator = \"revolute\"\n"
         "[workspace]\nradius_mm = 300\nheight_mm = 150\ntop_z_mm = -620\n";
}

const std::string kErrors =
    "[[limb]]\ntheta_offset_deg = 0.31\narm_length_mm = 0.12\n[[limb]]\ntheta_offset_deg = -0.22\nrod_mean_mm = -0.2\n"
    "[[limb]]\ntheta_offset_deg = 0.45\ne_mm = [0.1, 0, 0]\n";

const std::string kAssumed =
    "the controller computes joints with rod 730 mm, arm 310 mm, base radius 210 mm, plate radius 55 mm";
const std::string kOfFile = " --robot file.toml";
const std::string kCalibrate = "calibrate --measurements measured.csv" + kOfFile;
const std::string kSimulate =
    "simulate --robot machine.toml --errors errors.toml --noise-mm 0.01 --frame random --poses ";

/// The 16 poses of a plan, as the machine took them for its controller, and a calibration by the wrong file.
class WrongRod : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("file.toml", robot_file("730"));
    folder.write("machine.toml", robot_file("720"));
    folder.write("errors.toml", kErrors);
    make_without_robot("plan.csv", "poses --optimal 16 --candidates 300 --seed 3" + kOfFile);
    make_without_robot("measured.csv", kSimulate + "plan.csv --repeats 2 --seed 5");
    folder.make({kCalibrate + " --out calibration.json"});
    folder.write("poses.csv", "pose,x_mm,y_mm,z_mm\nhome,0,0,-695\nright,250,0,-650\nlow,-100,200,-740\n");
  }

  /// A table that does not name the robot file that made it: it is read with the other one.
  void make_without_robot(const std::string& name, const std::string& command) const {
    folder.make({command + " --out " + name});
    const std::string text = folder.read(name);
    ASSERT_TRUE(text.starts_with("# robot: "));
    folder.write(name, text.substr(text.find('\n') + 1));
  }

  json json_from(const std::string& command) const { return json_of(folder.run(command + " --json")); }
  std::string text_of(const std::string& command) const {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kDone) << command << result.err;
    return result.out;
  }

  /// Joints of poses as a controller with these rods displays them, to four decimals.
  void display(const std::string& robot, const std::string& poses, const std::string& table) const {
    folder.write("asked.csv", poses);
    const json joints = json_from("inverse --poses asked.csv --robot " + robot).at("joints_deg");
    std::string text;
    std::size_t row = 0;
    for (std::size_t at = 0; at < poses.size(); ++row) {
      const std::size_t end = poses.find('\n', at);
      text += poses.substr(at, end - at);
      for (int k = 0; k < 3; ++k) {
        text += row == 0 ? ",q" + std::to_string(k + 1) + "_deg"
                         : fmt::format(",{:.4f}", joints[row - 1][static_cast<std::size_t>(k)].get<double>());
      }
      text += '\n';
      at = end + 1;
    }
    folder.write(table, text);
  }

  /// Largest error of the distances to the first pose that the machine takes with a table of joints, mm.
  double off_by(const std::string& joints) const {
    const json reached = json_from("forward --robot machine.toml --errors errors.toml --joints " + joints).at("poses");
    const double wanted[3][3] = {{0, 0, -695}, {250, 0, -650}, {-100, 200, -740}};
    const auto coordinate = [&](std::size_t k, std::size_t i) {
      const char* keys[] = {"x_mm", "y_mm", "z_mm"};
      return reached[k].at(keys[i]).get<double>();
    };
    double worst = 0.0;
    for (const std::size_t k : {1u, 2u}) {
      double is = 0.0, meant = 0.0;
      for (std::size_t i = 0; i < 3; ++i) {
        is += std::pow(coordinate(k, i) - coordinate(0, i), 2);
        meant += std::pow(wanted[k][i] - wanted[0][i], 2);
      }
      worst = std::max(worst, std::abs(std::sqrt(is) - std::sqrt(meant)));
    }
    return worst;
  }

  const TemporaryFolder folder;
};

const std::string kHome = "pose,x_mm,y_mm,z_mm\nhome,0,0,-695\n", kRim = "rim,300,0,-695\n",
                  kAside = "aside,210,130,-720\n";
const std::string kCompensate = "compensate --calibration calibration.json --poses poses.csv" + kOfFile;
const std::string kExport = "export --calibration calibration.json" + kOfFile + " --target ";

TEST_F(WrongRod, IsAssumedInEveryResultThatDependsOnIt) {
  make_without_robot("check.csv", kSimulate + "plan.csv --seed 7");
  for (const std::string& command :
       {kCalibrate, "validate --calibration calibration.json --measurements check.csv --limit-mm 1" + kOfFile}) {
    EXPECT_THAT(text_of(command), HasSubstr("\n  assumed: " + kAssumed)) << command;
    EXPECT_THAT(json_from(command).at("assumed"), Contains(StartsWith(kAssumed))) << command;
  }
  for (const std::string target : {"c99", "linuxcnc", "st"}) {
    EXPECT_THAT(text_of(kExport + target), AllOf(HasSubstr(kAssumed), HasSubstr("nominal joints at rim along y")));
    EXPECT_THAT(json_from(kExport + target).at("assumed"), Contains(StartsWith(kAssumed))) << target;
  }
  for (const std::string& command : {kCompensate, kExport + "json"}) {
    const json result = json_from(command);
    EXPECT_THAT(result.at("assumed"), Contains(StartsWith(kAssumed))) << command;
    ASSERT_THAT(result.at("nominal_joints"), SizeIs(3)) << command;
    EXPECT_EQ(result["nominal_joints"][0]["joints_deg"],
              json_from("inverse --poses poses.csv" + kOfFile)["joints_deg"][0]);
  }
  EXPECT_THAT(text_of(kCompensate),
              AllOf(HasSubstr("\n# assumed: " + kAssumed), HasSubstr("\n# nominal joints at home, (0, 0, -695) mm: ")));
  EXPECT_THAT(text_of(kCompensate + " --targets"), Not(HasSubstr("controller computes")));
  EXPECT_THAT(text_of(kExport + "csv --input poses.csv --header"), Not(HasSubstr("controller computes")));
}

/// Joints go wrong where targets do not.
TEST_F(WrongRod, SpoilsJointsAndNoTargets) {
  EXPECT_EQ(folder.run(kCompensate + " --out joints.csv").exit_code, kDone);
  EXPECT_EQ(folder.run(kCompensate + " --targets --out targets.csv").exit_code, kDone);
  EXPECT_EQ(folder.run("inverse --robot machine.toml --poses targets.csv --out by_targets.csv").exit_code, kDone);
  EXPECT_LT(off_by("by_targets.csv"), 0.05);
  EXPECT_GT(off_by("joints.csv"), 1.0);
}

TEST_F(WrongRod, IsNamedByJointsAtHomeAndOnTheRim) {
  display("machine.toml", kHome + kRim, "displayed.csv");
  for (const std::string& command : {kCalibrate, kCompensate, kExport + "c99"}) {
    const ProgramResult refused = folder.run(command + " --controller-joints displayed.csv");
    EXPECT_EQ(refused.exit_code, kBadInputFile) << command;
    EXPECT_THAT(refused.err, AllOf(HasSubstr("displayed.csv:2: expected q"),
                                   HasSubstr("This explains the difference: rod 720.00 mm instead of 730 mm.")));
  }
}

TEST_F(WrongRod, IsNotDecidedByJointsAtHome) {
  display("machine.toml", kHome, "displayed.csv");
  const ProgramResult refused = folder.run(kCompensate + " --controller-joints displayed.csv");
  EXPECT_EQ(refused.exit_code, kBadInputFile);
  for (const char* one : {"rod 720.00 mm", "arm ", "base radius ", "plate radius ", "origin at z ",
                          "cannot decide: add the joints at another pose, such as ("}) {
    EXPECT_THAT(refused.err, HasSubstr(one));
  }
}

TEST_F(WrongRod, IsConfirmedByJointsThatAgree) {
  display("file.toml", kHome + kAside, "displayed.csv");
  const std::string confirmed = "confirmed by 2 poses of displayed.csv: " + kAssumed;
  EXPECT_THAT(json_from(kCompensate + " --controller-joints displayed.csv").at("assumed"),
              testing::ElementsAre(confirmed));
  EXPECT_EQ(folder.run(kCalibrate + " --controller-joints displayed.csv --out known.json").exit_code, kDone);
  EXPECT_EQ(json::parse(folder.read("known.json")).at("controller").at("joints"), "confirmed");
  EXPECT_THAT(text_of("compensate --calibration known.json --poses poses.csv" + kOfFile),
              HasSubstr("\n# assumed: " + confirmed));
}

/// Both poses are symmetric in limbs 2 and 3.
TEST_F(WrongRod, IsNotConfirmedWhereSwappedLimbsAgree) {
  display("file.toml", kHome + kRim, "displayed.csv");
  const json compensated = json_from(kCompensate + " --controller-joints displayed.csv");
  EXPECT_THAT(compensated.at("assumed"),
              testing::ElementsAre(AllOf(StartsWith(kAssumed),
                                         HasSubstr("the joints at 2 poses of displayed.csv agree, but would also agree "
                                                   "with another value of: the order of limbs 2 and 3, "),
                                         HasSubstr(". Add the joints at ("))));
  EXPECT_EQ(folder.run(kCalibrate + " --controller-joints displayed.csv --out known.json").exit_code, kDone);
  EXPECT_EQ(json::parse(folder.read("known.json")).at("controller").at("joints"), "assumed");
}

/// A calibration that was not accepted may be so because of its controller.
TEST_F(WrongRod, IsNamedBesideARejectedCalibration) {
  json rejected = json::parse(folder.read("calibration.json"));
  rejected["accepted"] = false;
  rejected["verdict"] = "rejected";
  folder.write("calibration.json", rejected.dump());
  display("machine.toml", kHome + kRim, "displayed.csv");
  for (const std::string& command : {kCompensate, kExport + "c99"}) {
    EXPECT_THAT(folder.run(command + " --controller-joints displayed.csv").err, HasSubstr("rod 720.00 mm instead"));
    EXPECT_THAT(folder.run(command).err, HasSubstr("expected an accepted calibration"));
  }
}

TEST_F(WrongRod, NeedsATableThatStatesJoints) {
  const ProgramResult refused = folder.run(kCompensate + " --controller-joints poses.csv");
  EXPECT_EQ(refused.exit_code, kBadInputFile);
  EXPECT_THAT(refused.err, HasSubstr("poses.csv: expected columns q1_deg"));
}

/// One row of the readings, off the axis, is enough to confirm them, and its visits need not all state it.
TEST_F(WrongRod, IsFoundInARowOfTheReadings) {
  for (const auto& [robot, agrees] : {std::pair("file.toml", true), {"machine.toml", false}}) {
    std::string text = folder.read("measured.csv");
    const std::size_t header = text.find("pose,"), first = text.rfind('\n', text.size() - 2) + 1;
    const std::string before = text.substr(header, first - header);
    const auto line = 1 + std::ranges::count(before, '\n');
    const std::string row = text.substr(first, text.find('\n', first) - first);
    const std::size_t name = row.find(',') + 1;
    const std::size_t end = row.find(',', row.find(',', row.find(',', name) + 1) + 1);
    display(robot, "x_mm,y_mm,z_mm\n" + row.substr(name, end - name) + "\n", "one.csv");
    const std::string one = folder.read("one.csv");
    std::string joints = one.substr(one.find('\n') + 1);  // x,y,z,q1,q2,q3
    for (int k = 0; k < 3; ++k) joints = joints.substr(joints.find(',') + 1);
    joints.pop_back();
    std::string with;
    for (std::size_t at = header; at < text.size();) {
      const std::size_t line_end = text.find('\n', at);
      with += text.substr(at, line_end - at) + (at == header  ? ",q1_deg,q2_deg,q3_deg\n"
                                                : at == first ? "," + joints + "\n"
                                                              : ",,,\n");
      at = line_end + 1;
    }
    folder.write("stated.csv", with);
    const ProgramResult result = folder.run("calibrate --measurements stated.csv --json" + kOfFile);
    if (!agrees) {
      EXPECT_EQ(result.exit_code, kBadInputFile);
      EXPECT_THAT(result.err, AllOf(HasSubstr(fmt::format("stated.csv:{}: expected q", line)),
                                    HasSubstr("rod 720.00 mm instead of 730 mm")));
      continue;
    }
    const json calibration = json_of(result);
    EXPECT_EQ(calibration.at("controller").at("joints"), "readings");
    EXPECT_THAT(calibration.at("assumed"), Each(Not(HasSubstr("the controller computes"))));
  }
}

/// The drawing is right, the controller computes with other rods, and says so.
class OtherController : public WrongRod {
 protected:
  void SetUp() override {
    WrongRod::SetUp();
    folder.run("inverse --robot file.toml --poses plan.csv --out joints.csv");
    const std::string plan = folder.read("plan.csv"), joints = folder.read("joints.csv");
    folder.write("commanded.csv", beside(plan.substr(plan.find("pose,")), joints));
    folder.make({kSimulate + "commanded.csv --repeats 2 --seed 6 --out taken.csv"});
    folder.write("alone.csv", without_joints(folder.read("taken.csv")));
  }

  /// Rows of a table with what the rows of another hold behind their names.
  static std::string beside(const std::string& table, const std::string& other) {
    std::istringstream left(table), right(other);
    std::string text;
    for (std::string one, two; std::getline(left, one) && std::getline(right, two);) {
      text += one + two.substr(two.find(',')) + "\n";
    }
    return text;
  }

  /// The joints stand in the last three columns.
  static std::string without_joints(const std::string& table) {
    std::istringstream rows(table);
    std::string text;
    for (std::string row; std::getline(rows, row);) {
      for (int k = 0; k < 3 && !row.starts_with('#'); ++k) row.erase(row.rfind(','));
      text += row + "\n";
    }
    return text;
  }

  const std::string kTaken = "calibrate --robot machine.toml --measurements taken.csv";
  const std::string kAlone = "calibrate --robot machine.toml --measurements alone.csv";
};

TEST_F(OtherController, IsKeptAndUsed) {
  EXPECT_EQ(folder.run(kAlone + " --controller file.toml --out told.json").exit_code, kDone);
  const json calibration = json::parse(folder.read("told.json"));
  EXPECT_EQ(calibration.at("controller").at("joints"), "stated");
  EXPECT_EQ(calibration.at("controller").at("robot").at("geometry").at("rod_mm"), 730);
  EXPECT_EQ(calibration.at("robot").at("geometry").at("rod_mm"), 720);
  EXPECT_THAT(calibration.at("assumed"), Contains(StartsWith("stated by file.toml: the controller computes")));
  // The same as from the joints themselves, which the readings hold.
  const json by_joints = json_from(kTaken);
  EXPECT_EQ(by_joints.at("controller").at("joints"), "readings");
  EXPECT_THAT(by_joints.at("notes"),
              Contains(HasSubstr("corrected targets are not: state the dimensions of the controller")));
  EXPECT_THAT(json_from(kTaken + " --controller file.toml").at("notes"), Each(Not(HasSubstr("corrected targets"))));
  for (std::size_t k = 0; k < 24; ++k) {
    EXPECT_NEAR(calibration["parameters"][k]["value"].get<double>(), by_joints["parameters"][k]["value"].get<double>(),
                1e-6);
  }

  const std::string known = " --robot machine.toml --calibration told.json ";
  EXPECT_EQ(folder.run("compensate --poses poses.csv --out q.csv" + known).exit_code, kDone);
  EXPECT_LT(off_by("q.csv"), 0.05);
  // The controller's own inverse of the targets gives these joints.
  EXPECT_EQ(folder.run("compensate --targets --poses poses.csv --out targets.csv" + known).exit_code, kDone);
  EXPECT_EQ(folder.run("export --target csv --input poses.csv --out filtered.csv" + known).exit_code, kDone);
  const json wanted = json_from("compensate --poses poses.csv" + known).at("joints_deg");
  for (const std::string targets : {"targets.csv", "filtered.csv"}) {
    const json joints = json_from("inverse --robot file.toml --poses " + targets).at("joints_deg");
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(joints[k][i].get<double>(), wanted[k][i].get<double>(), 1e-4) << targets;  // half of 0.1 um
      }
    }
  }
  const json validation = json_of(folder.run("validate --json --measurements alone.csv" + known));
  EXPECT_LT(validation.at("after").at("max_volumetric_aligned_mm").get<double>(), 0.1);
}

TEST_F(OtherController, IsCheckedByItsJoints) {
  display("file.toml", kHome + kRim, "displayed.csv");
  const std::string stated = kAlone + " --controller-joints displayed.csv";
  EXPECT_EQ(folder.run(stated).exit_code, kBadInputFile);
  EXPECT_EQ(folder.run(stated + " --controller file.toml").exit_code, kDone);
}

TEST_F(OtherController, IsARobotOfTheSameKind) {
  const ProgramResult refused = folder.run(kTaken + " --controller four.toml");
  EXPECT_EQ(refused.exit_code, kBadInputFile);
  folder.write("four.toml", folder.run(std::vector<std::string>{"robot", "--robot", "huang2016"}).out);
  EXPECT_THAT(folder.run(kTaken + " --controller four.toml").err,
              HasSubstr("four.toml: expected a controller of packer"));
}

TEST_F(WrongRod, IsAskedForByPlans) {
  EXPECT_THAT(folder.read("plan.csv"), HasSubstr("q1_deg"));
  EXPECT_THAT(text_of("poses --robot huang2016 --stage rough"),
              HasSubstr("\n# Read the joints that the controller displays"));
}

}  // namespace
}  // namespace paracal::test::controller_joints_test
