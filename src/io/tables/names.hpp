#pragma once

// Private to io: names and units as they stand in files.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"
#include "paracal/mechanism/tolerances.hpp"
#include "paracal/units.hpp"

namespace paracal::io {

using paracal::file_unit;  // beside that of a source

/// "revolute", "linear" or "strut".
std::string_view actuator_name(Actuator actuator);

/// "deg" or "mm".
std::string_view file_unit(Source source, Actuator actuator);

/// A robot's [joints] in a file: "max_speed_deg_per_s" or "max_speed_mm_per_s", and so on, with their values.
std::array<std::pair<std::string, double>, 2> joint_limits_in_file(const JointLimits& limits, Actuator actuator);
std::string joint_speed_key(Actuator actuator);
std::string joint_acceleration_key(Actuator actuator);

/// Factor from mm or rad to that unit.
double file_factor(Source source, Actuator actuator);

/// What `format` says in the JSON of a calibration.
inline constexpr const char* kCalibrationFormat = "paracal calibration 1";

/// The key of files, with unit: "theta_offset_deg", "gain_mm_per_m"; "e_mm" for the three coordinates of e.
std::string file_key(Source source, Actuator actuator);

/// One source a key, in column order: e_x stands for all of e.
std::vector<Source> leading_sources(const Limbs& limbs);

/// Those whose tolerances a file lists: all but what a table took for exact without listing it.
std::vector<Source> listed_tolerances(const Tolerances& tolerances, const Limbs& limbs);

/// Keys of those whose values nobody states.
std::vector<std::string> generous_keys(const Tolerances& tolerances, const Limbs& limbs);

std::string_view distribution_name(Distribution distribution);
std::optional<Distribution> distribution_named(std::string_view name);
/// All names, for messages.
std::string distribution_names();

/// The shortest decimal that is the same to 15 digits: 0.1 + 0.2 becomes 0.3, so that files read as they were typed.
double tidy(double value);
double tidy_degrees(double radians);

}  // namespace paracal::io
