#pragma once

// Private to kinematics: the closure of all rods and its analytic derivatives, at sizes known when compiling.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <type_traits>
#include <utility>

#include "paracal/kinematics/closure.hpp"

namespace paracal::detail {

/// N of any other machine: limbs of both kinds, guides, or more rods than unknowns.
inline constexpr int kAnyLimbs = 0;

/// A machine of N limbs that keep its plate level has N compensable freedoms delta = (position, slide; no slide when
/// N = 3), three tilts, and 2 N rods. One of six limbs with one rod each has as many rods as freedoms, position and
/// tilt. On any other, too, all six are unknown, but what guides hold stays: its columns are zero.
template <int N>
inline constexpr bool kIsLevel = N == 3 || N == 4;
template <int N>
inline constexpr int kUnknowns = kIsLevel<N> ? N + 3 : 6;
template <int N>
inline constexpr int kRodsALimb = kIsLevel<N> ? 2 : 1;
template <int N>
inline constexpr int kMostRods = N == kAnyLimbs ? 2 * kMaxLimbs : kRodsALimb<N>* N;
/// Known when compiling, but of any limbs.
template <int N>
inline constexpr int kRods = N == kAnyLimbs ? Eigen::Dynamic : kMostRods<N>;

template <int N>
int limbs_of(const Machine& machine) {
  return N == kAnyLimbs ? static_cast<int>(machine.limb_count) : N;
}

template <int N>
int rods_of(const Machine& machine) {
  if (N != kAnyLimbs) return kMostRods<N>;
  int rods = 0;
  for (std::size_t i = 0; i < machine.limb_count; ++i) rods += machine.limbs[i].actuator.rods;
  return rods;
}

template <int N>
using Unknowns = Eigen::Matrix<double, kUnknowns<N>, 1>;
template <int N>
using Rods = Eigen::Matrix<double, kRods<N>, 1, Eigen::ColMajor, kMostRods<N>, 1>;

template <int N>
using NormalMatrix = Eigen::Matrix<double, kUnknowns<N>, kUnknowns<N>>;

/// Residuals f and Jacobian J = df / d(delta, tilt) of the closure, mm and rad.
template <int N>
struct LinearClosure {
  Rods<N> residual;
  Eigen::Matrix<double, kRods<N>, kUnknowns<N>, Eigen::ColMajor, kMostRods<N>, kUnknowns<N>> jacobian;
  std::array<Eigen::Vector3d, kMostRods<N>> direction;  ///< unit vectors of the rods, elbow to plate
  std::array<Eigen::Vector3d, kMostRods<N>> lever;      ///< from O' to the rods' joints on the plate, in {O}

