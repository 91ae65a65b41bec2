#pragma once

// Private to kinematics: from where the plate of given joints is sought.

#include <algorithm>
#include <cmath>

#include "guides.hpp"
#include "linear_closure.hpp"
#include "numerics/small.hpp"

namespace paracal::detail {

/// First guess: the plate level. The mean square of its rods says how far it is from the mean W of their upper ends,
/// each less its joint at the plate,
///
///   |r - W|^2 = mean l_i^2 - mean |W_i - W|^2,
///
/// and the workspace on which side of them (BasicMachine::hang). In the middle of the workspace where that says
/// nothing.
template <int N>
PlateState level_guess(const Machine& machine, const Ends<N>& ends) {
  PlateState start{.position = machine.range.centre};
  if (machine.hang.isZero(0.0)) return start;
  const int limbs = limbs_of<N>(machine);
  const double share = 1.0 / limbs;
  const auto wrist = [&](int i) -> Eigen::Vector3d {
    return as_eigen(ends[i].elbow.centre) - as_eigen(machine.limbs[i].plate);
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double square = 0.0, spread = 0.0;
  for (int i = 0; i < limbs; ++i) {
    mean += share * wrist(i);
    square += share * ends[i].length[0] * ends[i].length[0];
  }
  for (int i = 0; i < limbs; ++i) spread += share * (wrist(i) - mean).squaredNorm();
  start.position = mean + std::sqrt(std::max(square - spread, 0.25 * square)) * machine.hang;
  return start;
}

/// A better guess: the plate level still, held by the centre lines of the limbs alone. Newton on
///
///   (|d_i|^2 - l_i^2) / 2 = 0,   d_i = r + a_i + mu_i s shat - C_i
///
/// has N equations in position and slide only: a small part of the work of an exact iteration. Far outside the
/// workspace it may jump to another assembly mode; `start` is returned where it has not settled.
template <int N>
PlateState level_start(const Machine& machine, const Ends<N>& ends, const PlateState& start) {
  constexpr int kIterations = 3;
  constexpr double kSettled = 10.0;  // mm, of the last step
  PlateState plate = start;
  Eigen::Matrix<double, N, 1> step;
  for (int k = 0; k < kIterations; ++k) {
    Eigen::Matrix<double, N, N> jacobian;
    Eigen::Matrix<double, N, 1> residual;
    for (int i = 0; i < N; ++i) {
      const Limb& limb = machine.limbs[i];
      const Eigen::Vector3d slide_direction = limb.slide_sign * machine.slide_axis;
      const Eigen::Vector3d d =
          plate.position + as_eigen(limb.plate) + plate.slide * slide_direction - as_eigen(ends[i].elbow.centre);
      const double rod = limb.mean_rod();
      residual(i) = 0.5 * (d.squaredNorm() - rod * rod);
      jacobian.row(i).template head<3>() = d;
      if constexpr (N == 4) jacobian(i, 3) = d.dot(slide_direction);
    }
    step = jacobian.inverse() * residual;
    plate.position -= step.template head<3>();
    if constexpr (N == 4) plate.slide -= step(3);
  }
  return step.norm() < kSettled ? plate : start;
}

/// Where the rods agree best with a plate that stays level, from the middle of the workspace: long rods hold the place
/// of a small plate well and its turns weakly, and a first step of both would turn it over.
template <int N>
PlateState placed_level(const Machine& machine, const Joints& joints) {
  constexpr int kIterations = 6;
  const Ends<N> ends = ends_of<N>(machine, joints);
  PlateState plate{.position = machine.range.centre};
  for (int k = 0; k < kIterations; ++k) {
    if constexpr (!kIsLevel<N>) guide(machine, plate);
    const LinearClosure<N> linear = linearize<N>(machine, plate, ends);
    const auto moves = linear.jacobian.template leftCols<3>();
    Eigen::Matrix3d normal = moves.transpose().lazyProduct(moves);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (linear.held[axis]) normal.diagonal()(static_cast<Eigen::Index>(axis)) = 1.0;
    }
    const SmallCholesky<Eigen::Matrix3d> factors(normal);
    if (!factors.ok()) break;
    const Eigen::Vector3d step = factors.solve(moves.transpose().lazyProduct(linear.residual));
    plate.position -= step;
  }
  return plate;
}

}  // namespace paracal::detail
