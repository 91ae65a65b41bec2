#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "export_text.hpp"
#include "paracal/compensation/export.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

using namespace compensation_detail;

/// A coordinate's way: mm or rad.
struct Travel {
  double lowest, highest;

  void reach(double coordinate) {
    lowest = std::min(lowest, coordinate);
    highest = std::max(highest, coordinate);
  }
};

/// Sample speed of a joint, and what its limits leave beside its travel; mm or deg.
struct JointSample {
  std::string_view type, name, rises;
  double margin, speed;
};

constexpr JointSample kArm{"ANGULAR", "arm", "the arm's end rises", 1.0, 180.0};
constexpr JointSample kRail{"LINEAR", "carriage", "the carriage rises", 5.0, 500.0};

constexpr double kLinearSpeed = 500.0, kTurningSpeed = 360.0;  // mm/s, deg/s

JointSample joint_sample(const Robot& robot) { return robot.actuator() == Actuator::linear ? kRail : kArm; }

/// A joint as LinuxCNC shows it.
double shown_joint(const Robot& robot, double joint) {
  return robot.actuator() == Actuator::linear ? joint : to_degrees(joint);
}

/// What the workspace asks of each joint, as far as the machine reaches. While rods hang down a joint rises with the
/// plate, so the extremes lie on the workspace's ends, where a rod is square to them or at their rims.
std::vector<Travel> joint_travels(const Robot& robot, const CompensatorParameters<double>& parameters,
                                  const Joints& home) {
  constexpr int kCircles = 16, kPointsPerCircle = 72;
  std::vector<Travel> travels;
  for (const double joint : home) travels.push_back({joint, joint});
  for (int circle = 0; circle <= kCircles; ++circle) {
    Workspace inner = robot.workspace();
    inner.radius *= static_cast<double>(circle) / kCircles;
    for (const Pose& pose : inner.rim(kPointsPerCircle)) {
      CompensatorJoints<double> joints{};
      const auto status = compensate(parameters, CompensationWay::exact, compensator_pose(pose), joints);
      if (status != CompensationStatus::ok) continue;
      for (std::size_t i = 0; i < travels.size(); ++i) travels[i].reach(joints[i]);
    }
  }
  return travels;
}

/// As people type it.
std::string number(double value) { return fmt::format("{:.12g}", value); }

Values speed(double value) { return {{"SPEED", number(value)}, {"ACCELERATION", number(10.0 * value)}}; }

std::string axis(char letter, const Travel& travel, double sample_speed) {
  Values values = speed(sample_speed);
  values.emplace_back("LETTER", std::string(1, letter));
  values.emplace_back("LOWEST", number(travel.lowest));
  values.emplace_back("HIGHEST", number(travel.highest));
  return filled_template("linuxcnc_axis.ini", values);
}

std::string axes(const Robot& robot) {
  const Workspace& whole = robot.workspace();
  const Travel level{-whole.radius, whole.radius}, height{whole.top_z - whole.height, whole.top_z};
  std::string text = axis('X', level, kLinearSpeed) + axis('Y', level, kLinearSpeed) + axis('Z', height, kLinearSpeed);
  if (!robot.slide()) return text;
  return text + axis('C', {to_degrees(whole.min_rotation), to_degrees(whole.max_rotation)}, kTurningSpeed);
}

std::string joint(const Robot& robot, std::size_t number, const Travel& travel, double home) {
  const JointSample sample = joint_sample(robot);
  Values values = speed(sample.speed);
  values.emplace_back("JOINT", std::to_string(number));
  values.emplace_back("TYPE", sample.type);
  values.emplace_back("LOWEST", fmt::format("{:.3f}", shown_joint(robot, travel.lowest) - sample.margin));
  values.emplace_back("HIGHEST", fmt::format("{:.3f}", shown_joint(robot, travel.highest) + sample.margin));
  values.emplace_back("HOME", decimal(shown_joint(robot, home)));
  return filled_template("linuxcnc_joint.ini", values);
}

std::string joints(const Robot& robot, const SourceErrors& errors) {
  const auto parameters = compensator_parameters<double>(robot, errors);
  const Joints home = self_test(robot, parameters).front().joints;
  const std::vector<Travel> travels = joint_travels(robot, parameters, home);
  std::string text;
  for (std::size_t i = 0; i < travels.size(); ++i) {
    text += joint(robot, i, travels[i], home(static_cast<Eigen::Index>(i)));
  }
  return text;
}

std::string motor_loops(const Robot& robot) {
  std::string text;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    text += fmt::format("net joint-{0} joint.{0}.motor-pos-cmd => joint.{0}.motor-pos-fb\n", i);
  }
  return text;
}

/// Places in the workspace, mm, and a turn to both sides where the plate has one.
void add_places(const Robot& robot, Values& values) {
  const Workspace& workspace = robot.workspace();
  const double centre = workspace.centre().z();
  values.emplace_back("FLOOR", number(workspace.top_z - workspace.height));
  values.emplace_back("CENTRE", number(centre));
  values.emplace_back("ABOVE", number(centre + 0.25 * workspace.height));
  values.emplace_back("QUARTER", number(0.25 * workspace.radius));
  const std::string turn = fmt::format("G1 C{}\nG1 C{}\nG0 C0\n", number(0.5 * to_degrees(workspace.max_rotation)),
                                       number(0.5 * to_degrees(workspace.min_rotation)));
  values.emplace_back("TURN", robot.slide() ? turn : "");
}

/// Files of the configuration, and their templates.
constexpr std::array<std::pair<const char*, const char*>, 6> kFiles{{{"README.md", "linuxcnc.md"},
                                                                     {"first_motions.ngc", "linuxcnc.ngc"},
                                                                     {"paracal.hal", "linuxcnc.hal"},
                                                                     {"paracal.ini", "linuxcnc.ini"},
                                                                     {"paracal.var", "linuxcnc.var"},
                                                                     {"tool.tbl", "linuxcnc.tbl"}}};

}  // namespace

std::map<std::string, std::string> linuxcnc_configuration(const Robot& robot, const SourceErrors& errors,
                                                          const ExportOrigin& origin) {
  const JointSample sample = joint_sample(robot);
  Values values = head(robot, origin);
  values.emplace_back("COORDINATES", robot.slide() ? "XYZC" : "XYZ");
  values.emplace_back("AXES", axes(robot));
  values.emplace_back("JOINTS", joints(robot, errors));
  values.emplace_back("LOOPS", motor_loops(robot));
  values.emplace_back("MARGIN", number(sample.margin));
  values.emplace_back("JOINT_NAME", sample.name);
  values.emplace_back("RISES", sample.rises);
  add_places(robot, values);
  std::map<std::string, std::string> files{{"paracal_kins.comp", linuxcnc_component(robot, errors, origin)}};
  for (const auto& [name, from] : kFiles) files.emplace(name, filled_template(from, values));
  return files;
}

}  // namespace paracal
