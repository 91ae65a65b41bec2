#pragma once

#include <cstdint>

#include "paracal/mechanism/plausible.hpp"

/// Ranges of options that cost time or memory, and of those that have no unit: the same for the program and Python.
/// Within them a call ends within hours on one computer.
namespace paracal::option_limits {

struct Whole {
  std::uint64_t least = 0, most = 0;
};

inline constexpr Whole kCandidates{2, 100'000};                       ///< of a plan; memory grows with their number
inline constexpr Whole kSelectedPoses{2, 1000};                       ///< an exchange takes time with their square
inline constexpr Whole kRepeats{1, 10'000};                           ///< visits of each pose
inline constexpr Whole kMaxMachines{16, 1'000'000'000'000};           ///< fewer have no percentiles
inline constexpr plausible::Range kO2Threshold{1e-15, 1.0};           ///< a smaller change is rounding
inline constexpr plausible::Range kStartDeg{-360.0, 360.0};           ///< azimuth of the first pose
inline constexpr plausible::Range kScalePpm{0.0, 1e4};                ///< 1 % is no scale of an instrument
inline constexpr plausible::Range kDialAngleDeg{0.0, 10.0};           ///< more is visible
inline constexpr plausible::Range kRelativeError{1e-4, 1.0};          ///< of simulated statistics
inline constexpr plausible::Range kConfidence{0.5, 0.9999};           ///< level of intervals
inline constexpr plausible::Range kStd{0.0, plausible::kLimit.most};  ///< of something that may be absent

}  // namespace paracal::option_limits
