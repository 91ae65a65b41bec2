#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "paracal/mechanism/machine_closure.hpp"

// A number of machine_closure.hpp's templates that is several: one a lane of a vector register.

namespace paracal::closure {

inline constexpr std::size_t kLanes = 8;

struct Lanes {
  using Vector [[gnu::vector_size(kLanes * sizeof(double))]] = double;
  using Mask [[gnu::vector_size(kLanes * sizeof(double))]] = long long;

  Vector values{};

  Lanes() = default;
  explicit Lanes(double value) : values(value - Vector{}) {}
  explicit Lanes(Vector vector) : values(vector) {}

  double operator[](std::size_t lane) const { return values[lane]; }
  void set(std::size_t lane, double value) { values[lane] = value; }
};

inline Lanes operator-(const Lanes& a) { return Lanes(-a.values); }
inline Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(a.values + b.values); }
inline Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(a.values - b.values); }
inline Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(a.values * b.values); }
inline Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(a.values / b.values); }

inline Lanes choose(Lanes::Mask mask, const Lanes& yes, const Lanes& no) {
  return Lanes(mask ? yes.values : no.values);
}

inline Lanes sqrt(const Lanes& a) {
  Lanes root;
  for (std::size_t k = 0; k < kLanes; ++k) root.values[k] = std::sqrt(a.values[k]);
  return root;
}

inline Lanes abs(const Lanes& a) { return choose(a.values < 0.0, -a, a); }

inline Lanes::Mask is_finite(const Lanes& a) { return abs(a).values <= std::numeric_limits<double>::max(); }

/// Of signs other than those of zeros.
inline Lanes copysign(const Lanes& size, const Lanes& sign) {
  const Lanes positive = abs(size);
  return choose(sign.values < 0.0, -positive, positive);
}

/// atan(z) / z for |z| <= tan(pi / 8): the polynomial in z^2 through its values at the Chebyshev nodes, to 6e-17 with
/// coefficients rounded to double.
inline Lanes atan_over_z(const Lanes& z) {
  constexpr std::array kCoefficients{-0.0177753931266881,  0.03793815678135668,  -0.050340476512612004,
                                     0.058466468296215185, -0.06662920354889862, 0.0769204259218075,
                                     -0.09090896656431272, 0.1111111073963548,   -0.14285714279143952,
                                     0.199999999999398,    -0.33333333333333115, 1.0};
  const Lanes u = z * z;
  Lanes value(kCoefficients.front());
  for (std::size_t k = 1; k < kCoefficients.size(); ++k) value = value * u + Lanes(kCoefficients[k]);
  return value;
}

/// Within 5e-16 rad of std::atan2 for finite numbers that are not both zero; NaN for NaN.
inline Lanes atan2(const Lanes& y, const Lanes& x) {
  constexpr double kTanEighth = 0.41421356237309504880, kQuarter = 0.78539816339744830962;  // tan(pi / 8), pi / 4
  const Lanes wide = abs(x), high = abs(y);
  const Lanes::Mask is_steep = high.values > wide.values;
  const Lanes small = choose(is_steep, wide, high), large = choose(is_steep, high, wide);
  // atan(t) = pi/4 + atan((t - 1) / (t + 1)) brings every t = small / large below tan(pi / 8).
  const Lanes::Mask is_far = small.values > kTanEighth * large.values;
  const Lanes z = choose(is_far, small - large, small) / choose(is_far, small + large, large);
  Lanes angle = z * atan_over_z(z) + choose(is_far, Lanes(kQuarter), Lanes(0.0));
  angle = choose(is_steep, Lanes(2.0 * kQuarter) - angle, angle);
  angle = choose(x.values < 0.0, Lanes(4.0 * kQuarter) - angle, angle);
  return choose(y.values < 0.0, -angle, angle);
}

// All lanes hold the same limb.
inline int as_integer(const Lanes& lanes) { return static_cast<int>(lanes[0]); }

inline ArmDirection<Lanes> turn_by_any(const Lanes& angle) {
  ArmDirection<Lanes> turn;
  for (std::size_t k = 0; k < kLanes; ++k) {
    turn.cosine.set(k, std::cos(angle[k]));
    turn.sine.set(k, std::sin(angle[k]));
  }
  return turn;
}

/// NaN beyond the reach of the series: such lanes are left to the scalar compensator.
inline ArmDirection<Lanes> turn_by(const Lanes& angle) {
  const Lanes near = choose(abs(angle).values <= kSeriesReach, angle, Lanes(std::numeric_limits<double>::quiet_NaN()));
  return turn_by_series(near);
}

}  // namespace paracal::closure
