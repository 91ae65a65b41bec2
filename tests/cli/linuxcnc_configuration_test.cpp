// export --target linuxcnc --config: a folder whole or not at all, and what its files say of the machine.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <regex>
#include <sstream>

#include "linuxcnc_export.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

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
  refused({"--target", "linuxcnc", "--config", ""},
          "--config: expected a value, got \"\"; state one, or omit the option");
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

// ---- What the files say, of each robot of the catalogue and of each template with one rod a limb

constexpr std::string_view kLetters = "XYZABC";

/// x, y, z and the angles, mm and deg.
using Coordinates = std::array<double, 6>;

bool moves(const Robot& robot, std::size_t axis) {
  return robot.freedoms().free.at(axis) || (axis == 5 && robot.slide());
}

Coordinates coordinates_of(const Robot& robot, const Pose& pose) {
  const Eigen::Vector3d& at = pose.position;
  const Eigen::Vector3d angles = robot.slide() ? Eigen::Vector3d(0.0, 0.0, pose.rotation) : pose.tilt;
  return {at.x(), at.y(), at.z(), to_degrees(angles.x()), to_degrees(angles.y()), to_degrees(angles.z())};
}

/// The program's joints, mm or deg.
json joints_at(const TemporaryFolder& folder, const Robot& robot, const std::string& command,
               const std::vector<Coordinates>& poses) {
  std::string text =
      robot.is_level() ? "x_mm,y_mm,z_mm,phi_deg\n" : "x_mm,y_mm,z_mm,tilt_x_deg,tilt_y_deg,tilt_z_deg\n";
  for (const auto& [x, y, z, a, b, c] : poses) {
    text += robot.is_level() ? fmt::format("{},{},{},{}\n", x, y, z, c)
                             : fmt::format("{},{},{},{},{},{}\n", x, y, z, a, b, c);
  }
  folder.write("poses.csv", text);
  const json found = json_of(folder.run(words(command + " --poses poses.csv --json")));
  return found.at(fmt::format("joints_{}", file_unit(joint_unit(robot.actuator()))));
}

/// The same of the calibrated machine.
json compensated(const TemporaryFolder& folder, const Robot& robot, const std::vector<Coordinates>& poses) {
  return joints_at(folder, robot, "compensate --calibration calibration.json", poses);
}

/// calibration.json of a template, with a wrong joint zero.
void calibrate_template(const TemporaryFolder& folder, const Robot& robot) {
  ASSERT_EQ(folder.run(words(fmt::format("robot --template {} --out r.toml", robot.name()))).exit_code, kDone);
  const Source zero = joint_zero(robot.actuator());
  const json error{
      {"name", name(zero)}, {"limb", 2}, {"value", 0.3}, {"unit", file_unit(unit(zero, robot.actuator()))}};
  folder.write("calibration.json", json{{"format", "paracal calibration 1"},
                                        {"accepted", true},
                                        {"parameters", {error}},
                                        {"robot", json_of(folder.run(words("robot --robot r.toml --json")))}}
                                       .dump());
}

class ConfigurationOfRobot : public LinuxcncConfiguration, public testing::WithParamInterface<std::string_view> {
 protected:
  void SetUp() override {
    LinuxcncConfiguration::SetUp();
    robot.is_level() ? calibrate(robot.name()) : calibrate_template(folder, robot);
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
  bool in_mm() const { return joint_unit(robot.actuator()) == Unit::mm; }

  Robot robot = robot_named(GetParam());
  const Workspace& workspace = robot.workspace();
  std::map<std::string, std::string> values;  ///< of the INI file, by [SECTION]KEY
};

const std::vector<std::string_view>& configured_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all = template_names();
    for (const std::string_view one : catalogue::names()) all.push_back(one);
    return all;
  }();
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, ConfigurationOfRobot, testing::ValuesIn(configured_names()), robot_name);

