#include "controller.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "inputs.hpp"
#include "paracal/error.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

std::string joint_text(double joint, Actuator actuator) {
  const Unit unit = joint_unit(actuator);
  return fmt::format("{:.4f} {}", to_file_unit(unit, joint), file_unit(unit));
}

std::string place_text(const Pose& pose) {
  constexpr double kNothing = 1e-9;  // mm: what a cosine leaves of zero
  const Eigen::Vector3d r = (pose.position.array().abs() < kNothing).select(0.0, pose.position);
  std::string text = fmt::format("({:g}, {:g}, {:g}) mm", r.x(), r.y(), r.z());
  if (pose.rotation != 0.0) text += fmt::format(" at {:g} deg", to_degrees(pose.rotation));
  if (!pose.tilt.isZero(0.0)) {
    const Eigen::Vector3d tilt = to_degrees(1.0) * pose.tilt;
    text += fmt::format(" tilted by ({:g}, {:g}, {:g}) deg", tilt.x(), tilt.y(), tilt.z());
  }
  return text;
}

/// What would explain the joints, and what to do.
std::string explained(const ControllerCheck& check) {
  if (check.explanations.empty()) {
    return "No single dimension, zero, sign, order, gear ratio, frame or tool explains the difference: compare every "
           "setting of the controller with the robot file";
  }
  if (check.explanations.size() == 1 && check.is_named) {
    return fmt::format(
        "This explains the difference: {}. Correct the robot file, or calibrate with --controller FILE, a robot file "
        "with the dimensions of the controller",
        check.explanations.front());
  }
  if (check.explanations.size() == 1) {
    return fmt::format(
        "These joints cannot name the cause: {} would explain any of them. Add the joints at another "
        "pose, such as {}",
        check.explanations.front(), place_text(*check.deciding));
  }
  const std::string each =
      fmt::format("Each of these alone explains the difference: {}", fmt::join(check.explanations, "; "));
  if (!check.deciding) return each + ". State the joints with more digits to decide";
  return fmt::format("{}. These poses cannot decide: add the joints at another pose, such as {}", each,
                     place_text(*check.deciding));
}

std::string disagreement(const Robot& robot, const ControllerCheck& check,
                         const std::vector<DisplayedJoints>& displayed) {
  const DisplayedJoints& row = displayed[*check.differs];
  const auto limb = static_cast<Eigen::Index>(check.limb);
  return fmt::format("expected q{} = {} at pose {} (computed with {}), got {}. {}", check.limb + 1,
                     joint_text(check.expected, robot.actuator()), row.name, dimensions_in_words(robot),
                     joint_text(row.joints(limb), robot.actuator()), explained(check));
}

/// "2 poses of j.csv"
std::string source_text(const std::string& file, const ControllerCheck& check) {
  return fmt::format("{} {} of {}", check.compared, check.compared == 1 ? "pose" : "poses",
                     std::filesystem::path(file).filename().string());
}

/// What agreement at these poses does not show, and what would.
std::string unconfirmed(const std::string& file, const ControllerCheck& check) {
  return fmt::format(
      "the joints at {} agree, but would also agree with another value of: {}. Add the joints at {} to "
      "confirm it",
      source_text(file, check), fmt::join(check.unseen, ", "), place_text(*check.deciding));
}

/// @throws InputFileError for joints that are not the robot's.
ControllerCheck require_agreement(const Robot& robot, const std::string& file,
                                  const std::vector<DisplayedJoints>& displayed) {
  ControllerCheck check = check_controller(robot, displayed);
  if (check.agrees()) return check;
  throw InputFileError(file, displayed[*check.differs].line, disagreement(robot, check, displayed));
}

std::string first_joint_column(const Robot& robot) {
  return joint_unit(robot.actuator()) == Unit::mm ? "q1_mm" : "q1_deg";
}

/// Those of the files that may state joints beside commanded poses.
std::vector<io::TextFile> tables_with_joints(const MeasuringOptions& measuring, const Robot& robot) {
  std::vector<io::TextFile> tables;
  const auto add = [&](const std::string& name, bool commands) {
    io::TextFile file = look_into(name);
    file.style = measuring.style;
    const auto has = [&](std::string_view column) { return file.text.find(column) != std::string::npos; };
    if (has(first_joint_column(robot)) && (commands || has("x_cmd_mm"))) tables.push_back(std::move(file));
  };
  for (const std::string& name : measuring.files) add(name, false);
  for (const std::string& name : measuring.poses) add(name, true);
  return tables;
}

bool states_joints(const Station& station) { return station.believed.has_value(); }

/// Joints that all rows state count as they stand; where other dimensions of the controller explain them, its targets
/// are others. What nothing explains is for the diagnosis of the fit: joints in rad, limbs in another order.
void note_other_joints(const std::vector<io::TextFile>& tables, const Robot& controller, Measurements& measurements) {
  for (const io::TextFile& table : tables) {
    const auto displayed = io::read_displayed_joints(table, controller.joint_space());
    if (displayed.empty()) continue;
    try {
      const ControllerCheck check = check_controller(controller, displayed);
      if (check.agrees() || check.explanations.empty()) continue;
      measurements.notes.push_back(
          fmt::format("{}:{}: the joints do not match the commanded pose with {}. Compensated joints are correct, "
                      "corrected targets are not: state the dimensions of the controller (--controller)",
                      table.name, displayed[*check.differs].line, dimensions_in_words(controller)));
    } catch (const Unreachable&) {
      continue;  // a pose that nobody needs: its joints are there
    }
  }
}

