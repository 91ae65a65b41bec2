#pragma once

// How a limb closes, once: the library's limbs (limb.hpp, on Eigen) and the compensator of a controller
// (compensation/compensator.hpp) are facades of these lines, and exports for other languages are printed from them.
// Over any scalar that has sqrt and copysign. Standard library alone; real-time: yes (no allocation, no exception, no
// loop).

#include <array>
#include <cmath>
#include <cstdint>

namespace paracal {

/// What a joint moves. A ClosureLimb holds it as a number.
enum class Drive : std::uint8_t {
  arm,    ///< C = b + L u_1, u_1 = cos(th) u_0 + sin(th) v_0,  th = q + joint_offset
  rail,   ///< C = b - L u_0 + s v_0,                           s = q / joint_per_mm + joint_offset
  strut,  ///< C = b, a rod of the length                       s = q / joint_per_mm + joint_offset
};

/// Direction of an arm: (cos(th), sin(th)) times any positive factor; on a rail (1, travel of the carriage in mm). NaN
/// when out of reach.
template <typename Scalar>
struct ArmDirection {
  Scalar cosine, sine;
};

/// What an arm has to reach, mm: d leads from the base joint b to the plate joint, the rod is the mean of the pair.
template <typename Scalar>
struct ArmReach {
  Scalar radial, normal;  ///< d.u_0, d.v_0
  Scalar square;          ///< d.d
  Scalar arm, rod;        ///< L, l
};

/// The same of a carriage on a rail.
template <typename Scalar>
struct RailReach {
  Scalar radial, normal, axial;  ///< d.u_0, d.v_0, d.w_0
  Scalar arm, rod;               ///< L, l
};

/// (A^2 + B^2) (cos(th), sin(th)) with A cos(th) + B sin(th) = K; of the two roots the one with the larger cosine. One
/// square root and no division, since only the direction of the arm matters.
template <typename Scalar>
ArmDirection<Scalar> outward_direction(const Scalar& a, const Scalar& b, const Scalar& k) noexcept {
  using std::copysign, std::sqrt;
  const Scalar w = copysign(sqrt(a * a + b * b - k * k), -b);
  return {a * k - b * w, b * k + a * w};
}

/// Closes the triangle in closed form: the arm that puts the elbow one rod away from the plate joint. Of the two roots
/// it takes the working mode with the elbow outward: the larger u_1.u_0.
///
///   \f[ |d - L u_1(theta)| = l  \iff  A cos(theta) + B sin(theta) = K
///       A = 2 L d.u_0,   B = 2 L d.v_0,   K = d.d + L^2 - l^2 \f]
template <typename Scalar>
ArmDirection<Scalar> close_triangle(const ArmReach<Scalar>& limb) noexcept {
  const Scalar diameter = Scalar(2) * limb.arm;
  const Scalar a = diameter * limb.radial, b = diameter * limb.normal;
  const Scalar k = limb.square + limb.arm * limb.arm - limb.rod * limb.rod;
  return outward_direction(a, b, k);
}

/// Closes the same triangle where the elbow runs along a rail. Of the two roots it takes the carriage above the plate.
///
///   \f[ |d + L u_0 - q v_0| = l  \iff  q = d.v_0 + \sqrt{l^2 - (d.u_0 + L)^2 - (d.w_0)^2} \f]
///
/// @returns q with its offset, mm; NaN when out of reach.
template <typename Scalar>
Scalar close_on_rail(const RailReach<Scalar>& limb) noexcept {
  using std::sqrt;
  const Scalar radial = limb.radial + limb.arm;
  return limb.normal + sqrt(limb.rod * limb.rod - radial * radial - limb.axial * limb.axial);
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

}  // namespace paracal
