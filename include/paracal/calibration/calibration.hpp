#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/calibration/calibrated_region.hpp"
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

/// What a machine does beyond its geometry, as expected before any reading: scales of half-Cauchy distributions of the
/// standard deviations, mm at the plate (root mean square over poses and coordinates), and of factors of tolerances, at
/// least 1.
/// Method best, fine stage, estimates each and averages over what the readings leave open.
struct Discrepancies {
  double visits = 0.001;    ///< each joint stops elsewhere at each visit: repeatability
  double poses = 0.0003;    ///< and elsewhere at each pose, the same at each visit: friction, load, backlash
  double drives = 0.01;     ///< of drives that are uneven along their stroke
  double length = 0.15;     ///< over which a drive's error changes, as a share of its stroke
  double tolerances = 0.3;  ///< mean logarithm of what parts of a group are over their tolerances
  /// The smooth errors of drives belong to the machine if with them omitted poses are predicted better by
  /// this share of the squares. Less is chance where drives are even, or what bends in another way.
  double least_gain_of_drives = 0.1;
};

/// From which size on something is a cause worth a name: sound machines and instruments differ by less.
struct CauseSizes {
  double error = 4.0;         ///< of a part, standard deviations of its tolerance: 1 in 16,000 sound ones is as far off
  double tolerances = 1.5;    ///< of a group, over those stated: less is hardly another tolerance
  double stated_noise = 1.2;  ///< over what was stated: makers round by a tenth
  double visits = 10.0;       ///< over what Discrepancies expect of visits: a joint that is loose, not one that is worn
  double poses = 0.5;         ///< over the noise of a visit: less does not show beside it
  double drives = 3.0;        ///< over what Discrepancies expect of drives
  double drives_over_noise = 2.0;  ///< and over the noise of a visit: less, a sound machine shows now and then
  /// Of a group, over those stated: a fit that keeps to such tolerances explains nothing, so they are widened first.
  /// One wrong part makes a group look up to so large.
  double far_too_small = 8.0;
  double other_machine = 30.0;  ///< likewise: beyond it, readings are of another machine or in another unit
};

struct CalibrationOptions {
  Method method = Method::best;
  Stage stage = Stage::automatic;
  NoiseModel noise = {};        ///< for readings that state no standard deviation
  bool noise_is_known = false;  ///< `noise` is a fact, not a first guess that the residuals correct
  Frame frame = Frame::unknown;
  BodyPlace body = BodyPlace::unknown;
  /// The reflector of points is at the plate's centre; false: anywhere on its mount.
  bool reflector_is_at_centre = true;
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
  Discrepancies discrepancies = {};  ///< by how much the machine may differ from its geometry
  double largest_doubt = 0.05;       ///< a cause is named if the probability of any other is smaller
  /// Noise that is not stated becomes a note if it is more than so many times `noise`: instruments differ by less.
  double noise_to_tell = 2.5;
  CauseSizes causes = {};
  double tell_chance = 1e-3;               ///< a test's result becomes a note if its p-value is below this
  AcceptanceLimits limits = {};            ///< of U over the workspace; above one the calibration is not accepted
  bool seeks_discrepancies = true;         ///< false: the machine is its geometry, as a controller's parameters have it
  bool states_use = true;                  ///< compute U over the workspace; batches of machines do not need it
  std::vector<SourceSelector> fixed = {};  ///< fixed at zero: known exactly
  std::vector<SourceSelector> free = {};   ///< estimated without a prior
  double outlier_chance = 1e-4;            ///< probability that a fit without outliers excludes a reading
  double largest_chance = 0.05;            ///< accept if the p-value of the improvement is smaller
  /// Accept up to so many times the noise that readings state: a worse instrument is broken, or was not read.
  double largest_noise_factor = 10.0;
  /// Likewise of `noise`, where readings state none: of points 1.7 mm, which a tape measure keeps.
  double largest_unstated_noise = 100.0;
  /// Accept if joints, drives and poses do at most this beside the geometry, over what errors within their tolerances
  /// do at the plate: where it is more, another machine explains the readings as well.
  double largest_absorbed = 0.5;
  /// Accept if no U over the workspace is more than so many times that of the uncalibrated machine. Drawn machines
  /// state U within 3 %.
  double largest_use_ratio = 1.1;
  bool exclude_outliers = true;  ///< method best: exclude outliers
  bool diagnose = true;          ///< for a doubtful fit, search for input mistakes (diagnosis.hpp)
  /// What commanded the joints of stations that state none. `robot`, where it is set, is the caller's to apply:
  /// commanded_by().
  ControllerModel controller = {};
};

