#pragma once

// The smooth error of a drive along its stroke. Needs only the standard library, as machine_closure.hpp. Real-time:
// yes.

#include <array>
#include <cmath>
#include <cstddef>

namespace paracal {

inline constexpr std::size_t kDriveKnots = 11;  ///< of each joint: eight intervals of its stroke, one knot more outside
inline constexpr int kMostDriveSteps = 20;  ///< of the search for a command: each leaves kSteepestDrive of its error
inline constexpr double kNoDriveChange = 1e-12;  ///< rad or mm, at which it ends
inline constexpr double kSteepestDrive = 0.2;    ///< error by way of a joint; of real drives it is a hundredth and less

/// A cubic B-spline at x spacings from its centre: 2/3 there, none beyond two spacings.
template <typename Scalar>
Scalar cubic_bump(Scalar x) noexcept {
  const Scalar away = std::abs(x), rest = Scalar(2) - away;
  if (!(away < Scalar(2))) return Scalar(0);
  return away < Scalar(1) ? Scalar(2) / Scalar(3) - away * away * (Scalar(1) - Scalar(0.5) * away)
                          : rest * rest * rest / Scalar(6);
}

/// Its derivative by x.
template <typename Scalar>
Scalar cubic_bump_slope(Scalar x) noexcept {
  const Scalar away = std::abs(x), rest = Scalar(2) - away;
  if (!(away < Scalar(2))) return Scalar(0);
  const Scalar slope = away < Scalar(1) ? away * (Scalar(1.5) * away - Scalar(2)) : Scalar(-0.5) * rest * rest;
  return x < Scalar(0) ? -slope : slope;
}

/// How far one joint is from where its drive says:
///
///   s(q) = sum over k of sizes[k] B(|q - first - k spacing| / spacing)
///
/// with B = cubic_bump; rad or mm.
template <typename Scalar>
struct DriveCurve {
  Scalar first{};    ///< centre of the first spline
  Scalar spacing{};  ///< 0: the drive is even
  std::array<Scalar, kDriveKnots> sizes{};

  bool is_even() const noexcept { return !(spacing > Scalar(0)); }

  Scalar off(Scalar joint) const noexcept {
    return is_even() ? Scalar(0) : sum((joint - first) / spacing, cubic_bump<Scalar>);
  }

  /// ds/dq
  Scalar slope(Scalar joint) const noexcept {
    return is_even() ? Scalar(0) : sum((joint - first) / spacing, cubic_bump_slope<Scalar>) / spacing;
  }

  /// The joint to command so that it gets there: q with q + s(q) = actual, by s = s(actual - s) from s = 0 on.
  Scalar commanded(Scalar actual) const noexcept {
    if (is_even()) return actual;
    const Scalar place = (actual - first) / spacing;
    Scalar off{}, change = Scalar(1);
    for (int step = 0; step < kMostDriveSteps && std::abs(change) > static_cast<Scalar>(kNoDriveChange); ++step) {
      const Scalar next = sum(place - off / spacing, cubic_bump<Scalar>);
      change = next - off;
      off = next;
    }
    return actual - off;
  }

 private:
  /// @param place  in spacings behind the first spline.
  template <typename Bump>
  Scalar sum(Scalar place, Bump bump) const noexcept {
    Scalar value{};
    for (std::size_t k = 0; k < kDriveKnots; ++k) value += sizes[k] * bump(place - static_cast<Scalar>(k));
    return value;
  }
};

}  // namespace paracal
