#include "joint_gaps.hpp"

#include <vector>

#include "linear_closure.hpp"
#include "numerics/dense.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "rod_derivative.hpp"

namespace paracal::detail {
namespace {

/// How far joints stand from those of a plate.
struct Stand {
  Eigen::VectorXd off;       ///< e
  Eigen::MatrixXd by_plate;  ///< a column a degree of freedom
  Eigen::MatrixXd by_parameter;
};

std::vector<Eigen::Index> free_columns(const Machine& machine) {
  std::vector<Eigen::Index> free;
  for (std::size_t k = 0; k < machine.freedoms.free.size(); ++k) {
    if (machine.freedoms.free[k]) free.push_back(static_cast<Eigen::Index>(k));
  }
  return free;
}

/// de = df / (df / dq) where every rod fits.
Stand stand(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints) {
  const Joints fitting = inverse(machine, pose_of(machine, plate)).joints;
  const Ends<kAnyLimbs> ends = ends_of<kAnyLimbs>(machine, fitting);
  const LinearClosure<kAnyLimbs> linear = linearize<kAnyLimbs>(machine, plate, ends);
  const Eigen::Matrix3d rotation = plate_rotation(plate.tilt).matrix;
  const auto limbs = static_cast<Eigen::Index>(machine.limb_count);
  Stand all{joints - fitting, linear.jacobian(Eigen::all, free_columns(machine)),
            Eigen::MatrixXd::Zero(limbs, static_cast<Eigen::Index>(machine.parameter_count()))};
  for (Eigen::Index i = 0; i < limbs; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const StandingLimb limb(machine.limbs[k], ends[k], fitting(i), rotation);
    const double per_joint = limb.by_joint(1.0, linear.direction[k]);
    const SourceRow own = limb.by_errors(machine.by_errors[k], 1.0, linear.direction[k]);
    all.by_parameter.row(i).segment(machine.first_parameter[k], own.size()) = own / per_joint;
    all.by_plate.row(i) /= per_joint;
  }
  return all;
}

/// Where the joints are off by the least: Gauss-Newton from a plate nearby.
Stand least_off(const DifferentiableMachine& machine, PlateState plate, const Joints& joints) {
  constexpr int kMaxIterations = 20;
  constexpr double kTolerance = 1e-10;  // mm and rad, of the last step
  const std::vector<Eigen::Index> free = free_columns(machine);
  Stand all = stand(machine, plate, joints);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Unknowns<kAnyLimbs> step = Unknowns<kAnyLimbs>::Zero();
    step(free) = -least_squares(all.by_plate, all.off);
    if (!(step.norm() > kTolerance)) break;
    advance<kAnyLimbs>(plate, step);
    all = stand(machine, plate, joints);
  }
  return all;
}

}  // namespace

Eigen::MatrixXd gap_basis(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints) {
  const Eigen::MatrixXd by_plate = least_off(machine, plate, joints).by_plate;
  return orthogonal_factor(by_plate).rightCols(by_plate.rows() - by_plate.cols());
}

JointGaps joint_gaps(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints,
                     const Eigen::MatrixXd& near) {
  const Stand all = least_off(machine, plate, joints);
  // What no motion of the plate closes of `near`, made orthonormal by the least turn.
  const Eigen::MatrixXd square = near - product(all.by_plate, least_squares(all.by_plate, near));
  const Eigen::MatrixXd basis = product(square, inverse_square_root(product(square.transpose(), square)));
  return {product(basis.transpose(), all.off), product(basis.transpose(), all.by_parameter)};
}

}  // namespace paracal::detail
