#include "paracal/kinematics/error_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "linear_closure.hpp"
#include "numerics/small.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/closure_limb.hpp"
#include "paracal/mechanism/linear_limb.hpp"

namespace paracal {
namespace {

/// Fills A and B, limb by limb, in the letters of [huang2016, Eq. (4)].
template <int N>
void assemble(const Robot& robot, const Pose& pose, ErrorModel& model) {
  const Machine& machine = robot.nominal();
  model.A_dd.resize(N, N);
  model.A_de.resize(N, 3);
  model.A_ee.resize(N, 3);
  model.B_d.resize(N, ErrorModel::kPosition);
  model.B_e.resize(N, ErrorModel::kTilt);
  const ClosurePose<double> at = closure_pose(pose);
  for (int i = 0; i < N; ++i) {
    const Limb& limb = machine.limbs[i];
    const auto radial = closure_vector<double>(radial_of(robot.limbs()[static_cast<std::size_t>(i)]));
    const closure::LinearLimb<double> rows =
        closure::linear_limb<double>(limb, machine.limbs[0], radial, at, limb.turn.actual(model.joints(i)));
    const auto l = as_eigen(rows.rod);
    model.A_dd.row(i).template head<3>() = l;
    if constexpr (N == 4) model.A_dd(i, 3) = limb.slide_sign * l.dot(machine.slide_axis);
    model.A_de.row(i) = as_eigen(rows.A_de);
    model.A_ee.row(i) = as_eigen(rows.A_ee);
    model.B_d.row(i) = Eigen::Matrix<double, 1, ErrorModel::kPosition>::Map(rows.B_d.data());
    model.B_e.row(i) = Eigen::Matrix<double, 1, ErrorModel::kTilt>::Map(rows.B_e.data());
  }
}

/// 1 / (|A| |A^-1|) in the Frobenius norm; 0 when A is singular, whatever its "inverse" then holds.
template <typename Matrix>
double reciprocal_condition(const Matrix& matrix, const Matrix& inverse) {
  const double condition = matrix.norm() * inverse.norm();
  return std::isfinite(condition) ? 1.0 / condition : 0.0;
}

/// G = A^-1 B with block-diagonal B: limb i fills its columns with column i of A^-1 times row i of B.
template <int N>
void solve(const Machine& machine, ErrorModel& model) {
  const Eigen::Matrix<double, N, N> A_dd = model.A_dd;
  const Eigen::Matrix<double, N, 3> A_de = model.A_de, A_ee = model.A_ee;
  const Eigen::Matrix3d normal = A_ee.transpose() * A_ee;
  const Eigen::Matrix<double, N, N> A_dd_inverse = A_dd.inverse();
  const Eigen::Matrix3d normal_inverse = normal.inverse();
  model.condition_dd = reciprocal_condition(A_dd, A_dd_inverse);
  model.condition_ee = reciprocal_condition(normal, normal_inverse);
  const bool regular =
      model.condition_dd >= ErrorModel::kSmallestCondition && model.condition_ee >= ErrorModel::kSmallestCondition;
  if (!regular) {
    model.status = ErrorModelStatus::singular;
    return;
  }
  const Eigen::Matrix<double, 3, N> A_ee_pseudo_inverse = normal_inverse * A_ee.transpose();
  const Eigen::Matrix<double, N, N> tilt_to_delta = -A_dd_inverse * A_de * A_ee_pseudo_inverse;
  model.G_dd.resize(N, static_cast<Eigen::Index>(machine.parameter_count()) - N * ErrorModel::kTilt);
  model.G_de.resize(N, N * ErrorModel::kTilt);
  model.G_ee.resize(3, N * ErrorModel::kTilt);
  for (int i = 0; i < N; ++i) {
    const Eigen::Index first = machine.first_parameter[i] - i * ErrorModel::kTilt;
    model.G_dd.template middleCols<ErrorModel::kPosition>(first) = A_dd_inverse.col(i) * model.B_d.row(i);
    for (int k = 0; machine.limbs[i].actuator.has_harmonics && k < 2; ++k) {
      const std::array<double, 2> by = by_harmonics(machine.limbs[i], model.joints(i));
      model.G_dd.col(first + ErrorModel::kPosition + k) = by[k] * model.G_dd.col(first);
    }
    model.G_de.template middleCols<ErrorModel::kTilt>(i * ErrorModel::kTilt) = tilt_to_delta.col(i) * model.B_e.row(i);
    model.G_ee.template middleCols<ErrorModel::kTilt>(i * ErrorModel::kTilt) =
        A_ee_pseudo_inverse.col(i) * model.B_e.row(i);
  }
  model.status = ErrorModelStatus::ok;
}

}  // namespace

ErrorModel error_model(const Robot& robot, const Pose& pose) noexcept {
  ErrorModel model;
  if (!robot.is_level()) return model;
  const InverseResult nominal = inverse(robot.nominal(), pose);
  if (!nominal.ok()) return model;
  model.joints = nominal.joints;
  detail::with_pair_count(robot.limb_count(), [&]<int N>() {
    assemble<N>(robot, pose, model);
    solve<N>(robot.nominal(), model);
  });
  return model;
}

double paper_scale(const Robot& robot, Source source) {
  return std::ranges::find(robot.parameters(), source, &Parameter::source)->lever;
}

}  // namespace paracal
