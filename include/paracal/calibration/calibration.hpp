#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/calibration/controller_model.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/noise.hpp"
#include "paracal/calibration/pose_error.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"
#include "paracal/numerics/rigid_fit.hpp"

namespace paracal {

enum class Method : std::uint8_t {
  paper,  ///< [huang2016, Eqs. (16)-(21)]: unweighted distances of all pairs of points, pseudo-inverse, no priors
  best,   ///< every reading with its own covariance, exact model, priors from the tolerances
};

enum class Stage : std::uint8_t {
  rough,      ///< the encoder offsets alone
  fine,       ///< encoder offsets first, then everything
  automatic,  ///< fine where the readings carry it and leave some to check it with, else rough
};

/// Frame of measured points.
enum class Frame : std::uint8_t {
  unknown,  ///< any rigid motion away from the robot's, another one for each series
  robot,
};

/// Where a body sits whose poses are measured.
enum class BodyPlace : std::uint8_t {
  unknown,  ///< anywhere on what carries it, turned anyhow
  plate,    ///< in the plate's own frame
};

/// Zero of a rotary encoder that reads phi.
enum class RotationZero : std::uint8_t { unknown, known };

/// What the second reflector, or a body, is mounted on.
enum class ReflectorMount : std::uint8_t {
  plate,                  ///< tilts with the plate
  end_effector,           ///< tilts with the plate and turns with phi, counter-clockwise seen from above
  end_effector_reversed,  ///< likewise, but turns by -phi
};

/// Angle by which the mount turns about the plate's normal, over phi.
constexpr double turns_per_phi(ReflectorMount mount) {
  if (mount == ReflectorMount::plate) return 0.0;
  return mount == ReflectorMount::end_effector ? 1.0 : -1.0;
}

inline constexpr std::array<ReflectorMount, 3> kReflectorMounts{ReflectorMount::plate, ReflectorMount::end_effector,
                                                                ReflectorMount::end_effector_reversed};

/// "plate", "end-effector", "end-effector-reversed": in options and JSON.
std::string_view name(ReflectorMount mount);

/// A source error of one limb, or of all limbs.
struct SourceSelector {
  Source source = "theta_offset";
  std::optional<std::size_t> limb = {};  ///< from 0; empty: all

  bool matches(std::size_t of_limb, Source of_source) const {
    return source == of_source && limb.value_or(of_limb) == of_limb;
  }
};

/// An error that all limbs share, besides the tolerance of each: the length to which a lot of rods was cut, the radius
/// that a base was bored to.
struct CommonError {
  std::string text;
  SourceErrors direction;  ///< per mm
  double std = 0.0;        ///< mm
};

/// Limits for acceptance; empty: no limit.
struct AcceptanceLimits {
  std::optional<double> distance = {};    ///< of |d_rho|, mm
  std::optional<double> volumetric = {};  ///< of aligned |dr|, mm
  std::optional<double> rotation = {};    ///< of |d_phi|, rad

