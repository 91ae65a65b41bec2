#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// How it is known with which dimensions a controller computes joints from poses.
enum class ControllerEvidence : std::uint8_t {
  assumed,    ///< nothing shows it: those of the robot file
  readings,   ///< rows of the measurements state joints
  confirmed,  ///< joints that it displays are those of the robot file
  stated,     ///< somebody said it: a robot file of the controller, or a firmware's own settings
};

/// "assumed", "readings", "confirmed", "stated": in JSON.
std::string_view name(ControllerEvidence evidence);
/// Empty for another word.
std::optional<ControllerEvidence> controller_evidence(std::string_view name);

/// What turned commanded poses into joints, as far as it is known.
struct ControllerModel {
  ControllerEvidence evidence = ControllerEvidence::assumed;
  /// What confirmed or stated it: "2 poses of joints.csv". Of an assumption: what would confirm it; empty: any joints.
  std::string source = {};
  std::optional<Robot> robot = {};  ///< whose dimensions it computes with, where they are not those of the drawing

  /// The robot that it computes with.
  const Robot& computes_with(const Robot& drawing) const { return robot ? *robot : drawing; }
};

/// "rod 730 mm, arm 310 mm, base radius 210 mm, plate radius 55 mm": what the nominal inverse kinematics depend on.
std::string dimensions_in_words(const Robot& robot);

/// What a result that depends on the controller's dimensions says of them; empty where joints were read.
std::vector<std::string> controller_assumptions(const ControllerModel& controller, const Robot& drawing);

/// The model with readings: rows with joints replace an assumed evidence.
ControllerModel with_readings(ControllerModel controller, const Measurements& measurements);

/// Joints of all stations that state none, as a controller with the dimensions of another robot computes them.
/// @throws Unreachable when that robot does not reach a commanded pose.
Measurements commanded_by(const Robot& controller, Measurements measurements);

}  // namespace paracal