/// A cubic B-spline over a joint coordinate: 2/3 at its centre, none beyond two spacings.
struct SplineKnot {
  double centre = 0.0, spacing = 1.0;  ///< rad or mm

  double at(double joint) const;
};

/// One geometric error that a fit estimates. Without a prior the readings alone decide.
struct SoughtSource {
  std::size_t limb = 0;  ///< from 0
  Source source = "theta_offset";
  std::optional<double> prior_std = {};  ///< mm or rad
  /// An error of the drive instead: its zero is off where this spline is above zero, and as far as it is.
  std::optional<SplineKnot> knot = {};
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
  /// The same error of the machine whose drives are uneven; empty where the machine is rigid.
  std::optional<double> with_drives = {};
  double data_share = 1.0;  ///< share of the information that the readings gave: 1 - std^2 / prior_std^2
  /// Degrees of freedom of std^2 (Welch and Satterthwaite, [gum, G.4]): those that estimate the noise over the square
  /// of the noise's share in std^2.
  double dof = std::numeric_limits<double>::infinity();
  bool held = false;  ///< not estimated: fixed at nominal; its tolerance is in every uncertainty

  /// The readings gave at least half of the information.
  bool identified() const { return !held && data_share >= 0.5; }
  /// k of U = k std, about 95 %.
  double coverage() const { return coverage_factor(dof); }
};

/// What does not do as the model has it.
enum class Cause : std::uint8_t {
  visits,     ///< joints that stop elsewhere at each visit
  motion,     ///< joints that stop elsewhere at each pose, or drives that are uneven
  parts,      ///< errors outside their tolerances
  pose,       ///< a pose that was not what was commanded
  noise,      ///< an instrument whose noise is not as stated
  reflector,  ///< a reflector beside the axis or the centre that it was put on
  drift,      ///< of parts or of an instrument, along the order of the readings
  backlash,   ///< joints that stop on the side from which they came
};

/// A cause of what noise, tolerances and the exact geometry do not explain. No uncertainty depends on its name.
struct Component {
  Cause cause = Cause::motion;
  std::string text;          ///< a sentence with its size
  double probability = 0.0;  ///< after the readings
  bool told = false;         ///< certain enough for a note
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

/// How well readings of a pose are predicted from those of all other poses: root mean square, mm.
struct OmittedPoses {
  double rigid = 0.0, with_drives = 0.0;  ///< without and with the smooth errors of drives
  std::size_t poses = 0;                  ///< that were omitted, one by one