  bool any() const { return distance || volumetric || rotation; }
};

struct CalibrationOptions {
  Method method = Method::best;
  Stage stage = Stage::automatic;
  NoiseModel noise = {};        ///< for readings that state no standard deviation
  bool noise_is_known = false;  ///< `noise` is a fact, not a first guess that the residuals correct
  Frame frame = Frame::unknown;
  BodyPlace body = BodyPlace::unknown;
  RotationZero rotation_zero = RotationZero::unknown;
  ReflectorMount reflectors = ReflectorMount::plate;
  std::optional<Tolerances> tolerances = {};  ///< priors; default: the robot's, or generous_tolerances()
  std::vector<CommonError> common = {};       ///< priors that the limbs have together
  /// What the source errors are before any reading: the centre of their tolerances. Not zero where the controller holds
  /// other numbers than the drawing. Mistakes are not diagnosed (`diagnose`) then.
  std::optional<SourceErrors> expected = {};
  /// Standard deviation of the slopes of planes that heights are read above, against the robot's own level, rad; empty:
  /// any.
  std::optional<double> plane_slope = {};
  /// Standard deviation of the curvature of what heights are read above, a paraboloid then, 1/mm; empty: a plane.
  std::optional<double> plane_curvature = {};
  /// Standard deviation of the scale of the readings against the machine, m/m; 0: none. 15 ppm: 1.3 K of steel, 0.65 K
  /// of aluminium.
  double scale_std = 1.5e-5;
  /// A component of variance (see Component) enters the uncertainty if -2 log likelihood drops by this much more
  /// than expected from the number of components tried. 4: one machine in 50 without any gets one.
  double admit_drop = 4.0;
  double tell_chance = 1e-3;               ///< it becomes a note if its p-value is below this
  AcceptanceLimits limits = {};            ///< of U over the workspace; above one the calibration is not accepted
  bool states_use = true;                  ///< compute U over the workspace; batches of machines do not need it
  std::vector<SourceSelector> fixed = {};  ///< fixed at zero: known exactly
  std::vector<SourceSelector> free = {};   ///< estimated without a prior
  bool exclude_outliers = true;            ///< method best: exclude outliers
  double outlier_chance = 1e-4;            ///< probability that a fit without outliers excludes a reading
  double largest_chance = 0.05;            ///< accept if the p-value of the improvement is smaller
  bool diagnose = true;                    ///< for a doubtful fit, search for input mistakes (diagnosis.hpp)
  /// What commanded the joints of stations that state none. `robot`, where it is set, is the caller's to apply:
  /// commanded_by().
  ControllerModel controller = {};
};

/// One geometric error that a fit estimates. Without a prior the readings alone decide.
struct SoughtSource {
  std::size_t limb = 0;  ///< from 0
  Source source = "theta_offset";
  std::optional<double> prior_std = {};  ///< mm or rad
};

enum class Verdict : std::uint8_t {
  accepted,          ///< use it
  rejected,          ///< converged, but the data do not support it; see Calibration::reasons
  not_identifiable,  ///< the readings do not determine the parameters asked for; the undetermined directions stayed at
                     ///< zero
  not_converged,     ///< the fit did not settle; parameters are the best found and must not be used
};

/// Coverage factor of an expanded uncertainty U = k std whose std is known  [gum, 6.2].
inline constexpr double kCoverageFactor = 2.0;

/// Coverage factor where `dof` degrees of freedom estimate the std: Student's t for 95.45 %, 2 when they are many
/// [gum, G.3].
double coverage_factor(double dof);

/// One identified source error.
struct ParameterEstimate {
  std::size_t limb = 0;  ///< from 0
  Source source = "theta_offset";
  double value = 0.0;                    ///< actual - nominal, mm or rad
  std::optional<double> std = {};        ///< standard deviation, mm or rad; empty where the readings cannot tell
  std::optional<double> prior_std = {};  ///< before the readings, from the tolerances; empty: no prior
  double expected = 0.0;                 ///< before the readings, mm or rad
  double data_share = 1.0;               ///< share of the information that the readings gave: 1 - std^2 / prior_std^2
  /// Degrees of freedom of std^2 (Welch and Satterthwaite, [gum, G.4]): those that estimate the noise over the square
  /// of the noise's share in std^2.
  double dof = std::numeric_limits<double>::infinity();
  bool held = false;  ///< not estimated: fixed at nominal; its tolerance is in every uncertainty

  /// The readings gave at least half of the information.
  bool identified() const { return !held && data_share >= 0.5; }
  /// k of U = k std, about 95 %.
  double coverage() const { return coverage_factor(dof); }
};

/// A variance that the readings themselves show: what the noise, the tolerances and the exact model do not explain.
struct Component {
  std::string text;     ///< a sentence with its size
  double factor = 1.0;  ///< of the standard deviations that it widens; of joints: their standard deviation, rad or mm
  double drop = 0.0;    ///< of -2 log likelihood, less what the number of components tried costs
  double chance = 1.0;  ///< p-value
  bool told = false;    ///< certain enough for a note
};

/// U of one quantity over the workspace: 95 % of such machines have smaller errors everywhere.
struct UseQuantity {
  double U = 0.0;  ///< mm or rad
  std::optional<double> limit = {};

