#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// ISO 9283 criteria of one pose from repeats; distances are from home's barycentre, so AD and RD of home are 0
/// [iso9283, clauses 7.2.1, 7.2.2, 7.3]; mm and rad.
struct PoseCriteria {
  std::string pose;
  int repeats = 0;
  double AP = 0.0;  ///< positioning accuracy: distance from the commanded position to the barycentre of the repeats
  double RP = 0.0;  ///< positioning repeatability: mean distance from the barycentre + 3 standard deviations of it
  double AD = 0.0;  ///< distance accuracy: |mean measured distance to home - commanded distance|
  double RD = 0.0;  ///< distance repeatability: 3 standard deviations of that distance
  std::optional<double> AP_rotation = {};  ///< |mean measured - commanded rotation|
  std::optional<double> RP_rotation = {};  ///< 3 standard deviations of the rotation
};

struct Iso9283 {
  std::vector<PoseCriteria> poses;  ///< those with at least two repeats
  double max_AP = 0.0, max_RP = 0.0, max_AD = 0.0, max_RD = 0.0;
};

enum class Conformity : std::uint8_t {
  conforming,      ///< error + U <= limit: proven within  [iso14253-1]
  not_conforming,  ///< at least so large that the limit is broken: proven beyond
  undecided,       ///< the measurement is too uncertain to prove either
};

/// One largest error against its limit, with the expanded uncertainty U of its measurement: about 95 %. Its coverage
/// factor is 2 where the noise is stated, Student's where repeated visits tell it  [gum, G.4].
///
/// The largest of n errors t_i that are read as x_i is, with 95 % either,
///
///   max |t_i| <= max |x_i| + U,    max |t_i| >= max |x_i| - V,    P(|x_i - t_i| <= V for all i) >= 95 %
///
/// since the noise lifts some of many errors; V by the Gaussian correlation inequality  [royen2014] from the
/// distribution of one: normal, or of three coordinates chi-square, or Student's and Fisher's.
struct LimitCheck {
  std::string quantity;
  double error = 0.0, uncertainty = 0.0;  ///< mm or rad
  double at_least = 0.0;                  ///< max |x_i| - V, or 0
  double coverage = 2.0;                  ///< the factor in `uncertainty`
  double limit = 0.0;                     ///< mm or rad
  Conformity conformity = Conformity::undecided;
};

struct ValidationOptions {
  NoiseModel noise = {};
  bool noise_is_known = false;  ///< `noise` is known; otherwise only a sigma stated with a reading counts as known
  bool rotation_noise_is_known = false;  ///< the same for `noise.rotation`, when checking a limit on rotations
  double scale_std = CalibrationOptions{}.scale_std;  ///< of the readings' scale against the machine, m/m
  ReflectorMount reflectors = ReflectorMount::plate;
  Frame frame = Frame::unknown;
  BodyPlace body = BodyPlace::unknown;
  RotationZero rotation_zero = RotationZero::unknown;
  AcceptanceLimits limits = {};
  ControllerModel controller = {};  ///< as CalibrationOptions::controller
};

/// One validated pose, in the robot's frame: home is the first.
struct ValidatedPose {
  std::string series, pose;
  PosePair before;                           ///< commanded, measured
  PosePair after;                            ///< as the calibrated machine predicts it, measured
  bool rotation = false;                     ///< phi was read
  std::optional<PoseCovariance> covariance;  ///< of the prediction
};

/// A reading of one number (a distance, a length) against the nominal and the calibrated machine: measured minus
/// predicted, after fitting the setup.
struct CheckedReading {
  std::string text;                  ///< "distance P1 - P3"
  double before = 0.0, after = 0.0;  ///< mm
  double sigma = 0.0;                ///< standard deviation of the reading, mm
  /// Of `after`, mm (k = 2), from the reading, the calibration and the joint errors: 95 % of correct machines
  /// have a smaller residual after fitting the setup.
  double U = 0.0;
  std::optional<LengthKind> length = {};  ///< kind of length; empty: a distance
};

/// Test whether readings agree with the uncertainty of the calibration and their own noise. With residuals
/// v = J_n a + J z + n, setup a, errors z ~ N(0, C) relative to the calibrated ones, and joint errors at each pose,
///
///   \f[ chi^2 = min_{a,z} |v - J_n a - J z|^2 + z^T C^-1 z \f]
///
/// is chi-square distributed with `freedom` degrees of freedom if C and the noise are as stated. If repeated visits
/// estimate the noise with `noise_dof` degrees of freedom, their sum and degrees of freedom are subtracted from both.
/// The rest over its degrees of freedom is Fisher distributed: a test of lack of fit.
struct Agreement {
  double chi_square = 0.0, freedom = 0.0;
  double noise_dof = std::numeric_limits<double>::infinity();
  double chance = 1.0;  ///< p-value

  /// The readings do not agree with the calibration: p-value below 0.001.
  bool contradicts() const { return chance < 1e-3; }
};

struct [[nodiscard]] Validation {
  PoseErrorSummary before, after;
  std::vector<ValidatedPose> poses;
  std::vector<CheckedReading> readings;  ///< distances and lengths
  /// Empty if it cannot be tested: the calibration has no covariance, or the noise is not stated and not
  /// visible in repeats.
  std::optional<Agreement> agreement;
  Iso9283 iso9283;
  std::vector<LimitCheck> checks;  ///< of the errors after calibration
  /// Whether all limits are met, uncertainty included. Empty without limits: figures and no verdict.
  std::optional<bool> accepted = {};
  /// Why it is not accepted. Without limits, what speaks against the calibration: the readings do not agree with it, or
  /// the largest aligned error (distance or length error without points) did not decrease by more than its uncertainty.
  std::vector<std::string> reasons;
  std::vector<std::string> notes;         ///< remarks on the result
  std::vector<std::string> assumed = {};  ///< assumed values (not read and not stated)

  void refuse(std::string reason) {
    reasons.push_back(std::move(reason));
    if (accepted) accepted = false;
  }
};

/// Checks a calibration against measurements it has not used.
///
/// The frame of a series is unknown as a rule. It is found by fitting the measured points to the poses that the
/// calibrated machine predicts from the commanded joints; in this frame "before" compares measured with commanded and
/// "after" measured with predicted poses, both relative to home (d_rho, d_v, d_phi of pose_error.hpp). The aligned
/// errors remove the best rigid motion from each comparison on its own, so they do not depend on that frame.
///
/// @throws InvalidArgument for measurements that make no sense, a series of points with fewer than 4 poses, or no more
/// readings than unknowns of their setup; Unreachable as calibrate().
Validation validate(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                    const ValidationOptions& options = {});

std::string_view name(Conformity conformity);

}  // namespace paracal