  /// Share by which the squares are smaller with drives.
  double gain() const { return 1.0 - (with_drives * with_drives) / (rigid * rigid); }
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

/// What a fit did, and what its readings determine.
struct FitSummary {
  std::vector<StageReport> stages = {};
  int rank = 0;  ///< of the position group (and of the tilt group where tilt was measured)
  std::vector<NullDirection> null_space = {};
  std::size_t readings = 0;  ///< how many there were; more than 20,000 are not listed one by one in FitResiduals
  int degrees_of_freedom = 0;
  /// Root of the weighted residual sum over the degrees of freedom: 1 when the readings scatter as their sigmas say.
  std::optional<double> unit_weight_std = {};
  /// Probability that good readings scatter more than these, where their sigmas are known (chi-square).
  std::optional<double> fit_probability = {};
};

/// Setups of the instruments, found with the errors.
struct FoundSetUps {
  std::vector<SeriesFrame> frames = {};
  std::vector<FoundSetUp> set_ups = {};          ///< of lengths
  std::optional<double> distance_bias = {};      ///< found in all distances alike, measured - true, mm
  std::optional<double> distance_bias_std = {};  ///< mm; U = 2 std, Student's k included
};

/// The readings against the nominal and the calibrated machine.
struct FitResiduals {
  PoseErrorSummary before = {}, after = {};
  std::vector<DistanceResidual> distances = {};
  std::vector<PointResidual> points = {};
  std::vector<LengthResidual> lengths = {};
  std::vector<Suspect> suspects = {};  ///< worst first; of more than 20,000: the excluded and the 100 worst
  /// Standard deviation of a coordinate (of a distance where no points were read), mm, root mean square over the
  /// readings: stated, or as the residuals say.
  double noise = 0.0;
  /// The same of an orientation about each axis, rad; empty where none was read.
  std::optional<double> orientation_noise = {};
  /// Probability that noise alone would have improved the fit this much; small is good.
  std::optional<double> chance = {};
};

/// What is known of the machine after the readings.
struct Posterior {
  SourceErrors expected = {};  ///< before any reading: errors that are no parameters
  std::vector<ParameterEstimate> parameters = {};
  Eigen::MatrixXd covariance = {};        ///< of the parameters, mm and rad; empty where no std could be stated
  Eigen::MatrixXd noise_covariance = {};  ///< the part of it that comes from the noise of the readings
  /// Degrees of freedom that estimate the noise; infinite where it is known.
  double noise_dof = std::numeric_limits<double>::infinity();
  /// Standard deviation of what each joint is off at each pose, the same at each visit, rad or mm; empty: not
  /// estimated.
  Eigen::VectorXd joint_std = {};
  Eigen::VectorXd visit_std = {};         ///< likewise, anew at each visit: repeatability
  std::vector<SoughtSource> drives = {};  ///< how drives may be uneven: splines along each joint
  /// Mean squares of the splines' sizes, mm and rad, with the parameters' errors and among themselves: a row each.
  Eigen::MatrixXd drive_covariance = {};
  /// Sizes of the splines, rad or mm, where they belong to the machine; empty: it is rigid, and the mean squares hold
  /// all that is known of them.
  Eigen::VectorXd drive_sizes = {};
  std::optional<OmittedPoses> omitted_poses = {};  ///< by which that was decided; empty: it could not be
  CalibratedRegion region = {};                    ///< of the poses whose readings count
  std::vector<Component> components = {};          ///< causes, the most probable first

  /// The source errors of all limbs of a rigid machine; those not identified are as expected.
  SourceErrors errors() const;
};

/// Uncertainty over the workspace.
struct WorkspaceUse {
  std::optional<Use> use = {};       ///< of any single visit; empty where no covariance could be stated
  std::optional<Use> use_mean = {};  ///< of the mean of many visits
};

struct Outcome {
  Verdict verdict = Verdict::not_converged;
  std::vector<std::string> reasons = {};  ///< why it was not accepted; empty when it was

  bool accepted() const { return verdict == Verdict::accepted; }
};

struct Remarks {
  std::vector<std::string> notes = {};    ///< on the result
  std::vector<std::string> assumed = {};  ///< values (not read and not stated)
};

/// The machine's identified source errors with their evidence: enough to use them, to doubt them, and to repeat the
/// fit. Made of parts; each is the result of one function, and what follows from it reads that part alone.
struct [[nodiscard]] Calibration : FitSummary, FoundSetUps, FitResiduals, Posterior, WorkspaceUse, Outcome, Remarks {
  Robot robot;
  CalibrationOptions options = {};
  std::vector<InputFile> files = {};

  /// Pairs of parameters (by their places) whose estimates go together: |correlation| at least `threshold`, strongest
  /// first. What belongs to one of such a pair and what to the other, the readings hardly tell.
  struct Correlation {
    std::size_t one = 0, other = 0;
    double value = 0.0;
  };
  std::vector<Correlation> correlations(double threshold = 0.9) const;

  /// A few lines for a person: verdict, parameters, residuals.
  std::string brief() const;
};

/// "accepted", "rejected", "not identifiable", "not converged".
std::string_view name(Verdict verdict);

}  // namespace paracal
