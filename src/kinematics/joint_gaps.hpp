#pragma once

// Private to the library: by how much the joints of more limbs than degrees of freedom disagree.

#include <Eigen/Core>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/differentiable_machine.hpp"

namespace paracal::detail {

/// As many as Machine::gap_count(). Joint i stands e_i = q_i - inverse_i(x), rad or mm, from where a plate x has it. At
/// the plate of the least |e|
///
///   gap = N^T e,   N^T (de / dx) = 0,   N^T N = 1
///
/// No motion of the plate closes a gap: of joints read with one standard deviation, gaps have this, too, and are
/// independent. The gradient of |gap|^2 by the parameters is exact, because e is all in the space of N there.
struct JointGaps {
  Eigen::VectorXd gap;
  Eigen::MatrixXd by_parameter;  ///< a column a parameter, as Robot::parameters()
};

/// An N, a row a limb.
/// @param plate  near the least |e|: the answer of forward(machine, joints).
Eigen::MatrixXd gap_basis(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints);

/// @param near  the N of a machine and a pose nearby, which this one follows smoothly.
JointGaps joint_gaps(const DifferentiableMachine& machine, const PlateState& plate, const Joints& joints,
                     const Eigen::MatrixXd& near);

}  // namespace paracal::detail
