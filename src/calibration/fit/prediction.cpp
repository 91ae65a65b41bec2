#include "paracal/calibration/prediction.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "distance_geometry.hpp"
#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "numerics/square_root.hpp"
#include "observation.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/random.hpp"
#include "sought.hpp"
#include "started.hpp"

namespace paracal {

double SplineKnot::at(double joint) const { return cubic_bump((joint - centre) / spacing); }

double coverage_factor(double dof) {
  constexpr double kEachTail = 0.02275;  // of a standard normal variable beyond 2
  constexpr double kMany = 1e6,
                   kFewest = 0.1;  // of fewer, which only a fit that diverged has, no number is large enough
  if (!(dof < kMany)) return kCoverageFactor;
  return detail::students_t_quantile(kEachTail, std::max(dof, kFewest));
}

Eigen::MatrixXd KnownErrors::expanded_covariance() const {
  if (noise_covariance.size() == 0) return covariance;
  const double wider = std::pow(coverage_factor(noise_dof) / kCoverageFactor, 2) - 1.0;
  Eigen::MatrixXd expanded = covariance;
  expanded.topLeftCorner(noise_covariance.rows(), noise_covariance.cols()) += wider * noise_covariance;
  return expanded;
}

Eigen::VectorXd KnownErrors::joint_std_of_a_visit() const {
  if (visit_std.size() == 0) return joint_std;
  return joint_std.size() == 0 ? visit_std : (joint_std.cwiseAbs2() + visit_std.cwiseAbs2()).cwiseSqrt();
}

Eigen::MatrixXd KnownErrors::pose_covariance() const {
  Eigen::MatrixXd all = expanded_covariance();
  const Eigen::VectorXd joints = joint_std_of_a_visit();
  for (std::size_t k = 0; joints.size() > 0 && all.size() > 0 && k < parameters.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    if (parameters[k].knot || !is_joint_zero(parameters[k].source)) continue;
    all(at, at) += std::pow(joints(static_cast<Eigen::Index>(parameters[k].limb)), 2);
  }
  return all;
}

namespace {

/// Adds a knot of a joint behind the `count` that it has.
/// @returns whether it is the next of equally spaced ones.
bool add_knot(const SplineKnot& knot, double size, std::size_t count, DriveCurve<double>& curve) {
  constexpr double kRounding = 1e-6;
  if (count == kDriveKnots) return false;
  if (count == 0) {
    curve.first = knot.centre;
    curve.spacing = knot.spacing;
  }
  curve.sizes.at(count) = size;
  const double place = (knot.centre - curve.first) / curve.spacing - static_cast<double>(count);
  return std::abs(place) < kRounding && std::abs(knot.spacing / curve.spacing - 1.0) < kRounding;
}

/// The slope of a cubic spline is between the differences of its sizes.
double steepest(const DriveCurve<double>& curve) {
  double before = 0.0, largest = 0.0;
  for (const double size : curve.sizes) {
    largest = std::max(largest, std::abs(size - before));
    before = size;
  }
  return std::max(largest, std::abs(before)) / curve.spacing;
}

}  // namespace

std::optional<std::string> DriveCurves::take(const std::vector<SoughtSource>& parameters,
                                             const Eigen::VectorXd& sizes) {
  const std::size_t first = parameters.size() - static_cast<std::size_t>(sizes.size());
  std::vector<std::size_t> counts;
  for (Eigen::Index k = 0; k < sizes.size(); ++k) {
    const SoughtSource& one = parameters[first + static_cast<std::size_t>(k)];
    curves_.resize(std::max(curves_.size(), one.limb + 1));
    counts.resize(curves_.size());
    if (add_knot(one.knot.value(), sizes(k), counts[one.limb]++, curves_[one.limb])) continue;
    return fmt::format(
        "expected at most {} equally spaced splines for each joint, one behind the other, got others "
        "for limb {}",
        kDriveKnots, one.limb + 1);
  }
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    if (curves_[i].is_even() || steepest(curves_[i]) < kSteepestDrive) continue;
    return fmt::format(
        "expected sizes that change by less than {} of the spacing from one spline to the next, got "
        "{:.3g} for limb {}",
        kSteepestDrive, steepest(curves_[i]), i + 1);
  }
  return std::nullopt;
}

DriveCurves::DriveCurves(const std::vector<SoughtSource>& parameters, const Eigen::VectorXd& sizes) {
  if (const auto complaint = take(parameters, sizes)) throw InvalidArgument("drives: " + *complaint);
}

std::optional<std::string> DriveCurves::complaint(const std::vector<SoughtSource>& parameters,
                                                  const Eigen::VectorXd& sizes) {
  return DriveCurves().take(parameters, sizes);
}

Joints DriveCurves::actual(const Joints& commanded) const {
  Joints joints = commanded;
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    double& joint = joints(static_cast<Eigen::Index>(i));
    joint += curves_[i].off(joint);
  }
  return joints;
}

Joints DriveCurves::commanded(const Joints& actual) const {
  Joints joints = actual;
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    double& joint = joints(static_cast<Eigen::Index>(i));
    joint = curves_[i].commanded(joint);
  }
  return joints;
}

Measurements at_actual_joints(const Robot& robot, const DriveCurves& drives, Measurements measurements) {
  if (drives.are_even()) return measurements;
  for (Station& station : measurements.stations) station.believed = drives.actual(believed_joints(robot, station));
  return measurements;
}

