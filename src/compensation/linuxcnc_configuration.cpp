#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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

std::optional<CompensatorJoints<double>> joints_at(const CompensatorParameters<double>& parameters, const Pose& pose) {
  CompensatorJoints<double> joints{};
  const auto status = compensate(parameters, CompensationWay::exact, compensator_pose(pose), joints);
  return status == CompensationStatus::ok ? std::optional(joints) : std::nullopt;
}

/// Calls take(pose, joints) on circles at the ends of the workspace, as far as the machine reaches. While rods hang
/// down a joint rises with the plate, so extremes lie there, where a rod is square to them or at their rims.
void on_the_ends(const Robot& robot, const CompensatorParameters<double>& parameters, const auto& take) {
  constexpr int kCircles = 16, kPointsPerCircle = 72;
  for (int circle = 0; circle <= kCircles; ++circle) {
    for (const Pose& pose : robot.workspace().rim(kPointsPerCircle, static_cast<double>(circle) / kCircles)) {
      if (const auto joints = joints_at(parameters, pose)) take(pose, *joints);
    }
  }
}

/// What the workspace asks of each joint.
std::vector<Travel> joint_travels(const Robot& robot, const CompensatorParameters<double>& parameters,
                                  const Joints& home) {
  std::vector<Travel> travels;
  for (const double joint : home) travels.push_back({joint, joint});
  on_the_ends(robot, parameters, [&](const Pose&, const CompensatorJoints<double>& joints) {
    for (std::size_t i = 0; i < travels.size(); ++i) travels[i].reach(joints[i]);
  });
  return travels;
}

/// The joint that moves fastest while the plate moves and turns as fast as it may, in whatever direction, deg/s or
/// mm/s: |dq/dr| v + |dq/dphi| w.
double fastest_joint(const Robot& robot, const CompensatorParameters<double>& parameters) {
  constexpr double kStep = 0.01;  // mm and, for a lever of 100 mm, 1e-4 rad
  constexpr double kTurn = 1e-4;  // rad
  double fastest = 0.0;
  on_the_ends(robot, parameters, [&](const Pose& pose, const CompensatorJoints<double>& joints) {
    Eigen::Matrix3Xd by_place = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(robot.limb_count()));
    Eigen::VectorXd by_turn = Eigen::VectorXd::Zero(by_place.cols());
    for (int axis = 0; axis < 4; ++axis) {
      Pose moved = pose;
      axis < 3 ? moved.position[axis] += kStep : moved.rotation += robot.slide() ? kTurn : 0.0;
      const auto there = joints_at(parameters, moved);
      for (Eigen::Index i = 0; there && i < by_place.cols(); ++i) {
        const double change = (*there)[static_cast<std::size_t>(i)] - joints[static_cast<std::size_t>(i)];
        axis < 3 ? by_place(axis, i) = change / kStep : by_turn[i] = change / kTurn;
      }
    }
    const Eigen::VectorXd speeds =
        kLinearSpeed * by_place.colwise().norm().transpose() + to_radians(kTurningSpeed) * by_turn.cwiseAbs();
    fastest = std::max(fastest, shown_joint(robot, speeds.maxCoeff()));
  });
  return fastest;
}

/// By how much the sample speeds of the axes are reduced so that no joint is asked for more than its own; two digits.
double share_of_speeds(const Robot& robot, const SourceErrors& errors) {
  const double share = joint_sample(robot).speed / fastest_joint(robot, compensator_parameters<double>(robot, errors));
  return std::min(1.0, std::floor(100.0 * share) / 100.0);
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

std::string axes(const Robot& robot, double share) {
  const Workspace& whole = robot.workspace();
  const Eigen::AlignedBox3d bounds = whole.bounds();
  const double linear = share * kLinearSpeed;
  std::string text;
  for (int k = 0; k < 3; ++k) {
    text += axis(static_cast<char>('X' + k), {bounds.min()[k], bounds.max()[k]}, linear);
  }
  if (!robot.slide()) return text;
  return text + axis('C', {to_degrees(whole.min_rotation), to_degrees(whole.max_rotation)}, share * kTurningSpeed);
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
  const Joints home = self_test(robot, build(robot, errors)).front().joints;
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
  const Eigen::Vector3d centre = workspace.centre();
  const double quarter = 0.25 * std::min(workspace.half_width(0), workspace.half_width(1));
  values.emplace_back("FLOOR", number(workspace.bounds().min().z()));
  values.emplace_back("CENTRE_X", number(centre.x()));
  values.emplace_back("CENTRE_Y", number(centre.y()));
  values.emplace_back("CENTRE_Z", number(centre.z()));
  values.emplace_back("ABOVE", number(centre.z() + 0.25 * workspace.height));
  values.emplace_back("QUARTER", number(quarter));
  values.emplace_back("AT_QUARTER", number(centre.x() + quarter));
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
  const double share = share_of_speeds(robot, errors);
  values.emplace_back("AXES", axes(robot, share));
  values.emplace_back("LINEAR_SPEED", number(share * kLinearSpeed));
  values.emplace_back("LINEAR_ACCELERATION", number(10.0 * share * kLinearSpeed));
  values.emplace_back("TURNING_SPEED", number(share * kTurningSpeed));
  values.emplace_back("TURNING_ACCELERATION", number(10.0 * share * kTurningSpeed));
  values.emplace_back("DEFAULT_SPEED", number(std::min(100.0, share * kLinearSpeed)));
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
