#pragma once

// Private to kinematics: the closure of one rod by the joint and by the errors of its limb.

#include <Eigen/Core>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/differentiable_machine.hpp"

namespace paracal::detail {

/// A column a source error of one limb.
using SourceRow = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, static_cast<int>(kMostSources)>;

/// A limb of a machine that stands there, whose rods are
///
///   f = |r + R (a + phi slide + side h_a) - C - side h_c| - l,   side = +1, -1; of a single rod h_a = h_c = 0
///
/// in the letters of ClosureLimb.
class StandingLimb {
 public:
  /// @param ends      of its rods at a joint as commanded.
  /// @param rotation  of the plate that stands there.
  template <std::size_t Rods>
  StandingLimb(const Limb& limb, const closure::UpperEnds<double, Rods>& ends, double joint,
               const Eigen::Matrix3d& rotation)
      : limb_(limb), arm_(ends.arm), elbow_(ends.elbow), rotation_(rotation), joint_(joint) {}

  /// df / dq: mm of a rod's residual per rad or mm of where the joint is.
  /// @param n  from the upper end of the rod along it.
  double by_joint(double side, const Eigen::Vector3d& n) const;

  /// df / dp for the errors of the limb. Linear in n but for what makes a rod longer.
  /// @param slopes  of the limb, DifferentiableMachine::by_errors.
  SourceRow by_errors(const std::vector<NumberByError>& slopes, double side, const Eigen::Vector3d& n) const;

 private:
  using Vector = ClosureVector<double>;

  /// The upper end of a rod.
  closure::Levers<double> end(double side) const;
  double by_place(double side, const Vector& n) const;
  ClosureLimb<double> by_numbers(double side, const Vector& n) const;

  const Limb& limb_;
  const ArmDirection<double>& arm_;
  const closure::ClosedElbow<double>& elbow_;
  const Eigen::Matrix3d& rotation_;
  double joint_;
};

}  // namespace paracal::detail
