#include "paracal/printer/known_printer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "numerics/dense.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/base_motion.hpp"

namespace paracal {
namespace {

/// Errors by which the whole machine moves so that a plane comes to lie at z = bed: turned about the plane's middle.
SourceErrors moved_onto_bed(const PrinterMachine& printer, const FoundPlane& plane) {
  const Eigen::Vector3d turn(-plane.slope_y, plane.slope_x, 0.0), middle(0.0, 0.0, printer.bed);
  const Eigen::Vector3d shift = Eigen::Vector3d(0.0, 0.0, printer.bed - plane.height) - turn.cross(middle);
  SourceErrors errors = turned_base(printer.robot, turn);
  for (std::size_t i = 0; i < 3; ++i) shift_limb(printer.robot, i, shift, errors);
  return errors;
}

SourceErrors moved_along(const Robot& robot, const MotionOnBed& motion) {
  SourceErrors errors = turned_base(robot, {0.0, 0.0, motion.turn});
  for (std::size_t i = 0; i < 3; ++i) shift_limb(robot, i, {motion.x, motion.y, 0.0}, errors);
  return errors;
}

/// (height, slope_x, slope_y, edge) by (z, slope_x, slope_y, curvature).
Eigen::Matrix4d by_curvature(double bow_radius) {
  const double square = bow_radius * bow_radius;
  Eigen::Matrix4d by = Eigen::Matrix4d::Identity();
  by(0, 3) = 0.5 * square;
  by(3, 3) = square;
  return by;
}

/// Plane and bow of a calibration.
Eigen::Vector4d bed_of(const Calibration& calibration, double bow_radius) {
  Eigen::Vector4d bed = Eigen::Vector4d::Zero();
  const Eigen::VectorXd& unknowns = calibration.set_ups.front().unknowns;
  bed.head(unknowns.size()) = unknowns;
  return by_curvature(bow_radius) * bed;
}

/// d errors / d (height and slopes of the bed, errors).
Eigen::MatrixXd by_plane_and_errors(const KnownPrinter& known) {
  const Eigen::Index n = std::ssize(known.parameters);
  Eigen::MatrixXd by(n, 3 + n);
  by.rightCols(n).setIdentity();
  const FoundPlane level{.height = known.printer.bed};
  std::array<FoundPlane, 3> planes{level, level, level};
  planes[0].height += 1.0;
  planes[1].slope_x = planes[2].slope_y = 1.0;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const SourceErrors moved = moved_onto_bed(known.printer, planes[k]);
    for (Eigen::Index i = 0; i < n; ++i) {
      const SoughtSource& one = known.parameters[static_cast<std::size_t>(i)];
      by(i, static_cast<Eigen::Index>(k)) = moved(one.limb, one.source);
    }
  }
  return by;
}

}  // namespace

double BedBow::share_at(const Eigen::Vector3d& p) const {
  return is_sought() ? p.head<2>().squaredNorm() / (radius * radius) - 0.5 : 0.0;
}

FoundPlane found_bed(const Calibration& calibration, double bow_radius) {
  const Eigen::Vector4d bed = bed_of(calibration, bow_radius);
  return {bed(0), bed(1), bed(2)};
}

KnownPrinter known_printer(const PrinterMachine& printer, const Calibration& calibration, double bow_radius) {
  KnownPrinter known{printer, calibration.errors(), found_bed(calibration, bow_radius)};
  known.bow = {bed_of(calibration, bow_radius)(3), bow_radius};
  for (const ParameterEstimate& one : calibration.parameters) known.parameters.push_back({one.limb, one.source});
  const Eigen::Index n = std::ssize(known.parameters);
  const Eigen::MatrixXd& bed = calibration.set_ups.front().covariance;
  if (bed.size() == 0) return known;
  const Eigen::Index b = known.of_bed();
  known.covariance.resize(b + n, b + n);
  known.covariance << bed, bed.rightCols(n).transpose(), known_errors(calibration).expanded_covariance();
  if (!known.bow.is_sought()) return known;
  const Eigen::Matrix4d by = by_curvature(bow_radius);
  known.covariance.topRows<4>() = (by * known.covariance.topRows<4>()).eval();
  known.covariance.leftCols<4>() = (known.covariance.leftCols<4>() * by.transpose()).eval();
  return known;
}

KnownPrinter above_plane(KnownPrinter known) {
  if (known.bow.is_sought() && known.covariance.size() > 0) {
    std::vector<Eigen::Index> kept{0, 1, 2};
    for (Eigen::Index k = 4; k < known.covariance.rows(); ++k) kept.push_back(k);
    known.covariance = Eigen::MatrixXd(known.covariance(kept, kept));
  }
  known.bow = {};
  return known;
}

Calibration above_bed(Calibration calibration, const KnownPrinter& known, const MotionOnBed& along) {
  const SourceErrors errors =
      calibration.errors() + moved_onto_bed(known.printer, known.bed) + moved_along(known.printer.robot, along);
  const bool stated = known.covariance.size() > 0;
  if (stated) {
    const Eigen::MatrixXd by = by_plane_and_errors(known);
    calibration.covariance = detail::product(detail::product(by, known.covariance), by.transpose());
    calibration.noise_covariance = calibration.covariance;  // U = 2 std already, so all of it may count as known
    calibration.noise_dof = std::numeric_limits<double>::infinity();
  }
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
  bed.unknowns = Eigen::Vector3d(known.printer.bed, 0.0, 0.0);
  bed.covariance.resize(0, 0);
  for (std::size_t k = 0; k < bed.told.size(); ++k) bed.told[k].second = bed.unknowns(static_cast<Eigen::Index>(k));
  return calibration;
}

}  // namespace paracal