  bool kept() const { return !limit || U <= *limit; }
};

/// Uncertainty of the calibrated machine over its workspace: distances to home, positions after the best alignment,
/// rotations relative to home.
struct Use {
  UseQuantity distance, aligned;
  std::optional<UseQuantity> rotation = {};
};

/// A direction of the parameters that the readings do not determine.
struct NullDirection {
  std::string text;
  Eigen::VectorXd direction;  ///< unit, in the order of the parameters
  bool gauge = false;         ///< a motion of the whole robot or the slide zero: no reading of this kind determines it
};

/// A distance against the nominal and the calibrated machine: measured minus predicted.
struct DistanceResidual {
  std::string from, to;
  double distance = 0.0;                                            ///< measured, mm
  double distance_before = 0.0, distance_after = 0.0;               ///< mm
  std::optional<double> rotation, rotation_before, rotation_after;  ///< rad
  bool excluded = false;
};

/// A point likewise, in the robot's frame as either machine fits it best.
struct PointResidual {
  std::string series, station;
  Eigen::Vector3d before, after;                          ///< mm
  std::optional<double> rotation_before, rotation_after;  ///< rad
  bool excluded = false;
  std::optional<Eigen::Vector3d> orientation_before = {}, orientation_after = {};  ///< rotation vectors, rad
};

/// A length likewise, its setup as either machine fits it best.
struct LengthResidual {
  std::string series, station;
  LengthKind kind = LengthKind::height;
  double length = 0.0;               ///< measured, mm
  double before = 0.0, after = 0.0;  ///< mm
  bool excluded = false;
};

/// How much a reading differs from all others. `statistic` is the drop of the weighted residual sum when the reading is
/// excluded, over its number of rows and the scatter of the rest: about 1 for a good one.
struct Suspect {
  std::string text;
  double statistic = 0.0;
  double chance = 1.0;  ///< that the worst of as many good readings looks like this
  bool excluded = false;
};

/// Estimated setup of a series of lengths, in the robot's frame: of heights the plane below them,
/// z = height + slope_x x + slope_y y, and + curvature (x^2 + y^2) where estimated.
struct FoundSetUp {
  std::string name;
  LengthKind kind = LengthKind::height;
  Eigen::VectorXd unknowns = {};  ///< mm and rad: height, slope_x, slope_y; 1/mm: curvature
  /// Of these: with themselves, then with the estimated parameters; U = 2 std, as by
  /// KnownErrors::expanded_covariance(). Empty where none could be stated.
  Eigen::MatrixXd covariance = {};
  std::vector<std::pair<std::string_view, double>> told = {};  ///< by the names and in the units of files
};

/// What one stage of the fit did.
struct StageReport {
  std::string name;
  int iterations = 0;
  bool converged = false;
  int rank = 0;
  double condition = 0.0;     ///< largest over smallest singular value of the column-scaled Jacobian
  double rms_distance = 0.0;  ///< of distances to home, or of the distances read, after the stage, mm
};

/// Where an instrument stood, and the rest of its setup.
struct SeriesFrame {
  std::string name;
  RigidMotion frame;                           ///< instrument = frame(robot)
  std::optional<double> rotation_zero = {};    ///< encoder reading = phi - zero, rad
  std::optional<Eigen::Vector3d> second = {};  ///< second reflector from the first, mm, in the plate's frame
  std::optional<RigidMotion> body = {};        ///< plate = body(body), mm
};

/// The machine's identified source errors with their evidence: enough to use them, to doubt them, and to repeat the
/// fit.
struct [[nodiscard]] Calibration {
  Robot robot;
  Verdict verdict = Verdict::not_converged;
  std::vector<std::string> reasons = {};  ///< why it was not accepted; empty when it was
  std::vector<std::string> notes = {};    ///< remarks on the result
  std::vector<std::string> assumed = {};  ///< assumed values (not read and not stated)
  std::vector<ParameterEstimate> parameters = {};
  Eigen::MatrixXd covariance = {};        ///< of the parameters, mm and rad; empty where no std could be stated
  Eigen::MatrixXd noise_covariance = {};  ///< the part of it that comes from the noise of the readings
  /// Degrees of freedom that estimate the noise; infinite where it is known.
  double noise_dof = std::numeric_limits<double>::infinity();
  /// Standard deviation of the joint errors, independent at each pose, rad or mm.
  double joint_std = 0.0;
  std::vector<Component> components = {};  ///< in the order in which they were found
  std::optional<Use> use = {};             ///< empty where no covariance could be stated
  int rank = 0;                            ///< of the position group (and of the tilt group where tilt was measured)
  std::vector<NullDirection> null_space = {};
  std::vector<StageReport> stages = {};
  PoseErrorSummary before = {}, after = {};
  std::size_t readings = 0;  ///< how many there were; more than 20,000 are not listed one by one below
  std::vector<DistanceResidual> distances = {};
  std::vector<PointResidual> points = {};
  std::vector<LengthResidual> lengths = {};
  std::vector<Suspect> suspects = {};  ///< worst first; of more than 20,000: the excluded and the 100 worst
  std::vector<SeriesFrame> frames = {};
  std::vector<FoundSetUp> set_ups = {};          ///< of lengths
  std::optional<double> distance_bias = {};      ///< found in all distances alike, measured - true, mm
  std::optional<double> distance_bias_std = {};  ///< mm; U = 2 std, Student's k included
  int degrees_of_freedom = 0;
  /// Root of the weighted residual sum over the degrees of freedom: 1 when the readings scatter as their sigmas say.
  std::optional<double> unit_weight_std = {};
  /// Probability that good readings scatter more than these, where their sigmas are known (chi-square).
  std::optional<double> fit_probability = {};
  /// Standard deviation of a coordinate (of a distance where no points were read), mm, root mean square over the
  /// readings: stated, or as the residuals say.
  double noise = 0.0;
  /// The same of an orientation about each axis, rad; empty where none was read.
  std::optional<double> orientation_noise = {};
  /// Probability that noise alone would have improved the fit this much; small is good.
  std::optional<double> chance = {};
  CalibrationOptions options = {};
  std::vector<InputFile> files = {};

  /// Pairs of parameters (by their places) whose estimates go together: |correlation| at least `threshold`, strongest
  /// first. What belongs to one of such a pair and what to the other, the readings hardly tell.
  struct Correlation {
    std::size_t one = 0, other = 0;
    double value = 0.0;
  };
  std::vector<Correlation> correlations(double threshold = 0.9) const;

  bool accepted() const { return verdict == Verdict::accepted; }
  /// The source errors of all limbs; those not identified are zero.
  SourceErrors errors() const;
  /// A few lines for a person: verdict, parameters, residuals.
  std::string brief() const;
};

/// "accepted", "rejected", "not identifiable", "not converged".
std::string_view name(Verdict verdict);

}  // namespace paracal
