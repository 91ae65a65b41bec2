// export --target linuxcnc --config: a folder whole or not at all, and what its files say of the machine.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>
#include <regex>
#include <sstream>

#include "exported.hpp"
#include "support/places.hpp"

namespace paracal::test::linuxcnc_configuration_test {
namespace {

using nlohmann::json;
using testing::ElementsAreArray, testing::HasSubstr, testing::IsEmpty, testing::Not;

std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files[entry.path().filename()] = read_text(entry.path());
  }
  return files;
}

class LinuxcncConfiguration : public Export {
 protected:
  ProgramResult run(const std::string& command, std::vector<std::string> environment = {}) const {
    environment.emplace_back("SOURCE_DATE_EPOCH=0");
    return run_program(words(command), {.folder = folder.path(), .environment = std::move(environment)});
  }
  std::filesystem::path machine() const { return folder.path() / "machine"; }
};

TEST_F(LinuxcncConfiguration, SaysWhatItWrote) {
  const ProgramResult result = run(kConfigure);
  ASSERT_EQ(result.exit_code, kDone) << result.err;
  const auto made = files_of(machine());
  EXPECT_THAT(result.out,
              testing::StartsWith(fmt::format(
                  "{} files are in machine; README.md there states what to change.\nTo start: cd machine && "
                  "sudo halcompile --install paracal_kins.comp && linuxcnc paracal.ini\n  assumed: the controller ",
                  made.size())));
  EXPECT_THAT(result.out, HasSubstr("\n  nominal joints at rim along y, "));
  EXPECT_EQ(made.at("paracal_kins.comp"), run("export --calibration calibration.json --target linuxcnc").out);
  EXPECT_THAT(made.at("paracal.ini"), HasSubstr("KINEMATICS = paracal_kins\n"));
  for (const auto& [name, text] : made) {
    EXPECT_THAT(text, Not(HasSubstr("$"))) << name;
    if (name == "README.md") continue;  // which names the others
    EXPECT_THAT(made.at("README.md"), HasSubstr(fmt::format("`{}`", name)));
  }
}

TEST_F(LinuxcncConfiguration, PrintsJson) {
  std::filesystem::create_directory(folder.path() / "my machine");
  const json object = json_of(run_program(
      {"export", "--calibration", "calibration.json", "--target", "linuxcnc", "--config", "my machine", "--json"},
      {.folder = folder.path()}));
  EXPECT_TRUE(has_keys(object, "target program robot calibration calibration_sha256 date folder files"));
  EXPECT_EQ(object.at("folder"), "my machine");
  std::vector<std::string> names;
  for (const auto& [name, text] : files_of(folder.path() / "my machine")) names.push_back(name);
  EXPECT_THAT(object.at("files"), ElementsAreArray(names));
}

TEST_F(LinuxcncConfiguration, RefusesOtherFoldersTargetsAndFiles) {
  const auto refused = [&](const std::vector<std::string>& options, const std::string& message) {
    std::vector<std::string> arguments = words("export --calibration calibration.json");
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto before = folder.names();
    const ProgramResult result = run_program(arguments, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, kWrongUsage) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_EQ(folder.names(), before);
  };
  std::filesystem::create_directory(machine());
  folder.write("machine/paracal.ini", "mine");
  refused({"--target", "linuxcnc", "--config", "machine"},
          "--config: expected an empty or a new folder, got machine with paracal.ini; name another folder");
  refused({"--target", "linuxcnc", "--config", "poses.csv"}, "--config: expected a folder, got a file: poses.csv");
  refused({"--target", "linuxcnc", "--config", "one/two"}, "expected an existing parent folder, got none: ");
  refused({"--target", "linuxcnc", "--config", ""}, "--config: expected a folder, got \"\"");
  refused({"--target", "c99", "--config", "new"}, "--config: expected with --target linuxcnc, got --target c99");
  refused({"--target", "linuxcnc", "--config", "new", "--out", "a.comp"},
          "--config: expected no --out, because the folder also contains the component, got a.comp");
  refused({"--target", "linuxcnc", "--config", "new", "--header"}, "expected only with --target gcode or csv");
  EXPECT_EQ(folder.read("machine/paracal.ini"), "mine");
}