KnownErrors with_drives(KnownErrors rigid, const Eigen::VectorXd& with_drives, const Eigen::VectorXd& sizes,
                        double gain) {
  KnownErrors known = std::move(rigid);
  Eigen::VectorXd off(with_drives.size() + sizes.size());
  off.tail(sizes.size()) = sizes;
  for (Eigen::Index k = 0; k < with_drives.size(); ++k) {
    const SoughtSource& one = known.parameters[static_cast<std::size_t>(k)];
    off(k) = with_drives(k) - known.errors(one.limb, one.source);
    known.errors(one.limb, one.source) = with_drives(k);
  }
  known.covariance -= gain * off * off.transpose();
  known.drive_sizes = sizes;
  return known;
}

KnownErrors known_errors(const Posterior& posterior) {
  KnownErrors rigid = rigid_errors(posterior);
  if (posterior.drive_sizes.size() == 0) return rigid;
  Eigen::VectorXd errors(std::ssize(posterior.parameters));
  for (Eigen::Index k = 0; k < errors.size(); ++k) {
    const ParameterEstimate& one = posterior.parameters[static_cast<std::size_t>(k)];
    errors(k) = one.with_drives.value_or(one.value);
  }
  return with_drives(std::move(rigid), errors, posterior.drive_sizes, posterior.omitted_poses.value().gain());
}

KnownErrors rigid_errors(const Posterior& posterior) {
  KnownErrors known{.errors = posterior.errors(),
                    .parameters = {},
                    .covariance = posterior.covariance,
                    .noise_covariance = posterior.noise_covariance,
                    .noise_dof = posterior.noise_dof,
                    .joint_std = posterior.joint_std,
                    .visit_std = posterior.visit_std,
                    .region = posterior.region};
  for (const ParameterEstimate& one : posterior.parameters) known.parameters.push_back({one.limb, one.source});
  add_drives(posterior.drives, posterior.drive_covariance, known);
  return known;
}

void add_drives(const std::vector<SoughtSource>& drives, const Eigen::MatrixXd& covariance, KnownErrors& known) {
  if (drives.empty() || known.covariance.size() == 0) return;
  const Eigen::Index n = known.covariance.rows(), more = covariance.rows();
  known.parameters.insert(known.parameters.end(), drives.begin(), drives.end());
  known.covariance.conservativeResize(n + more, n + more);
  known.covariance.bottomRows(more) = covariance;
  known.covariance.topRightCorner(n, more) = covariance.leftCols(n).transpose();
}

KnownErrors promised(const Robot& robot, const Measurements& given, const CalibrationOptions& options) {
  check(given, robot.limb_count());
  const Measurements plan = detail::as_points(given).value_or(given);
  detail::Observation observation(robot, plan, options, detail::all_with_priors(robot, options), true);
  const auto start = observation.start({});
  InformationRoot root(observation.unknown_count());
  if (!start || !detail::with_priors(observation)(*start, root)) {
    throw detail::not_closed(robot, robot.nominal(), plan.stations);
  }
  const Eigen::Index n = observation.source_count();
  return {{}, observation.sought(), inverse_information(root.root()).bottomRightCorner(n, n)};
}

PlateMotions plate_jacobian(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints,
                            const std::vector<SoughtSource>& parameters) {
  const ExactJacobian exact = exact_jacobian(machine, plate, joints);
  PlateMotions motions(7, exact.ok ? static_cast<Eigen::Index>(parameters.size()) : 0);
  for (Eigen::Index k = 0; k < motions.cols(); ++k) {
    const SoughtSource& one = parameters[static_cast<std::size_t>(k)];
    const double share = one.knot ? one.knot->at(joints(static_cast<Eigen::Index>(one.limb))) : 1.0;
    const Eigen::VectorXd sensitivity =
        share * exact.plate.col(static_cast<Eigen::Index>(machine.parameter(one.limb, one.source)));
    motions.col(k).head<3>() = sensitivity.head<3>();
    motions(3, k) = machine.has_slide() ? machine.rotation_of(sensitivity(3)) : 0.0;
    motions.col(k).tail<3>() = sensitivity.tail<3>();
  }
  return motions;
}

namespace {

/// Of a plate that stands there with these joints.
Eigen::MatrixXd pose_jacobian_at(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints,
                                 const std::vector<SoughtSource>& parameters) {
  const PlateMotions motions = plate_jacobian(machine, plate, joints, parameters);
  if (motions.cols() == 0 && !parameters.empty()) return {};
  if (!machine.commands_tilt()) return motions.topRows<4>();
  Eigen::MatrixXd commanded(6, motions.cols());
  commanded << motions.topRows<3>(), motions.bottomRows<3>();
  return commanded;
}

}  // namespace

Eigen::MatrixXd pose_jacobian(const DifferentiableMachine& machine, const Joints& joints,
                              const std::vector<SoughtSource>& parameters) {
  const ForwardResult pose = forward(machine, joints);
  return pose.usable() ? pose_jacobian_at(machine, pose.plate, joints, parameters) : Eigen::MatrixXd();
}

PredictedPose predict(const Robot& robot, const KnownErrors& known, const Joints& joints,
                      const ForwardOptions& options) {
  const DifferentiableMachine machine = differentiable(robot, known.errors);
  const ForwardResult result = forward(machine, known.drives().actual(joints), options);
  if (!result.usable()) throw Unreachable("no solution: " + why_no_pose(machine, result));
  const Eigen::MatrixXd jacobian = pose_jacobian_at(machine, result.plate, joints, known.parameters);
  if (jacobian.rows() == 0) throw Unreachable("no solution: the plate can move with fixed joints");
  return {pose_of(machine, result.plate),
          detail::product(detail::product(jacobian, known.pose_covariance()), jacobian.transpose())};
}

}  // namespace paracal
