#pragma once

#include <string>
#include <vector>

#include "arguments.hpp"
#include "measuring.hpp"
#include "paracal/calibration/controller_joints.hpp"
#include "paracal/calibration/controller_model.hpp"
#include "paracal/io/json.hpp"

namespace paracal::app {

/// What a command is told of the controller that turns poses into joints.
struct ControllerOptions {
  std::string joints = {};  ///< a table of joints that it displays
  std::string robot = {};   ///< a robot file with its dimensions; empty: nobody says
};

/// --controller-joints.
void add_controller_options(Command& command, ControllerOptions& options);

/// --controller.
void add_controller_robot_option(Command& command, ControllerOptions& options);

/// What --controller says; nothing known without it.
/// @throws InputFileError for a robot with other joints than `robot`.
ControllerModel stated_controller(const ControllerOptions& options, const Robot& robot);

/// What is known of a controller once the joints that it displays were compared.
/// @throws InputFileError for joints that are not those of its dimensions, with what would explain them.
ControllerModel checked_controller(const ControllerOptions& options, ControllerModel known, const Robot& robot,
                                   const io::TableStyle& style);

/// A calibration from its file. Where it is refused, such as one that was not accepted, the joints of the controller
/// are compared before: a wrong controller may be why.
/// @throws InputFileError for such joints, and for what io::read_calibration() refuses.
io::CalibratedMachine checked_calibration(const io::JsonFile& file, const ControllerOptions& options,
                                          const Robot& robot, const io::TableStyle& style = {});

/// Readings with what is known of the controller that commanded their poses.
struct CommandedReadings {
  Measurements measurements;
  ControllerModel controller;
};

/// Reads what `measuring` names. Where some rows state joints they are compared as those of --controller-joints, and
/// the other rows have what the same dimensions give; where all do, they count as they stand.
/// @throws InputFileError as checked_controller() and MeasuringOptions::read().
CommandedReadings read_commanded(const MeasuringOptions& measuring, const ControllerOptions& options,
                                 ControllerModel known, const Robot& robot);

/// Comment lines of a plan, which ask for joints beside one of its poses.
std::string joints_request(const Robot& robot);

/// Poses of a robot's workspace with the joints that its controller displays there.
std::vector<ComparisonPose> comparison(const Robot& robot, const ControllerModel& controller);
/// "nominal joints at home, (0, 0, -695) mm: 12.3457, 12.3457, 12.3457 deg", a line for each.
std::vector<std::string> comparison_lines(const Robot& robot, const ControllerModel& controller);
/// [{name, pose, joints_deg: [...]}]
io::Json comparison_json(const Robot& robot, const ControllerModel& controller);

}  // namespace paracal::app