/// At the top speeds of the axes no joint goes faster than its own limit: by the program's inverse kinematics at both
/// ends of a thousandth of a second, anywhere on the ends of the workspace, in any direction; not far below where that
/// is what decides. The identified machine is another than the nominal one by less than a hundredth.
TEST_P(ConfigurationOfRobot, NoJointExceedsItsSpeed) {
  constexpr double kSeconds = 1e-3;
  std::mt19937 engine(5);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(engine); };
  const double linear = number("[TRAJ]MAX_LINEAR_VELOCITY"), turning = number("[TRAJ]MAX_ANGULAR_VELOCITY");
  EXPECT_EQ(number("[AXIS_X]MAX_VELOCITY"), linear);
  EXPECT_LE(number("[TRAJ]DEFAULT_LINEAR_VELOCITY"), linear);
  std::vector<Coordinates> ways;
  const std::vector<Pose> rim = workspace.rim(24, 0.99);
  for (int k = 0; k < 8000; ++k) {
    Coordinates from = coordinates_of(robot, rim[engine() % rim.size()]);
    Eigen::Vector3d way(uniform(-1, 1), uniform(-1, 1), moves(robot, 2) ? uniform(-1, 1) : 0.0);
    way *= linear * kSeconds / way.norm();
    Coordinates to = from;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (axis < 3) to[axis] += way[static_cast<Eigen::Index>(axis)];
      if (axis < 3 || !moves(robot, axis)) continue;
      EXPECT_EQ(number(fmt::format("[AXIS_{}]MAX_VELOCITY", kLetters[axis])), turning);
      from[axis] *= 0.99;
      to[axis] = from[axis] + (uniform(-1, 1) < 0.0 ? -1.0 : 1.0) * turning * kSeconds;
    }
    ways.insert(ways.end(), {from, to});
  }
  const json rows =
      joints_at(folder, robot, fmt::format("inverse --robot {}", robot.is_level() ? robot.name() : "r.toml"), ways);
  double fastest = 0.0;
  for (std::size_t k = 0; k < rows.size(); k += 2) {
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      fastest = std::max(fastest, std::abs(rows[k + 1][i].get<double>() - rows[k][i].get<double>()) / kSeconds);
    }
  }
  EXPECT_LE(fastest, 1.02 * number("[JOINT_0]MAX_VELOCITY"));
  if (linear < 500.0) {
    EXPECT_GT(fastest, 0.75 * number("[JOINT_0]MAX_VELOCITY"));
  }
}

TEST_P(ConfigurationOfRobot, LimitsOfJointsAreTheWorkspaceAndAMargin) {
  std::vector<Coordinates> poses;
  for (int circle = 0; circle <= 8; ++circle) {
    for (const Pose& pose : workspace.rim(72, circle / 8.0)) poses.push_back(coordinates_of(robot, pose));
  }
  Random random(3);
  for (int k = 0; k < 4000; ++k) poses.push_back(coordinates_of(robot, random.pose(robot)));
  const json joints = compensated(folder, robot, poses);
  const double margin = in_mm() ? 5.0 : 1.0;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    double lowest = 1e9, highest = -1e9;
    for (const json& row : joints) {
      lowest = std::min(lowest, row[i].get<double>());
      highest = std::max(highest, row[i].get<double>());
    }
    EXPECT_NEAR(number(fmt::format("[JOINT_{}]MIN_LIMIT", i)), lowest - margin, 0.05 * margin);
    EXPECT_NEAR(number(fmt::format("[JOINT_{}]MAX_LIMIT", i)), highest + margin, 0.05 * margin);
    EXPECT_EQ(values.at(fmt::format("[JOINT_{}]TYPE", i)), in_mm() ? "LINEAR" : "ANGULAR");
  }
  const std::string said = fmt::format("plus {:g} {} on each side", margin, in_mm() ? "mm" : "deg");
  EXPECT_THAT(folder.read("machine/paracal.ini"), HasSubstr(said));
  EXPECT_THAT(readme(), HasSubstr(said));
}

