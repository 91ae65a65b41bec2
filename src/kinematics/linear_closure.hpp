#pragma once

// Private to kinematics: the closure of all rods and its analytic derivatives, at sizes known when compiling.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <type_traits>
#include <utility>

#include "paracal/kinematics/closure.hpp"

namespace paracal::detail {

/// N of a plate on fewer than six limbs with one rod.
inline constexpr int kGuided = 0;

/// A machine of N limbs has N compensable freedoms delta = (position, slide; no slide when N = 3), three tilts, and 2 N
/// rods. One of six limbs has one rod a limb, and its freedoms are position and tilt. On fewer limbs with one rod what
/// guides hold stands for rods that are missing: a coordinate that is off is their residual.
template <int N>
inline constexpr bool kOnSingleRods = N == 6 || N == kGuided;
template <int N>
inline constexpr int kUnknowns = kOnSingleRods<N> ? 6 : N + 3;
template <int N>
inline constexpr int kRodsALimb = kOnSingleRods<N> ? 1 : 2;
template <int N>
inline constexpr int kRods = kOnSingleRods<N> ? 6 : 2 * N;

/// Known when compiling but where guides hold the plate.
template <int N>
int limbs_of(const Machine& machine) {
  return N == kGuided ? static_cast<int>(machine.limb_count) : N;
}

template <int N>
using Unknowns = Eigen::Matrix<double, kUnknowns<N>, 1>;
template <int N>
using Rods = Eigen::Matrix<double, kRods<N>, 1>;

template <int N>
using NormalMatrix = Eigen::Matrix<double, kUnknowns<N>, kUnknowns<N>>;

/// Residuals f and Jacobian J = df / d(delta, tilt) of the closure, mm and rad.
template <int N>
struct LinearClosure {
  Rods<N> residual;
  Eigen::Matrix<double, kRods<N>, kUnknowns<N>> jacobian;
  std::array<Eigen::Vector3d, kRods<N>> direction;  ///< unit vectors of the rods, elbow to plate
  std::array<Eigen::Vector3d, kRods<N>> lever;      ///< from O' to the rods' joints on the plate, in {O}

  // Eigen sends products of this size to its blocked kernel, which costs more than the product itself.
  Unknowns<N> gradient() const { return jacobian.transpose().lazyProduct(residual); }
  /// Its lower triangle only, which is all that a Cholesky factorization reads.
  NormalMatrix<N> normal() const {
    NormalMatrix<N> normal;
    normal.template triangularView<Eigen::Lower>() = jacobian.transpose().lazyProduct(jacobian);
    return normal;
  }
};

/// What of an elbow a limb with one rod needs: where the rod is hinged, and how long it is.
struct RodEnd {
  std::array<Eigen::Vector3d, 1> joint;
  std::array<double, 1> rod;
};

inline RodEnd rod_end(const Limb& limb, double joint) {
  if (limb.is_strut()) return {{limb.base}, {rods_at(limb, joint)[0]}};
  return {{limb.base + elbow_lever(limb, joint, arm_directions(limb, joint))}, {limb.rod[0]}};
}

/// The elbows of all limbs: fixed while the plate is sought.
template <int N>
using Elbows = std::array<std::conditional_t<kOnSingleRods<N>, RodEnd, Elbow<double>>, N == kGuided ? 6 : N>;

template <int N>
Elbows<N> elbows_of(const Machine& machine, const Joints& joints) {
  Elbows<N> elbows;
  for (int i = 0; i < limbs_of<N>(machine); ++i) {
    const Limb& limb = machine.limbs[i];
    if constexpr (kOnSingleRods<N>) {
      elbows[i] = rod_end(limb, joints(i));
    } else {
      elbows[i] = elbow_of(limb, joints(i));
    }
  }
  return elbows;
}

/// Order of unknowns: x, y, z, [slide], tilt_x, tilt_y, tilt_z.
template <int N>
void advance(PlateState& plate, const Unknowns<N>& step) {
  plate.position += step.template head<3>();
  if constexpr (N == 4) plate.slide += step(3);
  plate.tilt += step.template tail<3>();
}

/// Rows below those of the rods: what guides hold, mm and rad.
void add_guides(const Machine& machine, const PlateState& plate, LinearClosure<kGuided>& linear);

template <int N>
LinearClosure<N> linearize(const Machine& machine, const PlateState& plate, const Elbows<N>& elbows) {
  LinearClosure<N> linear;
  const PlateRotation<double> rotation = plate_rotation(plate.tilt);
  const Eigen::Vector3d slide_direction = rotation.matrix * machine.slide_axis;
  for (int i = 0; i < limbs_of<N>(machine); ++i) {
    const Limb& limb = machine.limbs[i];
    const std::array<Eigen::Vector3d, 2> hinges = plate_joints(machine, limb, plate.slide);
    for (int j = 0; j < kRodsALimb<N>; ++j) {
      const int row = kRodsALimb<N> * i + j;
      const Eigen::Vector3d lever = rotation.matrix * hinges[j];
      const Eigen::Vector3d rod = plate.position + lever - elbows[i].joint[j];
      const double length = rod.norm();
      const Eigen::Vector3d n = rod / length;
      linear.residual(row) = length - elbows[i].rod[j];
      linear.jacobian.row(row).template head<3>() = n;
      if constexpr (N == 4) linear.jacobian(row, 3) = limb.slide_sign * n.dot(slide_direction);
      linear.jacobian.row(row).template tail<3>() = rotation.axes.transpose() * lever.cross(n);
      linear.direction[row] = n;
      linear.lever[row] = lever;
    }
  }
  if constexpr (N == kGuided) add_guides(machine, plate, linear);
  return linear;
}

/// Calls task.operator()<N>() for the number of limbs that are pairs of rods: 3 or 4.
template <typename Task>
auto with_pair_count(std::size_t limbs, Task&& task) {
  return limbs == 4 ? task.template operator()<4>() : task.template operator()<3>();
}

/// The same for the limbs of any machine: 6 of them have one rod each, and fewer have guides beside them.
template <typename Task>
auto with_limb_count(const Machine& machine, Task&& task) {
  if (machine.has_guides()) return task.template operator()<kGuided>();
  return machine.limb_count == 6 ? task.template operator()<6>()
                                 : with_pair_count(machine.limb_count, std::forward<Task>(task));
}

}  // namespace paracal::detail
