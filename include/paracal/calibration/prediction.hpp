#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/kinematics/closure.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/drive_curve.hpp"
#include "paracal/mechanism/machine.hpp"

namespace paracal {

/// How far each joint is from where its drive says: s(q) = sum of the splines of its limb.
class DriveCurves {
 public:
  DriveCurves() = default;
  /// @param sizes  of the knots among the parameters, which stand last; empty: drives are even.
  /// @throws InvalidArgument where there is a complaint().
  DriveCurves(const std::vector<SoughtSource>& parameters, const Eigen::VectorXd& sizes);

  /// Empty where each joint has at most kDriveKnots equally spaced knots, and errors that change by less than
  /// kSteepestDrive of the way.
  static std::optional<std::string> complaint(const std::vector<SoughtSource>& parameters,
                                              const Eigen::VectorXd& sizes);

  bool are_even() const { return curves_.empty(); }
  DriveCurve<double> of(std::size_t limb) const { return limb < curves_.size() ? curves_[limb] : DriveCurve<double>(); }
  double off(std::size_t limb, double joint) const { return of(limb).off(joint); }
  /// q + s(q): where the joints are that are commanded to q.
  Joints actual(const Joints& commanded) const;
  /// q with q + s(q) = actual.
  Joints commanded(const Joints& actual) const;

 private:
  std::optional<std::string> take(const std::vector<SoughtSource>& parameters, const Eigen::VectorXd& sizes);

  std::vector<DriveCurve<double>> curves_ = {};  ///< of each limb
};

/// Source errors known with a covariance: what predictions are made from. Built from a Calibration, a calibration file,
/// or a plan.
struct KnownErrors {
  SourceErrors errors;
  std::vector<SoughtSource> parameters;   ///< then the splines of drives; of rigid machines these have mean squares
  Eigen::MatrixXd covariance;             ///< of the parameters, mm and rad
  Eigen::MatrixXd noise_covariance = {};  ///< the part of it that comes from the noise of the readings
  double noise_dof = std::numeric_limits<double>::infinity();  ///< degrees of freedom that estimate that noise
  /// Of what each joint is off at each pose, the same at each visit, and anew at each visit, rad or mm; empty: none.
  Eigen::VectorXd joint_std = {}, visit_std = {};
  Eigen::VectorXd drive_sizes = {};  ///< of the splines, rad or mm; empty: the machine is rigid
  CalibratedRegion region = {};      ///< beyond it predictions extrapolate

  DriveCurves drives() const { return {parameters, drive_sizes}; }
  /// C + ((k / 2)^2 - 1) C_noise: U = 2 std by this covariance. Student's k for the degrees of freedom multiplies the
  /// noise's part alone, for tolerances and what is known need none; a little more than Welch and Satterthwaite state.
  Eigen::MatrixXd expanded_covariance() const;
  /// The same for a single visit of a pose, where a joint error acts as an error of its zero.
  Eigen::MatrixXd pose_covariance() const;
  /// Standard deviations of the joints at a single visit; of the mean of many visits: joint_std.
  Eigen::VectorXd joint_std_of_a_visit() const;
};

/// Of the machine with its drives where they belong to it (Posterior::drive_sizes), else of the rigid one.
KnownErrors known_errors(const Posterior& posterior);
/// Of the rigid machine: its drives, where they are uneven, are a part of its uncertainty.
KnownErrors rigid_errors(const Posterior& posterior);

/// Adds the splines of drives behind the parameters (Posterior::drives, drive_covariance).
void add_drives(const std::vector<SoughtSource>& drives, const Eigen::MatrixXd& covariance, KnownErrors& known);

/// Gives a rigid machine with the splines of its drives their sizes, and the errors that go with them. With d from the
/// rigid machine to this one, mean squares C_rigid about the one are variances C_rigid - d d^T about the other, if the
/// machine is as its splines say. omitted poses confirm a share g of that, OmittedPoses::gain(), and the rest stays:
///
///   \f[ C = C_{rigid} - g d d^T \f]
///
/// @param with_drives  errors of the parameters, splines apart.
KnownErrors with_drives(KnownErrors rigid, const Eigen::VectorXd& with_drives, const Eigen::VectorXd& sizes,
                        double gain);

/// The same readings at the joints where drives really are.
Measurements at_actual_joints(const Robot& robot, const DriveCurves& drives, Measurements measurements);

/// What planned readings would determine of a machine whose errors are within their tolerances: zero errors with the
/// covariance after measuring as planned. Readings that state no sigma weigh as options.noise says.
/// @throws as calibrate().
KnownErrors promised(const Robot& robot, const Measurements& given, const CalibrationOptions& options = {});

/// How a plate moves: position (mm), phi (rad), tilt_x, tilt_y, tilt_z (rad), a column for each cause.
using PlateMotions = Eigen::Matrix<double, 7, Eigen::Dynamic>;

/// d(x, y, z, phi, tilt) / d(parameters) of a plate that stands there with these joints, mm and rad. No columns where
/// the machine is singular.
PlateMotions plate_jacobian(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints,
                            const std::vector<SoughtSource>& parameters);

/// Its rows of what is commanded, d(x, y, z, phi) / d(parameters), with six degrees of freedom d(x, y, z,
/// tilt), at joints. Empty where the machine is singular.
Eigen::MatrixXd pose_jacobian(const DifferentiableMachine& machine, const Joints& joints,
                              const std::vector<SoughtSource>& parameters);

/// U of poses of one machine. What is alike at all poses is found once, so that a pose takes a few microseconds.
class PlateUncertainty {
 public:
  /// @param parameters  errors and knots of drives' splines, in the order of the covariance.
  /// @param covariance  KnownErrors::pose_covariance, mm and rad; empty: none is known.
  PlateUncertainty(DifferentiableMachine machine, const std::vector<SoughtSource>& parameters,
                   const Eigen::MatrixXd& covariance);

