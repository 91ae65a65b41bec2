#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>

#include "paracal/batch/batch.hpp"
#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/compensation/compensator.hpp"
#include "paracal/compensation/export.hpp"
#include "paracal/compensation/self_test.hpp"
#include "paracal/io/file.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {
struct FailureShare;
struct PrinterCalibration;
}  // namespace paracal

namespace paracal::io {

/// Objects that keep the order in which keys were added.
using Json = nlohmann::ordered_json;

/// A JSON file.
/// @throws InputFileError, with the line, for invalid JSON, a key that an object has twice, more than 64 levels of
/// nesting, or far more values than text.
Json parse_json(const TextFile& file);

/// A JSON file, parsed once for all that read it.
struct JsonFile {
  /// @throws InputFileError as parse_json().
  explicit JsonFile(TextFile file) : text(std::move(file)), json(parse_json(text)) {}

  TextFile text;
  Json json;
};

/// "2016-10-05T12:00:00Z", from seconds since 1970.
std::string utc(std::int64_t time);

/// The robot under the keys of its TOML file.
Json to_json(const Robot& robot);

/// A calibration file: all that is needed to use it and to repeat the fit; keys in docs/json-keys.md. Angles in deg,
/// the covariance in the units of the parameters. `time`: seconds since 1970, written as UTC date.
Json to_json(const Calibration& calibration, std::int64_t time);

/// Largest errors, under the contract's keys.
Json to_json(const PoseErrorSummary& summary);

/// Result of validate(); keys in docs/json-keys.md.
Json to_json(const Validation& validation);

Json to_json(const Tolerances& tolerances, const Limbs& limbs);
/// Half-widths as statements of a drawing, under the keys of files: {statement, grade, text}, see DrawingStatement;
/// null: none. Without sources that are exact.
Json drawing_json(const Tolerances& tolerances, const Robot& robot);

Json to_json(const TrackerModel& tracker);

/// The options of a calibration of a robot with these actuators.
Json to_json(const CalibrationOptions& options, const Limbs& limbs);

/// Everything that determines the machines of a batch, so that results of another batch or program version can be
/// distinguished. Numbers as inside the library (mm, rad), to the last bit.
Json to_json(const Batch& batch);

/// Counts of outcomes, errors before and after calibration and, if limits are stated, yield and defects per million;
/// keys in docs/json-keys.md.
/// @param confidence  of the intervals.
Json to_json(const Batch& batch, const Tally& tally, double confidence);

/// Advice to the owner of a printer, without the calibration itself; keys in docs/json-keys.md.
Json to_json(const PrinterCalibration& found);

/// {value, low, high}
Json to_json(const Proportion& proportion);
/// {status, reason, linear, check, exact: {value, low, high, machines, effective} or null, not_closed}
Json to_json(const FailureShare& failures);
/// [low, high], each times the factor to the unit of the key.
Json interval_json(const Interval& interval, double factor = 1.0);

/// Files with their hashes.
Json to_json(const std::vector<InputFile>& files);

/// Origin of an export: robot, calibration, calibration_sha256, date, program.
Json to_json(const Robot& robot, const ExportOrigin& origin);

/// All parameters of a compensator, mm and deg; keys in docs/json-keys.md.
Json to_json(const CompensatorParameters<double>& parameters);

/// {pose: {x_mm, y_mm, z_mm, phi_deg}, joints_deg: [q1, ...]}; joints_mm for rails.
Json to_json(const SelfTestCase& wanted, Actuator actuator, bool tilts = false);

/// x_mm, y_mm, z_mm, phi_deg
/// @param tilts  with tilt_x_deg, tilt_y_deg, tilt_z_deg, for a plate with six degrees of freedom.
Json to_json(const Pose& pose, bool tilts = false);

/// The machine of a calibration file.
struct CalibratedMachine {
  SourceErrors errors;
  std::vector<ParameterEstimate> parameters = {};  ///< those that were estimated; limb, source and value only
  Eigen::MatrixXd covariance = {};                 ///< of these, mm and rad; empty if not stated
  Eigen::MatrixXd noise_covariance = {};           ///< the part of it that comes from the noise of the readings
  double noise_dof = std::numeric_limits<double>::infinity();  ///< degrees of freedom that estimate that noise
  Eigen::VectorXd joint_std = {}, visit_std = {};              ///< as in Calibration, rad or mm
  std::vector<SoughtSource> drives = {};                       ///< likewise
  Eigen::MatrixXd drive_covariance = {};
  Eigen::VectorXd drive_sizes = {};    ///< empty: the machine is rigid
  OmittedPoses omitted_poses = {};     ///< that confirmed them
  CalibratedRegion region = {};        ///< unknown in files of before
  std::vector<InputFile> inputs = {};  ///< of the calibration
  ControllerModel controller = {};     ///< computed joints from its commanded poses

  /// Input of predictions; no parameters if no covariance is stated. With the drives, where they belong to the machine.
  KnownErrors known() const;
  /// Of the rigid machine.
  KnownErrors rigid() const;
};

/// @throws InputFileError for a file that is not an accepted calibration of `robot`.
CalibratedMachine read_calibration(const JsonFile& file, const Robot& robot);

/// An array of what `entry` makes of each of the values; of these themselves without it.
Json json_array(const auto& values, const auto& entry) {
  Json json = Json::array();
  for (const auto& value : values) json.push_back(entry(value));
  return json;
}
Json json_array(const auto& values) { return json_array(values, std::identity()); }

/// Rows of a matrix; numbers that are not finite become null.
Json rows_json(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

}  // namespace paracal::io
