#pragma once

// The errors of a drive along its stroke, smooth or with each turn. Needs only the standard library, as
// machine_closure.hpp. Real-time: yes.

#include <array>
#include <cmath>
#include <cstddef>

namespace paracal {

inline constexpr std::size_t kDriveKnots = 11;  ///< of each joint: eight intervals of its stroke, one knot more outside
inline constexpr int kMostDriveSteps = 20;  ///< of the search for a command: each leaves kSteepestDrive of its error
inline constexpr double kNoDriveChange = 1e-12;  ///< rad or mm, at which it ends
inline constexpr double kSteepestDrive = 0.2;    ///< error by way of a joint; of real drives it is a hundredth and less

/// The joint to command so that it gets there: q with q + s(q) = actual, by s = s(actual - s) from s = 0 on.
template <typename Scalar, typename Off>
Scalar commanded_to(Scalar actual, Off&& off) noexcept {
  Scalar s{}, change = Scalar(1);
  for (int step = 0; step < kMostDriveSteps && std::abs(change) > static_cast<Scalar>(kNoDriveChange); ++step) {
    const Scalar next = off(actual - s);
    change = next - s;
    s = next;
  }
  return actual - s;
}

/// What repeats with each turn of a screw or an encoder: s(q) = sine sin(w q) + cosine cos(w q); rad or mm.
template <typename Scalar>
struct TurnCurve {
  Scalar turning = Scalar(0);  ///< w: of the screw or encoder by the joint, rad per rad or mm; 0: the drive is even
  Scalar sine = Scalar(0), cosine = Scalar(0);

  bool is_even() const noexcept { return !(turning > Scalar(0)); }

  Scalar off(const Scalar& joint) const noexcept {
    using std::cos, std::sin;
    const Scalar angle = turning * joint;
    return sine * sin(angle) + cosine * cos(angle);
  }

  /// Where the joint is when it is commanded there.
  Scalar actual(const Scalar& joint) const noexcept { return is_even() ? joint : Scalar(joint + off(joint)); }

  /// How much it moves for what is commanded.
  Scalar rate(const Scalar& joint) const noexcept {
    using std::cos, std::sin;
    const Scalar angle = turning * joint;
    return Scalar(1) + turning * (sine * cos(angle) - cosine * sin(angle));
  }

  /// The joint to command so that it gets there.
  Scalar commanded(const Scalar& actual) const noexcept {
    return is_even() ? actual : commanded_to(actual, [this](const Scalar& joint) { return off(joint); });
  }
};

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
/// with B = cubic_bump, and, from there on, what repeats with each turn; rad or mm.
template <typename Scalar>
struct DriveCurve {
  Scalar first{};    ///< centre of the first spline
  Scalar spacing{};  ///< 0: the drive is even
  std::array<Scalar, kDriveKnots> sizes{};
  TurnCurve<Scalar> turn{};

  bool is_even() const noexcept { return !has_splines() && turn.is_even(); }

  /// Of the splines.
  Scalar off(Scalar joint) const noexcept {
    return has_splines() ? sum((joint - first) / spacing, cubic_bump<Scalar>) : Scalar(0);
  }

  /// Of the splines, ds/dq
  Scalar slope(Scalar joint) const noexcept {
    return has_splines() ? sum((joint - first) / spacing, cubic_bump_slope<Scalar>) / spacing : Scalar(0);
  }

  /// The joint to command so that it gets there.
  Scalar commanded(Scalar actual) const noexcept {
    const Scalar turned = turn.commanded(actual);
    return has_splines() ? commanded_to(turned, [this](Scalar joint) { return off(joint); }) : turned;
  }

 private:
  bool has_splines() const noexcept { return spacing > Scalar(0); }

  /// @param place  in spacings behind the first spline.
  template <typename Bump>
  Scalar sum(Scalar place, Bump bump) const noexcept {
    Scalar value{};
    for (std::size_t k = 0; k < kDriveKnots; ++k) value += sizes[k] * bump(place - static_cast<Scalar>(k));
    return value;
  }
};

}  // namespace paracal