/// Where some rows state joints and others do not, those that do show the dimensions. Rounded as they are, they then
/// count no more: what the dimensions give is better.
void settle(const std::vector<io::TextFile>& tables, const Robot& robot, CommandedReadings& read) {
  std::vector<Station>& stations = read.measurements.stations;
  if (std::ranges::none_of(stations, states_joints)) return;
  if (std::ranges::all_of(stations, states_joints)) {
    return note_other_joints(tables, read.controller.computes_with(robot), read.measurements);
  }
  bool is_shown = false;
  for (const io::TextFile& table : tables) {
    const auto displayed = io::read_displayed_joints(table, robot.joint_space());
    if (displayed.empty()) continue;
    const ControllerCheck check = require_agreement(read.controller.computes_with(robot), table.name, displayed);
    is_shown = true;
    if (read.controller.evidence != ControllerEvidence::assumed) continue;
    read.controller.source = check.unseen.empty() ? "" : unconfirmed(table.name, check);
    if (check.unseen.empty()) read.controller.evidence = ControllerEvidence::readings;
  }
  if (!is_shown) return;
  for (Station& station : stations) station.believed.reset();
}

}  // namespace

void add_controller_options(Command& command, ControllerOptions& options) {
  command.heading("Controller");
  command.add_option("--controller-joints", options.joints,
                     "poses and the joints that the controller displays there (CSV: x_mm,y_mm,z_mm[,phi_deg],q1_deg,"
                     "...); checks whether the controller uses the dimensions of the robot file");
}

void add_controller_robot_option(Command& command, ControllerOptions& options) {
  command.add_option("--controller", options.robot,
                     "robot file (TOML) with the dimensions that the controller uses, if they differ from --robot");
}

ControllerModel stated_controller(const ControllerOptions& options, const Robot& robot) {
  if (options.robot.empty()) return {};
  Robot controller = io::read_robot(io::read_stored(options.robot));
  const auto joints = [](const Robot& one) {
    return fmt::format("{} joints in {}{}", one.limb_count(), file_unit(joint_unit(one.actuator())),
                       one.slide() ? ", a plate that turns" : "");
  };
  if (joints(controller) != joints(robot) || controller.actuator() != robot.actuator()) {
    throw InputFileError(options.robot, 0,
                         fmt::format("expected a controller of {}, with {}, got {}: describe the same kind of robot",
                                     robot.name(), joints(robot), joints(controller)));
  }
  return {.evidence = ControllerEvidence::stated,
          .source = std::filesystem::path(options.robot).filename().string(),
          .robot = std::move(controller)};
}

ControllerModel checked_controller(const ControllerOptions& options, ControllerModel known, const Robot& robot,
                                   const io::TableStyle& style) {
  if (options.joints.empty()) return known;
  const io::TextFile file = input_table(options.joints, style);
  const std::vector<DisplayedJoints> displayed = io::read_displayed_joints(file, robot.joint_space());
  if (displayed.empty()) {
    throw InputFileError(file.name, 0,
                         fmt::format("expected columns {}, ... with the joints that the controller displays, got no "
                                     "row with joints: add them to the poses",
                                     first_joint_column(robot)));
  }
  const ControllerCheck check = require_agreement(known.computes_with(robot), file.name, displayed);
  if (known.evidence != ControllerEvidence::assumed) return known;
  if (!check.unseen.empty()) {
    known.source = unconfirmed(file.name, check);
    return known;
  }
  known.evidence = ControllerEvidence::confirmed;
  known.source = source_text(file.name, check);
  return known;
}

io::CalibratedMachine checked_calibration(const io::JsonFile& file, const ControllerOptions& options,
                                          const Robot& robot, const io::TableStyle& style) {
  try {
    return io::read_calibration(file, robot);
  } catch (const InputFileError&) {
    (void)checked_controller(options, {}, robot, style);
    throw;
  }
}

CommandedReadings read_commanded(const MeasuringOptions& measuring, const ControllerOptions& options,
                                 ControllerModel known, const Robot& robot) {
  known = checked_controller(options, std::move(known), robot, measuring.style);
  const std::vector<io::TextFile> tables = tables_with_joints(measuring, robot);
  CommandedReadings read{measuring.read(known.computes_with(robot)), std::move(known)};
  settle(tables, robot, read);
  if (read.controller.robot) read.measurements = commanded_by(*read.controller.robot, std::move(read.measurements));
  return read;
}

std::string joints_request(const Robot& robot) {
  return fmt::format(
      "# Read the joints that the controller displays at two of these poses, near the rim. Enter them in these rows of "
      "the\n# measurements (columns {}, ...; blank in the other rows). They show which dimensions the controller "
      "uses.\n",
      first_joint_column(robot));
}

std::vector<ComparisonPose> comparison(const Robot& robot, const ControllerModel& controller) {
  std::vector<ComparisonPose> poses = comparison_poses(robot);
  for (ComparisonPose& one : poses) one.joints = believed_joints(controller.computes_with(robot), {one.name, one.pose});
  return poses;
}

std::vector<std::string> comparison_lines(const Robot& robot, const ControllerModel& controller) {
  const Unit unit = joint_unit(robot.actuator());
  std::vector<std::string> lines;
  for (const ComparisonPose& one : comparison(robot, controller)) {
    std::vector<std::string> joints;
    for (const double joint : one.joints) joints.push_back(fmt::format("{:.4f}", to_file_unit(unit, joint)));
    lines.push_back(fmt::format("nominal joints at {}, {}: {} {}", one.name, place_text(one.pose),
                                fmt::join(joints, ", "), file_unit(unit)));
  }
  return lines;
}

io::Json comparison_json(const Robot& robot, const ControllerModel& controller) {
  return io::json_array(comparison(robot, controller), [&](const ComparisonPose& one) {
    io::Json entry = joints_json({one.name, one.joints}, robot.actuator());
    entry["pose"] = io::to_json(one.pose, robot.commands_tilt());
    return entry;
  });
}

}  // namespace paracal::app
