#pragma once

#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Plausible ranges of input numbers. They are wide: all correct numbers are inside; numbers without their decimal
/// point or in the wrong column are outside. All readers of files and options use these
/// ranges.
namespace paracal::plausible {

struct Range {
  double least, most;
  std::string_view unit = {};
  std::string_view why = {};  ///< reason in a message

  /// False for what is not a number.
  bool contains(double value) const { return value >= least && value <= most; }
};

/// "expected x_mm from -14000 to 14000 mm (ten times the reach of the robot), got 1e+08"; empty: it is in the range.
std::optional<std::string> complaint(std::string_view quantity, double value, const Range& range);

/// For numbers with a range that depends on others and is checked with these.
inline constexpr Range kFinite{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};

/// The smallest positive length, angle or limit, mm, deg or rad: no instrument can measure less.
inline constexpr double kNothing = 1e-9;

/// Positions, lengths and distances: pillars, instruments and spheres are near the robot, not in another hall.
constexpr Range length(double reach) { return {-10.0 * reach, 10.0 * reach, "mm", "ten times the reach of the robot"}; }
constexpr Range positive_length(double reach) {
  return {kNothing, 10.0 * reach, "mm", "ten times the reach of the robot"};
}

/// Dimensions of one robot or printer, relative to the median of all: a typing error is outside, the others are
/// inside. A plate may be a point.
Range dimension(std::vector<double> all);

/// Errors of parts, limits and tolerances.
constexpr Range error(double reach) { return {-reach, reach, "mm", "the reach of the robot"}; }
constexpr Range limit(double reach) { return {kNothing, reach, "mm", "the reach of the robot"}; }
inline constexpr Range kErrorDeg{-180.0, 180.0, "deg", "half a turn"};
inline constexpr Range kLimitDeg{kNothing, 180.0, "deg", "half a turn"};
inline constexpr Range kLimitRad{kNothing, std::numbers::pi, "rad", "half a turn"};
/// For an option, which is read before the robot.
inline constexpr Range kLimit{kNothing, 1e6};

/// Poses, joints and encoders, which may count turns.
inline constexpr Range kAngle{-36000.0, 36000.0, "deg", "a hundred turns"};

/// Coordinates of an instrument at any position: beyond this limit doubles do not resolve 0.1 um.
inline constexpr Range kInstrument{-1e9, 1e9, "mm", "a thousand kilometres"};

/// Standard deviations of instruments. Far outside, weights exceed the range of numbers.
inline constexpr Range kNoise{1e-5, 1e6, "", "no instrument is outside"};

/// Speeds and accelerations of joints, feeds.
inline constexpr Range kSpeed{kNothing, 1e7, "", "no drive is outside"};

/// Costs, in any money and by any law.
inline constexpr Range kCost{kNothing, 1e12};

/// Values in the files of a printer's firmware, in mm, deg, steps or percent.
inline constexpr Range kPrinter{-1e5, 1e5, "", "no printer is larger than 100 m"};
inline constexpr Range kPositiveOfPrinter{kNothing, kPrinter.most, kPrinter.unit, kPrinter.why};

/// Components of directions and quaternions, of any length.
inline constexpr Range kDirection{-1e6, 1e6};

/// Counts and labels.
inline constexpr Range kCount{1.0, 1e6};

}  // namespace paracal::plausible
