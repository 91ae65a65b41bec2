#include "paracal/kinematics/exact_jacobian.hpp"

#include "linear_closure.hpp"
#include "numerics/small.hpp"
#include "rod_derivative.hpp"

namespace paracal {
namespace {

/// Where spare limbs disagree, J^T f = 0 moves with the curvature of the rods as well:
///
///   (J^T J + sum_j f_j d2f_j) dplate = -(J^T df + sum_j f_j d(J_j^T)) dp.
///
/// This is d(J_j^T) / dp for the errors of limb j with one rod, in 1 / mm and mm / mm. As its derivative n.w is linear
/// in n but for lengths, w is what it is along x, y and z less what it is along nothing.
template <int Rows>
using SourceColumns =
    Eigen::Matrix<double, Rows, Eigen::Dynamic, Eigen::ColMajor, Rows, static_cast<int>(kMostSources)>;

SourceColumns<6> turned_gradient(const detail::StandingLimb& limb, const std::vector<NumberByError>& slopes,
                                 Eigen::Index plate, const PlateRotation<double>& rotation, const Eigen::Vector3d& n,
                                 const Eigen::Vector3d& lever, double length) {
  const detail::SourceRow lengths = limb.by_errors(slopes, 1.0, Eigen::Vector3d::Zero());
  SourceColumns<3> w(3, lengths.size());
  for (int axis = 0; axis < 3; ++axis) w.row(axis) = limb.by_errors(slopes, 1.0, Eigen::Vector3d::Unit(axis)) - lengths;
  Eigen::Matrix<double, 3, 6> motion = Eigen::Matrix<double, 3, 6>::Identity();
  for (int k = 0; k < 3; ++k) motion.col(3 + k) = rotation.axes.col(k).cross(lever);
  SourceColumns<6> gradient = motion.transpose() * ((w - n * (n.transpose() * w)) / length);
  for (int k = 0; k < 3; ++k) {  // the joint at the plate takes its lever along
    gradient.block<1, 3>(3 + k, plate) += n.cross(rotation.axes.col(k)).transpose() * rotation.matrix;
  }
  return gradient;
}

template <int N>
ExactJacobian differentiate(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints) {
  ExactJacobian jacobian;
  const detail::Ends<N> ends = detail::ends_of<N>(machine, joints);
  const detail::LinearClosure<N> linear = detail::linearize<N>(machine, plate, ends);
  using Factors = detail::SmallCholesky<detail::NormalMatrix<N>>;
  Factors normal(linear.normal());
  if (!normal.ok()) return jacobian;
  bool curves = false;
  if constexpr (N == detail::kAnyLimbs) {
    if (machine.gap_count() > 0 && linear.residual.cwiseAbs().maxCoeff() > detail::kExact) {
      const Factors curved(linear.normal() + detail::curvature(machine, plate, ends, linear));
      curves = curved.ok();
      if (curves) normal = curved;
    }
  }
  const PlateRotation<double> turn = plate_rotation(plate.tilt);
  jacobian.plate.resize(detail::kUnknowns<N>, static_cast<Eigen::Index>(machine.parameter_count()));
  int row = 0;
  for (int i = 0; i < detail::limbs_of<N>(machine); ++i) {
    const Limb& limb = machine.limbs[i];
    const std::vector<NumberByError>& slopes = machine.by_errors[i];
    const detail::StandingLimb standing(limb, ends[i], joints(i), turn.matrix);
    const Eigen::Index first = machine.first_parameter[i], count = machine.first_parameter[i + 1] - first;
    std::array<detail::SourceRow, 2> rods;
    std::array<detail::Unknowns<N>, 2> by_rod;  // of the plate
    for (std::size_t j = 0; j < limb.actuator.rods; ++j) {
      const auto at = row + static_cast<int>(j);
      rods[j] = standing.by_errors(slopes, j == 0 ? 1.0 : -1.0, linear.direction[at]);
      by_rod[j] = -normal.solve(linear.jacobian.row(at).transpose());
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      auto column = jacobian.plate.template block<detail::kUnknowns<N>, 1>(0, first + k);
      column = by_rod[0] * rods[0](k);
      if (!limb.has_one_rod()) column += by_rod[1] * rods[1](k);
    }
    if constexpr (N == detail::kAnyLimbs) {
      if (curves) {
        SourceColumns<6> gradient =
            turned_gradient(standing, slopes, static_cast<Eigen::Index>(place_in(limb.actuator, "plate_x")), turn,
                            linear.direction[row], linear.lever[row], ends[i].length[0] + linear.residual(row));
        for (int k = 0; k < 6; ++k) {
          if (linear.held[static_cast<std::size_t>(k)]) gradient.row(k).setZero();
        }
        for (Eigen::Index k = 0; k < count; ++k) {
          jacobian.plate.col(first + k) -= normal.solve(linear.residual(row) * gradient.col(k));
        }
      }
    }
    row += limb.actuator.rods;
  }
  jacobian.ok = true;
  return jacobian;
}

}  // namespace

ExactJacobian exact_jacobian(const DifferentiableMachine& machine, const PlateState& plate,
                             const Joints& joints) noexcept {
  return detail::with_limb_count(machine, [&]<int N>() { return differentiate<N>(machine, plate, joints); });
}

}  // namespace paracal
