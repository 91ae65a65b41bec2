#include "rod_derivative.hpp"

#include <cmath>

namespace paracal::detail {

using closure::dot, closure::scaled;

std::array<double, 2> StandingLimb::levers(double side) const {
  const double u = side * limb_.elbow_half[0], v = side * limb_.elbow_half[1];
  switch (limb_.actuator.drive) {
    case Drive::arm:
      return {u + limb_.arm, v};
    case Drive::rail:
      return {u - limb_.arm, v + arm_.sine};
    default:
      return {u, v};
  }
}

double StandingLimb::by_place(double side, const Vector& n) const {
  switch (limb_.actuator.drive) {
    case Drive::arm: {
      const auto [u, v] = levers(side);
      return v * dot(n, elbow_.u1) - u * dot(n, elbow_.v1);
    }
    case Drive::rail:
      return -dot(n, elbow_.v1);
    default:
      return -1.0;
  }
}

double StandingLimb::by_joint(double side, const Eigen::Vector3d& n) const {
  return by_place(side, closure_vector<double>(n)) / limb_.joint_per_mm;
}

ClosureLimb<double> StandingLimb::by_numbers(double side, const Vector& n) const {
  const bool swings = limb_.actuator.drive == Drive::arm, is_strut = limb_.actuator.drive == Drive::strut;
  const double c = swings ? arm_.cosine : 1.0, s = swings ? arm_.sine : 0.0;  // of the turn of u_1 and v_1
  const auto [u, v] = levers(side);
  const Eigen::Vector3d m = rotation_.transpose() * Eigen::Vector3d::Map(n.data());
  ClosureLimb<double> by;
  by.base = scaled(n, -1.0);
  by.radial = scaled(n, v * s - u * c);
  by.normal = scaled(n, -u * s - v * c);
  by.axis = scaled(n, -side * limb_.elbow_half[2]);
  by.plate = closure_vector<double>(m);
  by.slide = scaled(by.plate, phi_);
  by.elbow_half = {-side * dot(n, elbow_.u1), -side * dot(n, elbow_.v1), -side * dot(n, limb_.axis)};
  by.plate_half = scaled(by.plate, side);
  by.rod = {0.0, 0.0};
  if (!is_strut) by.rod[side > 0.0 ? 0 : 1] = -1.0;
  by.arm = is_strut ? 0.0 : dot(n, elbow_.u1) * (swings ? -1.0 : 1.0);
  by.joint_offset = by_place(side, n);
  by.joint_per_mm = swings ? 0.0 : by.joint_offset * (limb_.joint_offset - arm_.sine) / limb_.joint_per_mm;
  by.drive = by.rods = by.ahead = 0.0;
  return by;
}

SourceRow StandingLimb::by_errors(const std::vector<NumberByError>& slopes, double side,
                                  const Eigen::Vector3d& n) const {
  const ClosureLimb<double> gradient = by_numbers(side, closure_vector<double>(n));
  const std::array<double, kClosureNumbers> numbers = numbers_of(gradient);
  std::array<double, kClosureNumbers + 2> all;
  std::copy(numbers.begin(), numbers.end(), all.begin());
  const double by_joint = gradient.joint_offset / limb_.joint_per_mm;
  const double angle = limb_.turn.turning * joint_;
  all[kClosureNumbers] = limb_.turn.is_even() ? 0.0 : by_joint * std::sin(angle);
  all[kClosureNumbers + 1] = limb_.turn.is_even() ? 0.0 : by_joint * std::cos(angle);
  SourceRow row = SourceRow::Zero(1, static_cast<Eigen::Index>(sources_of(limb_.actuator).size()));
  for (const NumberByError& one : slopes) row(one.error) += all[one.number] * one.slope;
  return row;
}

}  // namespace paracal::detail