TEST_P(ConfigurationOfRobot, HomeIsTheCentreOfTheWorkspace) {
  const json joints = compensated(folder, robot, {coordinates_of(robot, {workspace.centre()})}).at(0);
  EXPECT_EQ(values.at("[KINS]JOINTS"), std::to_string(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    EXPECT_NEAR(number(fmt::format("[JOINT_{}]HOME", i)), joints[i].get<double>(), 1e-11);
    EXPECT_EQ(values.at(fmt::format("[JOINT_{}]HOME_OFFSET", i)), values.at(fmt::format("[JOINT_{}]HOME", i)));
  }
  const std::string z = moves(robot, 2) ? fmt::format(", Z {:g}. ", workspace.centre().z()) : ". ";
  EXPECT_THAT(readme(), HasSubstr("at the centre of the workspace" + z));
}

TEST_P(ConfigurationOfRobot, CoordinatesAreThoseOfThePlate) {
  std::string letters;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const std::string section = fmt::format("[AXIS_{}]", kLetters[axis]);
    ASSERT_EQ(values.contains(section + "MIN_LIMIT"), moves(robot, axis)) << section;
    if (!moves(robot, axis)) continue;
    letters += kLetters[axis];
    double lowest = 1e9, highest = -1e9;
    for (const Pose& pose : workspace.rim(4)) {
      lowest = std::min(lowest, coordinates_of(robot, pose)[axis]);
      highest = std::max(highest, coordinates_of(robot, pose)[axis]);
    }
    EXPECT_NEAR(number(section + "MIN_LIMIT"), lowest, 1e-9) << section;
    EXPECT_NEAR(number(section + "MAX_LIMIT"), highest, 1e-9) << section;
  }
  EXPECT_EQ(values.at("[TRAJ]COORDINATES"), letters);
}

/// What README.md and the tools say of the robot is so.
TEST_P(ConfigurationOfRobot, WordsAreThoseOfTheRobot) {
  const std::string text = readme(), tools = folder.read("machine/tool.tbl");
  const double floor = workspace.bounds().min().z(), top = workspace.bounds().max().z();
  const bool has_z = moves(robot, 2);
  const auto said_if = [&](bool expected, const std::string& words) {
    EXPECT_EQ(text.find(words) != std::string::npos, expected) << words;
  };
  said_if(has_z && top < 0.0, "so Z is negative");
  said_if(has_z && floor > 0.0, "so Z is positive");
  said_if(has_z, fmt::format("its Z 0 is Z {:g} of G54", floor));
  said_if(has_z && top < 0.0, "tool 50 mm below it. Enter your tool lengths in `tool.tbl`, downwards positive.");
  said_if(has_z && floor > 0.0, "tool 50 mm above it. Enter your tool lengths in `tool.tbl`, upwards negative.");
  said_if(!has_z, fmt::format("A motor for Z, as of a pen, is joint {}.", robot.limb_count()));
  said_if(robot.commands_tilt() && moves(robot, 3), "A is tilt_x");
  said_if(robot.commands_tilt() && moves(robot, 5), "C is tilt_z");
  EXPECT_EQ(tools.find("T2 P2 Z50 ") != std::string::npos, has_z && top < 0.0);
  EXPECT_EQ(tools.find("T2 P2 Z-50 ") != std::string::npos, has_z && floor > 0.0);
  EXPECT_EQ(folder.read("machine/paracal.var"), fmt::format("5243\t{:g}\n", has_z ? floor : 0.0));
  const char* joint = robot.actuator() == Actuator::strut ? "mm of the strut" : "mm of the carriage";
  said_if(true, fmt::format("counts per {}", in_mm() ? joint : "deg of the arm"));
}

// ---- The whole of LinuxCNC with it; robots of the catalogue: linuxcnc_test.cpp

class LinuxcncTemplate : public LinuxcncExport, public testing::WithParamInterface<std::string_view> {
 protected:
  /// In every test run one of each kind.
  bool is_left_out() const {
    return !every_machine() && GetParam() != "hexapod" && GetParam() != "five-bar" && GetParam() != "3-rrr";
  }

  void SetUp() override {
    LinuxcncExport::SetUp();
    if (IsSkipped() || is_left_out()) return;
    calibrate_template(folder, robot);
    ASSERT_EQ(folder.run(words(kConfigure)).exit_code, kDone);
    write_trial(folder.read("machine/paracal_kins.comp"));
    ASSERT_EQ(install("paracal_trial"), 0) << folder.read("halcompile.log");
  }

  /// At shares of the way from the centre to the ends of the axes.
  Coordinates at(const Coordinates& shares) const {
    Coordinates place = coordinates_of(robot, {workspace.centre()});
    const Coordinates half{workspace.half_width(0),
                           workspace.half_width(1),
                           0.5 * workspace.height,
                           to_degrees(workspace.tilt_about(0)),
                           to_degrees(workspace.tilt_about(1)),
                           to_degrees(workspace.tilt_about(2))};
    for (std::size_t axis = 0; axis < 6; ++axis) place[axis] += shares[axis] * half[axis];
    return place;
  }
  std::string words_of(const Coordinates& place) const {
    std::string words;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (moves(robot, axis)) words += fmt::format(" {}{}", kLetters[axis], place[axis]);
    }
    return words;
  }

  Robot robot = robot_named(GetParam());
  const Workspace& workspace = robot.workspace();
};

