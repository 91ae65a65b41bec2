#include "paracal/printer/program_calibration.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "numerics/dense.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/base_motion.hpp"
#include "paracal/printer/ladder.hpp"

namespace paracal {
namespace {

/// Where the bed lies in the robot's frame: z = height + slope_x x + slope_y y.
Eigen::Vector3d plane_of(const Calibration& calibration) { return calibration.set_ups.front().unknowns.head<3>(); }

/// Errors by which the whole machine moves so that a plane comes to lie at z = bed: turned about the plane's middle.
SourceErrors moved_onto_bed(const PrinterMachine& printer, const Eigen::Vector3d& plane) {
  const Eigen::Vector3d turn(-plane.z(), plane.y(), 0.0), middle(0.0, 0.0, printer.bed);
  const Eigen::Vector3d shift = Eigen::Vector3d(0.0, 0.0, printer.bed - plane.x()) - turn.cross(middle);
  SourceErrors errors = turned_base(printer.robot, turn);
  for (std::size_t i = 0; i < 3; ++i) shift_limb(printer.robot, i, shift, errors);
  return errors;
}

/// The motion along the bed, and about z, that brings the machine closest to where the firmware with its saved values
/// has the nozzle.
SourceErrors moved_along_bed(const PrinterMachine& printer, const SourceErrors& errors, const DeltaGeometry& saved) {
  constexpr std::array kLevels{0.0, 0.25, 0.5};  // of the workspace's height
  const Machine machine = build(printer.robot, errors);
  const Workspace& workspace = printer.robot.workspace();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (const double level : kLevels) {
    for (Eigen::Vector3d place : printable_disk(workspace.radius)) {
      place.z() = level * workspace.height;
      const auto drops = drops_to(saved, place);
      const ForwardResult taken = drops ? forward(machine, printer.joints_at(*drops)) : ForwardResult{};
      if (!taken.ok()) continue;
      Eigen::Matrix<double, 2, 3> by;  // shift along x and y, turn
      by << 1.0, 0.0, -place.y(), 0.0, 1.0, place.x();
      information += by.transpose() * by;
      gradient += by.transpose() * (place - taken.plate.position).head<2>();
    }
  }
  const Eigen::Vector3d motion = detail::shortest_solution(information, gradient).col(0);
  SourceErrors moved = turned_base(printer.robot, {0.0, 0.0, motion.z()});
  for (std::size_t i = 0; i < 3; ++i) shift_limb(printer.robot, i, {motion.x(), motion.y(), 0.0}, moved);
  return moved;
}

/// Covariance of the errors above the bed, from that of its plane and of the errors.
Eigen::MatrixXd covariance_above_bed(const PrinterMachine& printer, const Calibration& calibration) {
  const Eigen::MatrixXd& of_bed = calibration.set_ups.front().covariance;
  const Eigen::Index n = std::ssize(calibration.parameters);
  Eigen::MatrixXd both(3 + n, 3 + n), by(n, 3 + n);
  both << of_bed, of_bed.rightCols(n).transpose(), rigid_errors(calibration).expanded_covariance();
  by.rightCols(n).setIdentity();
  const Eigen::Vector3d level(printer.bed, 0.0, 0.0);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const SourceErrors moved = moved_onto_bed(printer, level + Eigen::Vector3d::Unit(k));
    for (Eigen::Index i = 0; i < n; ++i) {
      const ParameterEstimate& one = calibration.parameters[static_cast<std::size_t>(i)];
      by(i, k) = moved(one.limb, one.source);
    }
  }
  return detail::product(detail::product(by, both), by.transpose());
}

Calibration above_bed(const PrinterMachine& printer, const DeltaGeometry& saved, Calibration calibration) {
  const bool stated = calibration.set_ups.front().covariance.size() > 0;
  if (stated) {
    calibration.covariance = covariance_above_bed(printer, calibration);
    calibration.noise_covariance = calibration.covariance;  // U = 2 std already, so all of it may count as known
    calibration.noise_dof = std::numeric_limits<double>::infinity();
  }
  SourceErrors errors = calibration.errors() + moved_onto_bed(printer, plane_of(calibration));
  errors = errors + moved_along_bed(printer, errors, saved);
  for (std::size_t k = 0; k < calibration.parameters.size(); ++k) {
    ParameterEstimate& one = calibration.parameters[k];
    one.value = errors(one.limb, one.source);
    if (!stated) continue;
    const auto at = static_cast<Eigen::Index>(k);
    one.std = std::sqrt(calibration.covariance(at, at));
    one.dof = calibration.noise_dof;
    if (one.prior_std) one.data_share = 1.0 - std::min(1.0, std::pow(*one.std / *one.prior_std, 2));
  }
  FoundSetUp& bed = calibration.set_ups.front();
  bed.unknowns = Eigen::Vector3d(printer.bed, 0.0, 0.0);
  bed.covariance.resize(0, 0);
  for (std::size_t k = 0; k < bed.told.size(); ++k) bed.told[k].second = bed.unknowns(static_cast<Eigen::Index>(k));
  return calibration;
}

/// Known to half of what typical readings have, and far from zero: one unbiased printer in 80 is taken for a biased
/// one.
bool has_bias(const Calibration& calibration) {
  constexpr double kDetected = 2.5;  // standard deviations
  const double std = calibration.distance_bias_std.value_or(kDistanceBias);
  return std < 0.5 * kDistanceBias && std::abs(calibration.distance_bias.value_or(0.0)) > kDetected * std;
}

}  // namespace

std::optional<ProgramCalibration> calibrate_for_programs(const DeltaGeometry& saved, const DeltaGeometry& nominal,
                                                         const DeltaReadings& readings, double print_radius) {
  PrinterMachine printer = printer_machine(saved, nominal, print_radius);
  Measurements measurements = printer_measurements(printer, nominal, readings);
  const auto fit = [&](bool seeks_bias) {
    return calibrate(printer.robot, measurements, printer_options(printer, readings, seeks_bias));
  };
  Calibration calibration = fit(!readings.distances.empty());
  if (!readings.distances.empty() && !has_bias(calibration)) calibration = fit(false);
  if (calibration.set_ups.empty()) return std::nullopt;
  calibration = above_bed(printer, saved, std::move(calibration));
  return ProgramCalibration{std::move(printer), std::move(measurements), std::move(calibration)};
}

}  // namespace paracal
