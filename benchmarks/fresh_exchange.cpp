#include "fresh_exchange.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "paracal/calibration/plan.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal::benchmark {
namespace {

constexpr Eigen::Index kFrame = 6;
constexpr double kTurn = 0.005, kShift = 1.0;  // rad, mm: priors of the frame, as select_stations() has them

std::vector<SoughtSource> all_errors(const Robot& robot) {
  std::vector<SoughtSource> all;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : sources_of(robot.actuator()))
      all.push_back({limb, source, robot.tolerances()->std(source)});
  }
  return all;
}

Eigen::VectorXd prior_std(const std::vector<SoughtSource>& errors) {
  Eigen::VectorXd std(static_cast<Eigen::Index>(errors.size()));
  for (std::size_t k = 0; k < errors.size(); ++k) std(static_cast<Eigen::Index>(k)) = *errors[k].prior_std;
  return std;
}

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// M of a positive semi-definite B.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

FreshCriterion::FreshCriterion(const Robot& robot, const std::vector<Station>& candidates) {
  const std::vector<SoughtSource> errors = all_errors(robot);
  const Eigen::VectorXd scale = prior_std(errors);
  const double sigma = NoiseModel{}.point;
  const Eigen::Index unknowns = kFrame + scale.size();
  rows_.resize(unknowns, 3 * static_cast<Eigen::Index>(candidates.size()));
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Joints joints = believed_joints(robot, candidates[k]);
    auto rows = rows_.middleCols<3>(3 * static_cast<Eigen::Index>(k));
    rows.topRows<3>() = kTurn / sigma * cross(candidates[k].commanded.position);
    rows.middleRows<3>(3) = kShift / sigma * Eigen::Matrix3d::Identity();
    const Eigen::MatrixXd jacobian = pose_jacobian(robot.nominal(), joints, errors).topRows<3>();
    rows.bottomRows(scale.size()) = scale.asDiagonal() * jacobian.transpose() / sigma;
  }
  const PoseSpread spread(robot, {}, errors, workspace_stations(robot));
  const Eigen::MatrixXd wanted = spread.mean_square(robot.slide() ? robot.slide()->pinion_radius : 0.0);
  goal_ = Eigen::MatrixXd::Zero(unknowns, scale.size());
  goal_.bottomRows(scale.size()) = scale.asDiagonal() * root_of(wanted);
}

Eigen::MatrixXd FreshCriterion::information(const std::vector<std::size_t>& poses) const {
  Eigen::MatrixXd all(rows_.rows(), 3 * static_cast<Eigen::Index>(poses.size()));
  for (std::size_t k = 0; k < poses.size(); ++k) all.middleCols<3>(3 * static_cast<Eigen::Index>(k)) = rows(poses[k]);
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(rows_.rows(), rows_.rows());
  information.selfadjointView<Eigen::Lower>().rankUpdate(all);
  return information;
}

double FreshCriterion::with(const Eigen::MatrixXd& others, std::size_t candidate) const {
  Eigen::MatrixXd information = others;
  information.selfadjointView<Eigen::Lower>().rankUpdate(rows(candidate));
  return of(information);
}

double FreshCriterion::of(const Eigen::MatrixXd& information) const {
  return Eigen::LLT<Eigen::MatrixXd>(information).matrixL().solve(goal_).squaredNorm();
}

}  // namespace paracal::benchmark
