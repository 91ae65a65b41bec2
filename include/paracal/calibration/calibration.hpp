#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"
#include "paracal/units.hpp"

namespace paracal {

/// Standard deviations that weigh readings which state none of their own.
struct CalibrationOptions {
  double distance_sigma = 0.05;             ///< mm: positioning repeatability in [huang2016, section 5]
  double rotation_sigma = to_radians(0.3);  ///< rad: rotational repeatability (0.3 deg) in the same section
  double largest_chance = 0.05;  ///< accept when noise alone improves the fit this much with less probability
};

enum class Verdict : std::uint8_t {
  accepted,          ///< use it
  rejected,          ///< converged, but the data do not support it; see Calibration::reasons
  not_identifiable,  ///< the readings do not determine the parameters asked for; the undetermined directions stayed at
                     ///< zero
  not_converged,     ///< the fit did not settle; parameters are the best found and must not be used
};

/// One identified source error.
struct ParameterEstimate {
  std::size_t limb = 0;  ///< from 0
  Source source = Source::theta_offset;
  double value = 0.0;              ///< actual - nominal, mm or rad
  std::optional<double> std = {};  ///< standard deviation, mm or rad; empty where the readings cannot tell
};

/// A direction of the parameters that the readings do not see.
struct NullDirection {
  std::string text;
  Eigen::VectorXd direction;  ///< unit, in the order of the parameters
};

/// One reading against the nominal and the calibrated machine: measured minus predicted.
struct ReadingResidual {
  std::string from, to;
  double distance = 0.0;                                            ///< measured, mm
  double distance_before = 0.0, distance_after = 0.0;               ///< mm
  std::optional<double> rotation, rotation_before, rotation_after;  ///< rad
};

/// Largest and root-mean-square residuals over the readings.
struct ResidualSummary {
  double max_abs_distance = 0.0, rms_distance = 0.0;  ///< mm
  std::optional<double> max_abs_rotation;             ///< rad
};

/// What one stage of the fit did.
struct StageReport {
  std::string name;
  int iterations = 0;
  bool converged = false;
  int rank = 0;
  double condition = 0.0;     ///< largest over smallest singular value of the column-scaled Jacobian
  double rms_distance = 0.0;  ///< after the stage, mm
};

/// The machine's identified source errors with their evidence: enough to use them, to doubt them, and to repeat the
/// fit.
struct [[nodiscard]] Calibration {
  Robot robot;
  Verdict verdict = Verdict::not_converged;
  std::vector<std::string> reasons = {};  ///< why it was not accepted; empty when it was
  std::vector<ParameterEstimate> parameters = {};
  Eigen::MatrixXd covariance = {};  ///< of the parameters, mm and rad; empty where no std could be stated
  int rank = 0;
  std::vector<NullDirection> null_space = {};
  std::vector<StageReport> stages = {};
  ResidualSummary before = {}, after = {};
  std::vector<ReadingResidual> residuals = {};
  int degrees_of_freedom = 0;
  /// Root of the weighted residual sum over the degrees of freedom: 1 when the readings scatter as their sigmas say.
  std::optional<double> unit_weight_std = {};
  /// Probability that noise alone would have improved the fit this much; small is good.
  std::optional<double> chance = {};
  CalibrationOptions options = {};
  std::vector<InputFile> files = {};

  bool accepted() const { return verdict == Verdict::accepted; }
  /// The source errors of all limbs; those not identified are zero.
  SourceErrors errors() const;
  /// A few lines for a person: verdict, parameters, residuals.
  std::string brief() const;
};

/// "accepted", "rejected", "not identifiable", "not converged".
std::string_view name(Verdict verdict);

}  // namespace paracal