#ifndef PARACAL_SANITIZED
/// Faults are numbers of errors, or of signals with a minus, at a call.
TEST_F(LinuxcncConfiguration, WritesAllFilesOrNoFolder) {
  ASSERT_EQ(run(kConfigure).exit_code, kDone);
  const auto expected = files_of(machine());
  int refused = 0, ended = 0;
  for (const char* fault : {"mkdir 1 28", "rename 2 28", "rename 8 28", "write 3 28", "open 5 13", "mkdir 1 -15",
                            "open 4 -15", "write 2 -2", "rename 7 -15"}) {
    remove_all(machine());
    const ProgramResult result = run(kConfigure, {preloaded_faults(), std::string("PARACAL_FAULT=") + fault});
    refused += result.exit_code == kWrongUsage;
    ended += result.exit_code < 0;
    if (exists(machine())) {
      EXPECT_EQ(files_of(machine()), expected) << fault;
    } else {
      EXPECT_NE(result.exit_code, kDone) << fault;
    }
  }
  EXPECT_GE(refused, 3);
  EXPECT_GE(ended, 3);
}
#endif

// ---- What the files say, of each robot of the catalogue

class ConfigurationOfRobot : public LinuxcncConfiguration, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    LinuxcncConfiguration::SetUp();
    calibrate(GetParam());
    robot = json_from(fmt::format("robot --robot {}", GetParam()));
    ASSERT_EQ(run(kConfigure).exit_code, kDone);
    std::istringstream ini(folder.read("machine/paracal.ini"));
    std::string section;
    const std::regex entry("([A-Z_]+) = (.*)");
    for (std::string line; std::getline(ini, line);) {
      std::smatch found;
      if (line.starts_with("[")) section = line;
      if (std::regex_match(line, found, entry)) values[section + found.str(1)] = found.str(2);
    }
  }

  double number(const std::string& key) const { return std::stod(values.at(key)); }
  /// Without the ends of its lines.
  std::string readme() const { return std::regex_replace(folder.read("machine/README.md"), std::regex("\\s+"), " "); }
  double workspace(const char* key) const { return robot.at("workspace").at(key); }
  bool on_rails() const { return robot.at("geometry").at("actuator") == "linear"; }
  bool turns() const { return robot.contains("plate"); }
  std::size_t joint_count() const { return robot.at("geometry").at("limb_azimuth_deg").size(); }

  /// On both ends of the workspace, in circles to the rim, at rotations from end to end.
  std::vector<PoseNumbers> ends() const {
    std::vector<PoseNumbers> poses;
    const double top = workspace("top_z_mm"), floor = top - workspace("height_mm");
    for (int circle = 0; circle <= 40; ++circle) {
      const double radius = workspace("radius_mm") * circle / 40;
      for (int k = 0; k < 72; ++k) {
        const double azimuth = 2.0 * std::numbers::pi * k / 72;
        for (const double phi : {-180.0, -80.0, 0.0, 80.0, 180.0}) {
          for (const double z : {top, floor}) {
            poses.push_back({radius * std::cos(azimuth), radius * std::sin(azimuth), z, turns() ? phi : 0.0});
          }
        }
      }
    }
    return poses;
  }

  json robot;
  std::map<std::string, std::string> values;  ///< of the INI file, by [SECTION]KEY
};

INSTANTIATE_TEST_SUITE_P(Catalogue, ConfigurationOfRobot, testing::Values("huang2016", "rotary_delta", "linear_delta"),
                         [](const auto& one) { return std::string(one.param); });

/// At the top speed of the axes no joint goes faster than its own limit: by the program's inverse kinematics at both
/// ends of a hundredth of a second, anywhere in the workspace, in any direction; not far below where that is what
/// decides. The identified machine is another than the nominal one by less than a hundredth.
TEST_P(ConfigurationOfRobot, NoJointExceedsItsSpeed) {
  constexpr double kSeconds = 1e-3;
  std::mt19937 engine(5);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(engine); };
  const double linear = number("[TRAJ]MAX_LINEAR_VELOCITY"),
               turning = turns() ? number("[TRAJ]MAX_ANGULAR_VELOCITY") : 0.0;
  EXPECT_EQ(number("[AXIS_X]MAX_VELOCITY"), linear);
  EXPECT_LE(number("[TRAJ]DEFAULT_LINEAR_VELOCITY"), linear);
  std::string poses = "x_mm,y_mm,z_mm,phi_deg\n";
  for (int k = 0; k < 4000; ++k) {
    const double azimuth = uniform(-3.2, 3.2), radius = 0.999 * workspace("radius_mm") * std::sqrt(uniform(0.5, 1.0));
    const double top = workspace("top_z_mm"), z = uniform(0, 1) < 0.5 ? top : top - workspace("height_mm");
    const Eigen::Vector3d from(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    const Eigen::Vector3d way =
        Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized() * linear * kSeconds;
    const double phi = turns() ? uniform(-170, 170) : 0.0, turned = phi + (k % 2 == 0 ? 1 : -1) * turning * kSeconds;
    fmt::format_to(std::back_inserter(poses), "{},{},{},{}\n{},{},{},{}\n", from.x(), from.y(), from.z(), phi,
                   from.x() + way.x(), from.y() + way.y(), from.z() + way.z(), turned);
  }
  folder.write("poses.csv", poses);
  const json joints = json_from(fmt::format("inverse --robot {} --poses poses.csv", GetParam()));
  const json& rows = joints.at(on_rails() ? "joints_mm" : "joints_deg");
  double fastest = 0.0;
  for (std::size_t k = 0; k < rows.size(); k += 2) {
    for (std::size_t i = 0; i < joint_count(); ++i) {
      fastest = std::max(fastest, std::abs(rows[k + 1][i].get<double>() - rows[k][i].get<double>()) / kSeconds);
    }
  }
  EXPECT_LE(fastest, 1.02 * number("[JOINT_0]MAX_VELOCITY"));
  if (linear < 500.0) {
    EXPECT_GT(fastest, 0.75 * number("[JOINT_0]MAX_VELOCITY"));
  }
}

