#include "paracal/kinematics/exact_jacobian.hpp"

#include "linear_closure.hpp"
#include "numerics/small.hpp"
#include "rod_derivative.hpp"

namespace paracal {
namespace {

/// A column a source error of a limb with two rods, without harmonics: known when compiling, and so fast.
constexpr int kOfParallelogram = static_cast<int>(sources_of(Actuator::revolute).size());
static_assert(sources_of(Actuator::linear).size() == kOfParallelogram);
using ParallelogramRow = Eigen::Matrix<double, 1, kOfParallelogram>;

/// df_ij / dp for the sources of limb i; `sign` is +1 for rod 1 and -1 for rod 2. A point that a source error turns
/// about an axis moves by axis x lever; the rod shortens by n.(motion at the elbow) and lengthens by n.(motion at the
/// plate).
ParallelogramRow rod_derivative(const Limb& limb, double joint, const Elbow<double>& elbow,
                                const Eigen::Matrix3d& rotation, const Eigen::Vector3d& n, double sign) {
  const Eigen::Vector3d elbow_half = sign * elbow.half;
  const Eigen::Vector3d elbow_lever = elbow.lever + elbow_half;
  const Eigen::Vector3d plate_half = rotation * (0.5 * sign * limb.plate_width * limb.plate_frame.col(2));
  const Eigen::Vector3d vertical = limb.frame.col(1), actuator_axis = limb.frame.col(2);
  const Eigen::Vector3d plate_radial = rotation * limb.radial, plate_vertical = rotation * limb.plate_frame.col(1);
  const Eigen::Vector3d elbow_normal =  // R_0 R_1 R_2 e_2, about which beta2 turns
      limb.elbow_frame(0, 1) * elbow.arm + limb.elbow_frame(1, 1) * elbow.arm_normal +
      limb.elbow_frame(2, 1) * actuator_axis;
  const auto elbow_turn = [&](const Eigen::Vector3d& axis, const Eigen::Vector3d& lever) {
    return -n.dot(axis.cross(lever));
  };
  const auto plate_turn = [&](const Eigen::Vector3d& axis) { return n.dot(axis.cross(plate_half)); };

  ParallelogramRow derivative;
  const auto at = [&](Source source) -> double& {
    return derivative(static_cast<Eigen::Index>(place_in(limb.actuator, source)));
  };
  const bool on_rail = runs_on_rail(limb.actuator);
  at("e_x") = -n.x();
  at("e_y") = -n.y();
  at("e_z") = -n.z();
  if (on_rail) {
    at("theta_offset") = -n.dot(elbow.arm_normal);
    at("gain") = at("theta_offset") * limb.turn.actual(joint) / kGainLength;
  } else {
    at("theta_offset") = elbow_turn(actuator_axis, elbow_lever);
    at("arm_length") = -n.dot(elbow.arm);
  }
  // alpha0 and beta0 turn both short sides: alpha3 = alpha0 - alpha03; but a rail leans by beta0 alone.
  at("alpha0") = elbow_turn(limb.radial, elbow_lever) + plate_turn(plate_radial);
  at("beta0") =
      on_rail ? elbow_turn(actuator_axis, elbow_lever) : elbow_turn(vertical, elbow_lever) + plate_turn(plate_vertical);
  at("rod_mean") = -1.0;
  at("rod_difference") = -0.5 * sign;
  at("width_difference") = -n.dot(elbow_half) / limb.elbow_width;
  at("alpha03") = -plate_turn(plate_radial);
  at("beta03") = -plate_turn(plate_vertical);
  at("alpha2") = elbow_turn(elbow.arm, elbow_half);
  at("beta2") = elbow_turn(elbow_normal, elbow_half);
  return derivative;
}

/// Where spare limbs disagree, J^T f = 0 moves with the curvature of the rods as well:
///
///   (J^T J + sum_j f_j d2f_j) dplate = -(J^T df + sum_j f_j d(J_j^T)) dp.
///
/// This is d(J_j^T) / dp for the errors of limb j with one rod, in 1 / mm and mm / mm. As its derivative n.w is linear
/// in n but for lengths, w is what it is along x, y and z less what it is along nothing.
Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, static_cast<int>(kMostSources)> turned_gradient(
    const Limb& limb, double joint, const PlateRotation<double>& rotation, const Eigen::Vector3d& n,
    const Eigen::Vector3d& lever, double length) {
  const auto along = [&](const Eigen::Vector3d& direction) {
    return detail::single_rod_derivative(limb, joint, rotation.matrix, direction);
  };
  const detail::SourceRow lengths = along(Eigen::Vector3d::Zero());
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, static_cast<int>(kMostSources)> w(3, lengths.size());
  for (int axis = 0; axis < 3; ++axis) w.row(axis) = along(Eigen::Vector3d::Unit(axis)) - lengths;
  Eigen::Matrix<double, 3, 6> motion = Eigen::Matrix<double, 3, 6>::Identity();
  for (int k = 0; k < 3; ++k) motion.col(3 + k) = rotation.axes.col(k).cross(lever);
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, static_cast<int>(kMostSources)> gradient =
      motion.transpose() * ((w - n * (n.transpose() * w)) / length);
  const auto plate = static_cast<Eigen::Index>(place_in(limb.actuator, "plate_x"));
  for (int k = 0; k < 3; ++k) {  // the joint at the plate takes its lever along
    gradient.template block<1, 3>(3 + k, plate) += n.cross(rotation.axes.col(k)).transpose() * rotation.matrix;
  }
  return gradient;
}

template <int N>
ExactJacobian differentiate(const Machine& machine, const PlateState& plate, const Joints& joints) {
  ExactJacobian jacobian;
  const detail::Elbows<N> elbows = detail::elbows_of<N>(machine, joints);
  const detail::LinearClosure<N> linear = detail::linearize<N>(machine, plate, elbows);
  using Factors = detail::SmallCholesky<detail::NormalMatrix<N>>;
  Factors normal(linear.normal());
  if (!normal.ok()) return jacobian;
  bool curves = false;
  if constexpr (N == detail::kAnyLimbs) {
    if (machine.gap_count() > 0 && linear.residual.cwiseAbs().maxCoeff() > detail::kExact) {
      const Factors curved(linear.normal() + detail::curvature(machine, plate, elbows, linear));
      curves = curved.ok();
      if (curves) normal = curved;
    }
  }
  Eigen::Matrix<double, detail::kUnknowns<N>, detail::kRods<N>, Eigen::ColMajor, detail::kUnknowns<N>,
                detail::kMostRods<N>>
      residual_to_plate(+detail::kUnknowns<N>, linear.jacobian.rows());
  for (Eigen::Index rod = 0; rod < linear.jacobian.rows(); ++rod) {
    residual_to_plate.col(rod) = -normal.solve(linear.jacobian.row(rod).transpose());
  }
  const PlateRotation<double> turn = plate_rotation(plate.tilt);
  const Eigen::Matrix3d& rotation = turn.matrix;
  const int limbs = detail::limbs_of<N>(machine);
  jacobian.plate.resize(detail::kUnknowns<N>, static_cast<Eigen::Index>(machine.parameter_count()));
  int row = 0;
  for (int i = 0; i < limbs; ++i) {
    const Limb& limb = machine.limbs[i];
    const Eigen::Index first = machine.first_parameter[i];
    if (limb.has_one_rod()) {
      const detail::SourceRow rod = detail::single_rod_derivative(limb, joints(i), rotation, linear.direction[row]);
      jacobian.plate.middleCols(first, rod.size()) = residual_to_plate.col(row) * rod;
      if constexpr (N == detail::kAnyLimbs) {
        if (curves) {
          auto gradient = turned_gradient(limb, joints(i), turn, linear.direction[row], linear.lever[row],
                                          elbows[i].rod[0] + linear.residual(row));
          for (int k = 0; k < 6; ++k) {
            if (linear.held[static_cast<std::size_t>(k)]) gradient.row(k).setZero();
          }
          for (Eigen::Index k = 0; k < rod.size(); ++k) {
            jacobian.plate.col(first + k) -= normal.solve(linear.residual(row) * gradient.col(k));
          }
        }
      }
      ++row;
      continue;
    }
    if constexpr (N != 6) {
      Eigen::Matrix<double, 2, kOfParallelogram> rods;
      rods.row(0) = rod_derivative(limb, joints(i), elbows[i], rotation, linear.direction[row], 1.0);
      rods.row(1) = rod_derivative(limb, joints(i), elbows[i], rotation, linear.direction[row + 1], -1.0);
      jacobian.plate.template block<detail::kUnknowns<N>, kOfParallelogram>(0, first) =
          residual_to_plate.template middleCols<2>(row).lazyProduct(rods);
      if (limb.actuator.has_harmonics) {
        const auto [sine, cosine] = by_harmonics(limb, joints(i));
        const Eigen::Index of_turn = first + kOfParallelogram;
        jacobian.plate.col(of_turn) = sine * jacobian.plate.col(first);
        jacobian.plate.col(of_turn + 1) = cosine * jacobian.plate.col(first);
      }
      row += 2;
    }
  }
  jacobian.ok = true;
  return jacobian;
}

}  // namespace

namespace detail {

SourceRow single_rod_derivative(const Limb& limb, double joint, const Eigen::Matrix3d& rotation,
                                const Eigen::Vector3d& n) {
  const Elbow<double> elbow = elbow_of(limb, joint);
  SourceRow derivative(static_cast<Eigen::Index>(sources_of(limb.actuator).size()));
  const auto column = [&](Source source) { return static_cast<Eigen::Index>(place_in(limb.actuator, source)); };
  const auto at = [&](Source source) -> double& { return derivative(column(source)); };
  const auto turn = [&](const Eigen::Vector3d& axis) { return -n.dot(axis.cross(elbow.lever)); };
  derivative.segment<3>(column("plate_x")) = n.transpose() * rotation;
  if (has(limb.actuator, "normal")) {
    at("zero") = -n.dot(elbow.arm_normal);
    at("normal") = -n.dot(limb.radial);
    at("across") = -n.dot(limb.sideways);
    at("gain") = -n.dot(elbow.arm_normal) * limb.turn.actual(joint) / kGainLength;
  } else {
    at("zero") = limb.is_strut() ? -1.0 : turn(limb.frame.col(2));
    derivative.segment<3>(column("base_x")) = -n;
  }
  if (limb.actuator.has_harmonics) {
    const auto [sine, cosine] = by_harmonics(limb, joint);
    at("turn_sine") = sine * at("zero");
    at("turn_cosine") = cosine * at("zero");
  }
  if (limb.is_strut()) {
    at("gain") = -limb.turn.actual(joint) / kGainLength;
    return derivative;
  }
  const bool swings = swings_arm(limb.actuator);
  if (swings) at("arm_length") = -n.dot(elbow.arm);
  at("alpha0") = turn(limb.radial);
  at("beta0") = turn(limb.frame.col(swings ? 1 : 2));
  at("rod_length") = -1.0;
  return derivative;
}

}  // namespace detail

ExactJacobian exact_jacobian(const Machine& machine, const PlateState& plate, const Joints& joints) noexcept {
  return detail::with_limb_count(machine, [&]<int N>() { return differentiate<N>(machine, plate, joints); });
}

}  // namespace paracal
