#pragma once

// What a limb is to a closure, and the arithmetic of closures: over double, float, numbers that carry derivatives, the
// lanes of a vector register, or formulas that are printed for another language. Standard library alone; real-time: yes
// (no allocation, no exception, no loop).

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace paracal {

/// What a joint moves: each has its file in drives/. A ClosureLimb holds it as a number.
enum class Drive : std::uint8_t { arm, rail, strut };

/// Direction of an arm: (cos(th), sin(th)) times any positive factor; on a rail (1, travel of the carriage in mm). NaN
/// when out of reach.
template <typename Scalar>
struct ArmDirection {
  Scalar cosine, sine;
};

template <typename Scalar>
using ClosureVector = std::array<Scalar, 3>;

/// One limb of a machine, errors included [huang2016, Eq. (1)]: one rod, or two side by side, from the elbow C to the
/// plate joint; mm, in the base frame {O} unless said otherwise. Plain numbers without padding.
template <typename Scalar>
struct ClosureLimb {
  ClosureVector<Scalar> base{};                      ///< b_i
  ClosureVector<Scalar> radial{}, normal{}, axis{};  ///< u_0, v_0, w_0: columns of R_0
  ClosureVector<Scalar> plate{};                     ///< a_i, in {O'}
  ClosureVector<Scalar> slide{};                     ///< mu_i r_g shat, in {O'}: motion of A_i per rad of phi
  ClosureVector<Scalar> elbow_half{};                ///< (c_c / 2) R_2 e_3, along u_1, v_1, w_0; 0 for one rod
  ClosureVector<Scalar> plate_half{};                ///< (c_a / 2) R_3 e_3, in {O'}; 0 for one rod
  std::array<Scalar, 2> rod{};                       ///< l_1, l_2; equal for one rod
  Scalar arm{};                                      ///< L_i
  Scalar joint_offset{};                             ///< rad, or mm of travel or length
  Scalar joint_per_mm = Scalar(1);  ///< of rails and struts: mm of the joint coordinate per mm, 1 / gain
  Scalar drive{};                   ///< a Drive
  Scalar rods = Scalar(2);          ///< 1 or 2
  Scalar ahead = Scalar(1);         ///< +1: the carriage is ahead of the plate joint, -1: behind it
};

template <typename Scalar, std::size_t N>
using ClosureLimbs = std::array<ClosureLimb<Scalar>, N>;

/// Calls task(number) for all numbers of a limb, in their order.
template <typename Limb, typename Task>
constexpr void for_each_number(Limb& limb, Task&& task) {
  for (auto* vector : {&limb.base, &limb.radial, &limb.normal, &limb.axis, &limb.plate, &limb.slide, &limb.elbow_half,
                       &limb.plate_half}) {
    for (auto& number : *vector) task(number);
  }
  for (auto& number : limb.rod) task(number);
  for (auto* number : {&limb.arm, &limb.joint_offset, &limb.joint_per_mm, &limb.drive, &limb.rods, &limb.ahead}) {
    task(*number);
  }
}

inline constexpr std::size_t kClosureNumbers = sizeof(ClosureLimb<double>) / sizeof(double);

template <typename Scalar>
std::array<Scalar, kClosureNumbers> numbers_of(const ClosureLimb<Scalar>& limb) {
  std::array<Scalar, kClosureNumbers> numbers;
  for_each_number(limb, [next = numbers.begin()](const Scalar& number) mutable { *next++ = number; });
  return numbers;
}

/// The limb of these numbers, which are in any Scalar.
template <typename Scalar, typename Number>
ClosureLimb<Scalar> limb_of(const std::array<Number, kClosureNumbers>& numbers) {
  ClosureLimb<Scalar> limb;
  for_each_number(limb, [next = numbers.begin()](Scalar& number) mutable { number = static_cast<Scalar>(*next++); });
  return limb;
}

/// Columns of R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z, tilt_z).
template <typename Scalar>
struct PlateColumns {
  std::array<Scalar, 3> x, y, z;
};

/// @param a, b, g  cos and sin of tilt_x, tilt_y, tilt_z.
template <typename Scalar>
PlateColumns<Scalar> plate_columns(const ArmDirection<Scalar>& a, const ArmDirection<Scalar>& b,
                                   const ArmDirection<Scalar>& g) noexcept {
  const Scalar &ca = a.cosine, &sa = a.sine, &cb = b.cosine, &sb = b.sine, &cg = g.cosine, &sg = g.sine;
  return {{cb * cg, ca * sg + sa * sb * cg, sa * sg - ca * sb * cg},
          {-(cb * sg), ca * cg - sa * sb * sg, sa * cg + ca * sb * sg},
          {sb, -(sa * cb), ca * cb}};
}

namespace closure {

template <typename Scalar>
using Vector = ClosureVector<Scalar>;

template <typename Scalar>
Scalar dot(const Vector<Scalar>& a, const Vector<Scalar>& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename Scalar>
Vector<Scalar> cross(const Vector<Scalar>& a, const Vector<Scalar>& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// a + factor b
template <typename Scalar>
Vector<Scalar> sum(const Vector<Scalar>& a, const Vector<Scalar>& b,
                   std::type_identity_t<Scalar> factor = Scalar(1)) noexcept {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

template <typename Scalar>
Vector<Scalar> scaled(const Vector<Scalar>& a, Scalar factor) noexcept {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

/// x a + y b + z c
template <typename Scalar>
Vector<Scalar> combination(const Vector<Scalar>& weights, const Vector<Scalar>& a, const Vector<Scalar>& b,
                           const Vector<Scalar>& c) noexcept {
  const auto [x, y, z] = weights;
  return {x * a[0] + y * b[0] + z * c[0], x * a[1] + y * b[1] + z * c[1], x * a[2] + y * b[2] + z * c[2]};
}

/// cos and sin by their series, to 3e-17 for angles within 0.1 rad.
template <typename Scalar>
ArmDirection<Scalar> turn_by_series(Scalar angle) noexcept {
  const Scalar one(1), u = angle * angle;
  const auto part = [&](double of) { return u * Scalar(1.0 / of); };  // divisions are slow on small controllers
  return {one - part(2.0) * (one - part(12.0) * (one - part(30.0) * (one - part(56.0)))),
          angle * (one - part(6.0) * (one - part(20.0) * (one - part(42.0) * (one - part(72.0)))))};
}

inline constexpr double kSeriesReach = 0.1;  ///< rad

/// cos and sin of an angle that is nearly always small.
template <typename Scalar>
ArmDirection<Scalar> turn_by(Scalar angle) noexcept {
  if (std::abs(angle) <= Scalar(kSeriesReach)) return turn_by_series(angle);
  return {std::cos(angle), std::sin(angle)};
}

/// cos and sin of an angle of any size.
template <typename Scalar>
ArmDirection<Scalar> turn_by_any(const Scalar& angle) noexcept {
  using std::cos, std::sin;
  return {cos(angle), sin(angle)};
}

/// Of a number that is whole; what carries derivatives has a value().
template <typename Scalar>
int as_integer(const Scalar& number) noexcept {
  if constexpr (requires { number.value(); }) {
    return static_cast<int>(number.value());
  } else {
    return static_cast<int>(number);
  }
}

template <typename Scalar>
Drive drive_of(const ClosureLimb<Scalar>& limb) noexcept {
  return static_cast<Drive>(as_integer(limb.drive));
}

template <typename Scalar>
std::size_t rod_count(const ClosureLimb<Scalar>& limb) noexcept {
  return static_cast<std::size_t>(as_integer(limb.rods));
}

/// The elbow (of a rail the carriage, of a strut its base joint) in {O}: its centre C and the directions fixed to its
/// short side.
template <typename Scalar>
struct ClosedElbow {
  Vector<Scalar> u1, v1, centre;
};

/// From the base joint of a limb along u_1 and v_1, mm.
template <typename Scalar>
struct Levers {
  Scalar u, v;
};

template <typename Scalar>
Scalar mean_rod(const ClosureLimb<Scalar>& limb) noexcept {
  return Scalar(0.5) * (limb.rod[0] + limb.rod[1]);
}

}  // namespace closure
}  // namespace paracal