PARACAL_ON_ROBOT_TEMPLATES(LinuxcncTemplate);

/// LinuxCNC itself sees that joints stay within their limits, and says so if not.
TEST_P(LinuxcncTemplate, MovesAsTheLibrarySaysAndRefusesTheRest) {
  if (is_left_out()) return;
  const std::vector<Coordinates> places{at({0.5, 0.4, 0.9, 0.9, -0.9, 0.9}), at({-0.6, 0.3, -0.9, -0.9, 0.9, -0.9})};
  folder.write("machine/motions.ngc", fmt::format("G21 G90 G17 G94 F20000\nG54 G49\nG0{}\nM0\nG1{}\nM2\n",
                                                  words_of(places[0]), words_of(places[1])));
  folder.write("machine/box.ngc", fmt::format("G21 G90 G94 F20000\nG1 X{}\nM2\n", workspace.bounds().max().x() + 1.0));
  const json seen = seen_while_running("motions.ngc first_motions.ngc box.ngc");
  const PoseNumbers jogged = seen.at("jogged").at("place");
  json joints{seen.at("homed"), seen.at("jogged").at("joints")};
  for (const char* program : {"motions.ngc", "first_motions.ngc"}) {
    EXPECT_THAT(seen.at(program).at("messages"), IsEmpty()) << program;
    for (const json& rest : seen.at(program).at("rests")) joints.push_back(rest);
  }
  EXPECT_THAT(seen.at("box.ngc").at("messages"),
              testing::Contains("Linear move on line 2 would exceed X's positive limit"));
  const Coordinates home = at({});
  const json expected = compensated(folder, robot,
                                    {home,
                                     {jogged[0], jogged[1], moves(robot, 2) ? jogged[2] : home[2], 0.0, 0.0, jogged[3]},
                                     places[0],
                                     places[1],
                                     at({0.0, 0.0, 0.5})});
  ASSERT_EQ(joints.size(), expected.size());
  double worst = 0.0;  // deg, mm
  for (std::size_t k = 0; k < joints.size(); ++k) {
    ASSERT_EQ(joints[k].size(), robot.limb_count());
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      worst = std::max(worst, std::abs(joints[k][i].get<double>() - expected[k][i].get<double>()));
    }
  }
  RecordProperty("worst", json(worst).dump());
  EXPECT_LT(worst, 1e-9);
}

class LinuxcncPen : public LinuxcncTemplate {};

INSTANTIATE_TEST_SUITE_P(Template, LinuxcncPen, testing::Values("five-bar"), robot_name);

/// Changed as README.md says, Z has a joint of its own.
TEST_P(LinuxcncPen, IsTheJointAfterThoseOfTheRobot) {
  std::string ini = replaced(folder.read("machine/paracal.ini"), "COORDINATES = XY", "COORDINATES = XYZ");
  ini = replaced(ini, "JOINTS = 2", "JOINTS = 3");
  const std::string limits =
      "TYPE = LINEAR\nMIN_LIMIT = -20\nMAX_LIMIT = 20\nMAX_VELOCITY = 50\nMAX_ACCELERATION = 500\n";
  folder.write("machine/paracal.ini", ini + "\n[AXIS_Z]\n" + limits + "[JOINT_2]\n" + limits + "HOME_SEQUENCE = 0\n");
  folder.write("machine/paracal.hal",
               folder.read("machine/paracal.hal") + "net joint-2 joint.2.motor-pos-cmd => joint.2.motor-pos-fb\n");
  folder.write("machine/pen.ngc", "G21 G90 G94 F2000\nG54 G49 G1 X10 Y5 Z-7\nM2\n");
  const json rest = seen_while_running("pen.ngc").at("pen.ngc").at("rests").at(0);
  const json expected = compensated(folder, robot, {{10.0, 5.0, 0.0, 0.0, 0.0, 0.0}}).at(0);
  ASSERT_EQ(rest.size(), 3u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(rest[i].get<double>(), expected[i].get<double>(), 1e-9);
  EXPECT_NEAR(rest[2].get<double>(), -7.0, 1e-9);
}

}  // namespace
}  // namespace paracal::test::linuxcnc_configuration_test