TEST_P(ConfigurationOfRobot, LimitsOfJointsAreTheWorkspaceAndAMargin) {
  const json joints = library_joints(ends(), GetParam());
  const double margin = on_rails() ? 5.0 : 1.0;
  for (std::size_t i = 0; i < joint_count(); ++i) {
    double lowest = 1e9, highest = -1e9;
    for (const json& row : joints) {
      lowest = std::min(lowest, row[i].get<double>());
      highest = std::max(highest, row[i].get<double>());
    }
    EXPECT_NEAR(number(fmt::format("[JOINT_{}]MIN_LIMIT", i)), lowest - margin, 0.05 * margin);
    EXPECT_NEAR(number(fmt::format("[JOINT_{}]MAX_LIMIT", i)), highest + margin, 0.05 * margin);
    EXPECT_EQ(values.at(fmt::format("[JOINT_{}]TYPE", i)), on_rails() ? "LINEAR" : "ANGULAR");
  }
  const std::string said = fmt::format("plus {:g} {} on each side", margin, on_rails() ? "mm" : "deg");
  EXPECT_THAT(folder.read("machine/paracal.ini"), HasSubstr(said));
  EXPECT_THAT(readme(), HasSubstr(said));
}

TEST_P(ConfigurationOfRobot, HomeIsTheCentreOfTheWorkspace) {
  const double z = workspace("top_z_mm") - 0.5 * workspace("height_mm");
  const json joints = library_joints({{0.0, 0.0, z, 0.0}}, GetParam()).at(0);
  EXPECT_EQ(values.at("[KINS]JOINTS"), std::to_string(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    EXPECT_NEAR(number(fmt::format("[JOINT_{}]HOME", i)), joints[i].get<double>(), 1e-12);
    EXPECT_EQ(values.at(fmt::format("[JOINT_{}]HOME_OFFSET", i)), values.at(fmt::format("[JOINT_{}]HOME", i)));
  }
  EXPECT_THAT(readme(), HasSubstr(fmt::format("at the centre of the workspace, Z {:g}. ", z)));
}

TEST_P(ConfigurationOfRobot, CoordinatesAreThoseOfThePlate) {
  EXPECT_EQ(values.at("[TRAJ]COORDINATES"), turns() ? "XYZC" : "XYZ");
  const double radius = workspace("radius_mm"), top = workspace("top_z_mm"), floor = top - workspace("height_mm");
  for (const char* axis : {"[AXIS_X]", "[AXIS_Y]"}) {
    EXPECT_EQ(number(std::string(axis) + "MIN_LIMIT"), -radius);
    EXPECT_EQ(number(std::string(axis) + "MAX_LIMIT"), radius);
  }
  EXPECT_EQ(number("[AXIS_Z]MIN_LIMIT"), floor);
  EXPECT_EQ(number("[AXIS_Z]MAX_LIMIT"), top);
  ASSERT_EQ(values.contains("[AXIS_C]MIN_LIMIT"), turns());
  if (turns()) {
    EXPECT_EQ(number("[AXIS_C]MIN_LIMIT"), -180.0);
    EXPECT_EQ(number("[AXIS_C]MAX_LIMIT"), 180.0);
  }
  EXPECT_THAT(readme(), HasSubstr(fmt::format("its Z 0 is Z {:g} of G54", floor)));
  const std::string unit = on_rails() ? "mm of the carriage" : "deg of the arm";
  EXPECT_THAT(readme(), HasSubstr("counts per " + unit));
}

}  // namespace
}  // namespace paracal::test::linuxcnc_configuration_test