  /// U = 2 std (about 95 %) of what is commanded, for a plate that stands there with these joints: x, y, z (mm) and
  /// phi (rad), 0 without a slide; with six degrees of freedom x, y, z and tilt (rad).
  ///
  ///   \f[ var = diag(G C G^T) \f]
  ///
  /// with G by the errors and by the drives' splines at these joints. Empty where no covariance is known, or the
  /// machine is singular.
  std::optional<Eigen::VectorXd> at(const PlateState& plate, const Joints& joints) const;

 private:
  /// Splines of a limb's drive. Their knots are those of knots_, one limb after the other.
  struct Drive {
    Eigen::Index limb = 0, zero = 0;  ///< and the column of its joint's zero in an ExactJacobian
    std::vector<SplineKnot> knots;
  };
  template <int Rows>
  Eigen::VectorXd variances_at(const ExactJacobian& exact, const Joints& joints) const;

  DifferentiableMachine machine_;
  std::vector<Eigen::Index> columns_;  ///< of the errors in an ExactJacobian
  std::vector<Drive> drives_;
  Eigen::MatrixXd errors_, knots_by_errors_, knots_;  ///< parts of the covariance
};

/// Uncertainties of a calibrated machine at any single visit, and of the mean of many.
struct UseOfVisits {
  Use any, mean;
  std::optional<Use> uncalibrated = {};  ///< of the same machine before, where its tolerances are given
};

/// Over the workspace_stations().
/// @param tolerances  covariance of the first of the parameters before any reading; empty: not known.
/// @throws Unreachable when the machine does not reach them.
UseOfVisits use_over_workspace(const Robot& robot, const KnownErrors& known, const Eigen::MatrixXd& tolerances = {});

/// Of what is commanded, as pose_jacobian() has it: (4, 4) of x, y, z, phi, or (6, 6) of x, y, z, tilt; mm and rad.
using PoseCovariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

/// A pose as the identified machine takes it, with its uncertainty in the robot's frame.
struct PredictedPose {
  Pose pose;
  PoseCovariance covariance;  ///< by KnownErrors::pose_covariance: U = 2 std
};

/// @param options  of forward(), such as the commanded pose as a start: the assembly mode near it is meant.
/// @throws Unreachable when the machine does not close at these joints.
PredictedPose predict(const Robot& robot, const KnownErrors& known, const Joints& joints,
                      const ForwardOptions& options = {});

/// Standard deviations over poses, as an instrument sees them that does not know the robot's frame.
struct WorkspaceUncertainty {
  double rms_distance = 0.0, max_distance = 0.0;  ///< of d_rho, the distance to home, mm
  double rms_aligned = 0.0, max_aligned = 0.0;    ///< of |dr| after the best rigid motion has been removed, mm
  double rms_rotation = 0.0, max_rotation = 0.0;  ///< of d_phi, or the turn of a plate on struts, relative to home, rad
};

/// Standard deviations at one pose, of the same quantities.
struct PoseStd {
  double distance = 0.0, aligned = 0.0;  ///< mm
  double rotation = 0.0;                 ///< rad
};

/// How known errors spread over poses (home first): linear, from stacked pose Jacobians.
class PoseSpread {
 public:
  /// @throws Unreachable when the machine does not reach a station.
  PoseSpread(const Robot& robot, const SourceErrors& errors, const std::vector<SoughtSource>& parameters,
             const std::vector<Station>& stations);

  WorkspaceUncertainty uncertainty(const Eigen::MatrixXd& covariance) const;
  /// At every pose; home has no distance and no rotation.
  /// @param joint_std  of independent errors of each joint at each pose, rad or mm; empty: none.
  std::vector<PoseStd> each(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& joint_std = {}) const;
  /// What 95 % of the machines with these uncertainties nowhere exceed, from drawn machines; limits are left open. The
  /// same numbers for the same arguments.
  /// @param tolerances  as of use_over_workspace().
  UseOfVisits worst(const KnownErrors& known, const Eigen::MatrixXd& tolerances = {}) const;
  /// B with tr(B C) = mean over the poses of the variance of the aligned position and of `lever` x rotation, mm^2.
  Eigen::MatrixXd mean_square(double lever) const;

 private:
  Eigen::Index turn_rows() const { return rotation_joint_.rows() / (position_joint_.rows() / 3); }

  // Rows of every pose but home: distance to home, aligned x, y, z, rotation relative to home: one of phi, or three of
  // a plate on struts, about x, y, z of {O}.
  Eigen::MatrixXd distance_, aligned_, rotation_;
  // The same by the joints of one pose: distance (along its direction from home) and rotation at every pose but home,
  // then what home's own do; x, y, z at every pose.
  Eigen::MatrixXd distance_joint_, home_distance_joint_, rotation_joint_, position_joint_;
};

}  // namespace paracal