  // Eigen sends products of this size to its blocked kernel, which costs more than the product itself.
  Unknowns<N> gradient() const { return jacobian.transpose().lazyProduct(residual); }
  /// Its lower triangle only, which is all that a Cholesky factorization reads; 1 for what guides hold.
  NormalMatrix<N> normal() const {
    NormalMatrix<N> normal;
    normal.template triangularView<Eigen::Lower>() = jacobian.transpose().lazyProduct(jacobian);
    if constexpr (N == kAnyLimbs) {
      for (Eigen::Index k = 0; k < kUnknowns<N>; ++k) normal(k, k) += held[static_cast<std::size_t>(k)] ? 1.0 : 0.0;
    }
    return normal;
  }
  std::array<bool, 6> held{};  ///< by guides
};

/// The upper ends of the rods of all limbs: fixed while the plate is sought.
template <int N>
inline constexpr std::size_t kEndsALimb = N == 6 ? 1 : 2;
template <int N>
using Ends = std::array<closure::UpperEnds<double, kEndsALimb<N>>, N == kAnyLimbs ? kMaxLimbs : N>;

template <int N>
Ends<N> ends_of(const Machine& machine, const Joints& joints) {
  Ends<N> ends;
  for (int i = 0; i < limbs_of<N>(machine); ++i) ends[i] = ends_at<kEndsALimb<N>>(machine.limbs[i], joints(i));
  return ends;
}

/// What guides hold does not move: zero columns.
inline void hold_guided(const Machine& machine, LinearClosure<kAnyLimbs>& linear) {
  for (Eigen::Index k = 0; machine.has_guides && k < 6; ++k) {
    if (machine.freedoms.free[static_cast<std::size_t>(k)]) continue;
    linear.held[static_cast<std::size_t>(k)] = true;
    linear.jacobian.col(k).setZero();
  }
}

/// Order of unknowns: x, y, z, [slide], tilt_x, tilt_y, tilt_z.
template <int N>
void advance(PlateState& plate, const Unknowns<N>& step) {
  plate.position += step.template head<3>();
  if constexpr (N == 4) plate.slide += step(3);
  plate.tilt += step.template tail<3>();
}

template <int N>
LinearClosure<N> linearize(const Machine& machine, const PlateState& plate, const Ends<N>& ends) {
  LinearClosure<N> linear;
  if constexpr (N == kAnyLimbs) {
    linear.residual.resize(rods_of<N>(machine));
    linear.jacobian.resize(linear.residual.size(), kUnknowns<N>);
  }
  const PlateRotation<double> rotation = plate_rotation(plate.tilt);
  const Eigen::Vector3d slide_direction = rotation.matrix * machine.slide_axis;
  const double phi = machine.rotation_of(plate.slide);
  int row = 0;
  for (int i = 0; i < limbs_of<N>(machine); ++i) {
    const Limb& limb = machine.limbs[i];
    const auto lower = closure::lower_ends<kEndsALimb<N>, double>(limb, phi);
    const int rods = N == kAnyLimbs ? static_cast<int>(limb.actuator.rods) : kRodsALimb<N>;
    for (int j = 0; j < rods; ++j, ++row) {
      const Eigen::Vector3d lever = rotation.matrix * as_eigen(lower[j]);
      const Eigen::Vector3d rod = plate.position + lever - as_eigen(ends[i].place[j]);
      const double length = rod.norm();
      const Eigen::Vector3d n = rod / length;
      linear.residual(row) = length - ends[i].length[j];
      linear.jacobian.row(row).template head<3>() = n;
      if constexpr (N == 4) linear.jacobian(row, 3) = limb.slide_sign * n.dot(slide_direction);
      linear.jacobian.row(row).template tail<3>() = rotation.axes.transpose() * lever.cross(n);
      linear.direction[row] = n;
      linear.lever[row] = lever;
    }
  }
  if constexpr (N == kAnyLimbs) hold_guided(machine, linear);
  return linear;
}

/// mm: rods that miss by less have their lengths.
inline constexpr double kExact = 1e-6;

/// What the second derivatives of the rods add to J^T J where residuals remain, sum_j f_j d2f_j. With v_j along the
/// rod, D = dv_j / d(position, tilt) and axes a_k of the tilts (k <= l, the outer first),
///
///   d2f_j = (D^T D - J_j^T J_j) / |v_j| + n_j . (a_k x (a_l x lever_j)).
///
/// Without it the steps shrink only by the residuals over the stiffness of the rods, which near a singularity is slow.
inline NormalMatrix<kAnyLimbs> curvature(const Machine& machine, const PlateState& plate, const Ends<kAnyLimbs>& ends,
                                         const LinearClosure<kAnyLimbs>& linear) {
  NormalMatrix<kAnyLimbs> sum = NormalMatrix<kAnyLimbs>::Zero();
  const Eigen::Matrix3d axes = plate_rotation(plate.tilt).axes;
  int row = 0;
  for (int i = 0; i < limbs_of<kAnyLimbs>(machine); ++i) {
    for (std::size_t j = 0; j < machine.limbs[static_cast<std::size_t>(i)].actuator.rods; ++j, ++row) {
      const auto at = static_cast<std::size_t>(row);
      const double f = linear.residual(row), length = ends[static_cast<std::size_t>(i)].length[j] + f;
      Eigen::Matrix<double, 3, 6> motion = Eigen::Matrix<double, 3, 6>::Identity();
      for (int k = 0; k < 3; ++k) motion.col(3 + k) = axes.col(k).cross(linear.lever[at]);
      const Eigen::Matrix<double, 1, 6> along = linear.direction[at].transpose() * motion;
      sum += (f / length) * (motion.transpose() * motion - along.transpose() * along);
      for (int k = 0; k < 3; ++k) {
        for (int l = k; l < 3; ++l) {
          const double turning = f * linear.direction[at].dot(axes.col(k).cross(motion.col(3 + l)));
          sum(3 + l, 3 + k) += turning;
          if (l > k) sum(3 + k, 3 + l) += turning;
        }
      }
    }
  }
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (!linear.held[static_cast<std::size_t>(k)]) continue;
    sum.row(k).setZero();
    sum.col(k).setZero();
  }
  return sum;
}

/// Calls task.operator()<N>() for the number of limbs that are pairs of rods: 3 or 4.
template <typename Task>
auto with_pair_count(std::size_t limbs, Task&& task) {
  return limbs == 4 ? task.template operator()<4>() : task.template operator()<3>();
}

/// The same for the limbs of any machine.
template <typename Task>
auto with_limb_count(const Machine& machine, Task&& task) {
  if (machine.is_level) return with_pair_count(machine.limb_count, std::forward<Task>(task));
  const bool six_rods = machine.limb_count == 6 && rods_of<kAnyLimbs>(machine) == 6 && !machine.has_guides;
  return six_rods ? task.template operator()<6>() : task.template operator()<kAnyLimbs>();
}

}  // namespace paracal::detail
