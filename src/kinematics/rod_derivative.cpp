#include "rod_derivative.hpp"

#include <cmath>

namespace paracal::detail {

using closure::dot, closure::scaled;

closure::Levers<double> StandingLimb::end(double side) const {
  const auto centre = closure::with_drive<double>(limb_, [&](auto drive) { return drive.levers(limb_, arm_); });
  return {centre.u + side * limb_.elbow_half[0], centre.v + side * limb_.elbow_half[1]};
}

double StandingLimb::by_place(double side, const Vector& n) const {
  return closure::with_drive<double>(limb_, [&](auto drive) { return drive.by_place(end(side), n, elbow_); });
}

double StandingLimb::by_joint(double side, const Eigen::Vector3d& n) const {
  return by_place(side, closure_vector<double>(n)) / limb_.joint_per_mm;
}

ClosureLimb<double> StandingLimb::by_numbers(double side, const Vector& n) const {
  const bool is_length = closure::moves_in_mm<double>(limb_);
  const double c = is_length ? 1.0 : arm_.cosine, s = is_length ? 0.0 : arm_.sine;  // of the turn of u_1 and v_1
  const auto [u, v] = end(side);
  const Eigen::Vector3d m = rotation_.transpose() * Eigen::Vector3d::Map(n.data());
  ClosureLimb<double> by;
  by.base = scaled(n, -1.0);
  by.radial = scaled(n, v * s - u * c);
  by.normal = scaled(n, -u * s - v * c);
  by.axis = scaled(n, -side * limb_.elbow_half[2]);
  by.plate = closure_vector<double>(m);
  by.slide = {};  // changes with no error
  by.elbow_half = {-side * dot(n, elbow_.u1), -side * dot(n, elbow_.v1), -side * dot(n, limb_.axis)};
  by.plate_half = scaled(by.plate, side);
  closure::with_drive<double>(limb_, [&](auto drive) {
    by.rod[side > 0.0 ? 0 : 1] = drive.by_rod();
    by.arm = drive.by_arm(n, elbow_);
  });
  by.joint_offset = by_place(side, n);
  by.joint_per_mm = !is_length ? 0.0 : by.joint_offset * (limb_.joint_offset - arm_.sine) / limb_.joint_per_mm;
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
