#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "paracal/io/json.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/tolerance/failure.hpp"
#include "paracal/tolerance/requirement.hpp"

namespace paracal::app {

/// The tolerances of a file, of which some must be above zero; without one the robot's, or generous ones.
Tolerances tolerances_of(const Robot& robot, const std::string& file);

constexpr double kUsualMaxTilt = 1e-3;  ///< rad: that of the paper

/// The unit of angles in a text: that in which the user gave a limit.
struct AngleUnit {
  double per_rad = 1.0;
  std::string name = "rad";  ///< or "deg", "mm over 100 mm"
};

/// An angle that is given in one of three ways.
struct AngleOption {
  std::optional<double> rad = {}, deg = {};
  std::string zone = {};  ///< "0.1/100", mm over mm
  /// rad; empty where none was given.
  std::optional<double> value() const;
  AngleUnit unit() const;
};
/// STEM-deg and STEM-mm beside an option in rad; each excludes the others.
/// @returns all three.
std::array<Option*, 3> add_angle_options(Command& command, AngleOption& angle, const std::string& option_in_rad,
                                         const std::string& stem, const std::string& text);

/// A value of a quantity in the units of screens and JSON keys: mm, rad for tilt and twist, deg for rotation.
struct Shown {
  double value = 0.0;
  std::string unit;
};
Shown shown(Quantity quantity, double value);
/// The same in a text, for a limit that may have been given in other units.
Shown shown(const Requirement& requirement, double value, const AngleUnit& angles);
/// "tilt_rad", "position_compensated_mm", "rotation_deg".
std::string json_key(Characteristic characteristic);

/// "(500, 0, -1013) mm, 180 deg"; "(500, 0, 813) mm, tilted by (0, 10, 0) deg" of a plate with six freedoms.
std::string pose_text(const Robot& robot, const Pose& pose);

/// The tilt group in the paper's units: the six keys of the contract.
io::Json tilt_group_json(const PerSource& values);

/// Tolerances for a text: the chosen ones of more digits than anybody types, rounded down to two, so that limits stay
/// kept.
/// @param rest  as they were stated: what did not change was not chosen.
Tolerances rounded_down(const Robot& robot, Tolerances chosen, const Tolerances& rest);

/// Adds `half_widths`, as a table of tolerances has them, and `drawing`, what they are there.
void add_half_widths(io::Json& json, const Robot& robot, const Tolerances& tolerances);

io::Json contributors_json(const std::vector<Contributor>& contributors);
/// A line a source: its share, and a bar as long.
std::string pareto(const std::vector<Contributor>& contributors);

/// What `sensitivity` finds.
struct SensitivityFindings {
  Characteristic what = {};
  GlobalSensitivity global = {};
  std::optional<PerSource> local = {};
  ValueAtPose worst = {};  ///< largest 3 sigma
  std::vector<Contributor> contributors = {};
  Tolerances tolerances = {};
};
SensitivityFindings find_sensitivity(const Robot& robot, Characteristic what, const Tolerances& tolerances,
                                     const GlobalSensitivityOptions& options = {});
io::Json sensitivity_json(const Robot& robot, const SensitivityFindings& found);

/// report::three_sigma_map() in the units of screens, with {quantity, unit}.
io::Json three_sigma_json(const Robot& robot, Characteristic what, const Tolerances& tolerances);

/// Accepts the name of a characteristic.
Rule characteristic_validator();

/// The yield in percent and its defects per million, each with its interval, and where they come from.
std::string yield_text(const FailureShare& failures, const MonteCarlo& drawn, double confidence);

/// A line: the share of machines that break one limit of several.
std::string failure_line(const FailureShare& failures);

}  // namespace paracal::app
