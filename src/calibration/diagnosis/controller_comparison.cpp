#include "controller_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

/// mm at the elbow that the single-precision arithmetic of a controller may lose: 2^-24 of a metre, squared and
/// subtracted a few times.
constexpr double kArithmetic = 1e-4;
/// A fitted dimension spreads the rounding of one joint over others: no joint is off by more than its own and as much.
constexpr double kFitted = 2.0;
/// The values that fit best, by Gauss and Newton; a step that leaves the reach of the controller is halved.
/// @returns empty where the joints do not show them or no values explain the joints.
std::optional<Explained> explain_from(const Comparison& comparison, const ControllerSuspect& suspected,
                                      Eigen::VectorXd values) {
  constexpr int kSteps = 30, kHalvings = 20;
  constexpr double kSettled = 1e-3;  // of a rounding
  constexpr double kUnseen = 1e-3;   // roundings per mm or rad: as good as none
  Eigen::VectorXd left = comparison.residuals(suspected, values);
  double resolution = 0.0;
  for (int step = 0; suspected.unknowns > 0 && step < kSteps; ++step) {
    const Eigen::MatrixXd slope = slopes(comparison, suspected, values);
    if (!slope.allFinite()) return std::nullopt;
    const double seen = shown_by(slope);
    if (seen < kUnseen) return std::nullopt;
    resolution = 1.0 / seen;
    Eigen::VectorXd change = -detail::least_squares(slope, left);
    const double moves = (slope * change).cwiseAbs().maxCoeff();
    for (int half = 0; half < kHalvings; ++half, change *= 0.5) {
      if (comparison.residuals(suspected, values + change).allFinite()) break;
    }
    values += change;
    left = comparison.residuals(suspected, values);
    if (moves < kSettled) break;
  }
  const bool fits = left.allFinite() && left.cwiseAbs().maxCoeff() <= kFitted;
  if (!fits || !suspected.is_believable(values)) return std::nullopt;
  return Explained{&suspected, suspected.controller(values), suspected.text(values, resolution), suspected.unknowns};
}

}  // namespace

Comparison::Comparison(const Robot& robot, const std::vector<DisplayedJoints>& displayed) : displayed_(displayed) {
  for (const DisplayedJoints& one : displayed) {
    Joints tolerance = one.rounding;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      tolerance(static_cast<Eigen::Index>(limb)) += kArithmetic / joint_ratio(robot.nominal().limbs[limb]);
    }
    tolerances_.push_back(tolerance);
  }
}

Eigen::VectorXd Comparison::residuals(const PoseJoints& expected) const {
  const Eigen::Index limbs = tolerances_.front().size();
  Eigen::VectorXd all(limbs * static_cast<Eigen::Index>(displayed_.size()));
  for (std::size_t k = 0; k < displayed_.size(); ++k) {
    all.segment(limbs * static_cast<Eigen::Index>(k), limbs) =
        (displayed_[k].joints - expected(displayed_[k].pose)).cwiseQuotient(tolerances_[k]);
  }
  return all;
}

Joints Comparison::tolerance() const {
  Joints coarsest = tolerances_.front();
  for (const Joints& one : tolerances_) coarsest = coarsest.cwiseMax(one);
  return coarsest;
}

Eigen::MatrixXd slopes(const Comparison& comparison, const ControllerSuspect& suspected,
                       const Eigen::VectorXd& values) {
  constexpr double kStep = 1e-4;  // mm or rad
  Eigen::MatrixXd columns(comparison.residuals(suspected, values).size(), values.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(values.size());
    step(k) = kStep;
    columns.col(k) = (comparison.residuals(suspected, values + step) - comparison.residuals(suspected, values - step)) /
                     (2.0 * kStep);
  }
  return columns;
}

double shown_by(const Eigen::MatrixXd& slope) {
  return std::sqrt(std::max(0.0, detail::symmetric_eigenvalues(slope.transpose() * slope).minCoeff()));
}

std::optional<Explained> explain(const Comparison& comparison, const ControllerSuspect& suspected) {
  if (suspected.unknowns != 1) return explain_from(comparison, suspected, Eigen::VectorXd::Zero(suspected.unknowns));
  for (const double start : suspected.starts) {
    if (auto found = explain_from(comparison, suspected, Eigen::VectorXd::Constant(1, start))) return found;
  }
  return std::nullopt;
}

}  // namespace paracal::detail
