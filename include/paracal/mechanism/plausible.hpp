#pragma once

#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Ranges of the numbers that somebody measures, draws or types. They are wide: no good number is outside, and a number
/// that lost its decimal point or stands in the wrong column is. Every reader of files and options takes them from
/// here.
namespace paracal::plausible {

struct Range {
  double least, most;
  std::string_view unit = {};
  std::string_view why = {};  ///< in a refusal

  /// False for what is not a number.
  bool contains(double value) const { return value >= least && value <= most; }
};

/// "expected x_mm from -14000 to 14000 mm (ten times the reach of the robot), got 1e+08"; empty: it is in the range.
std::optional<std::string> complaint(std::string_view quantity, double value, const Range& range);

/// Of numbers that have a range of their own, which depends on others and is checked with these.
inline constexpr Range kFinite{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};

/// Below it no length, angle or limit is above zero for any instrument, mm, deg or rad.
inline constexpr double kNothing = 1e-9;

/// Places, lengths and distances read: pillars, instruments and spheres stand beside the robot, not in another hall.
constexpr Range length(double reach) { return {-10.0 * reach, 10.0 * reach, "mm", "ten times the reach of the robot"}; }
constexpr Range positive_length(double reach) {
  return {kNothing, 10.0 * reach, "mm", "ten times the reach of the robot"};
}

/// Dimensions of one robot or printer, by the median of them all: the one that is a slip of the pen is outside, and the
/// others are not. A plate may be a point.
Range dimension(std::vector<double> all);

/// What a part is off by, and what limits and tolerances allow.
constexpr Range error(double reach) { return {-reach, reach, "mm", "the reach of the robot"}; }
constexpr Range limit(double reach) { return {kNothing, reach, "mm", "the reach of the robot"}; }
inline constexpr Range kErrorDeg{-180.0, 180.0, "deg", "half a turn"};
inline constexpr Range kLimitDeg{kNothing, 180.0, "deg", "half a turn"};
inline constexpr Range kLimitRad{kNothing, std::numbers::pi, "rad", "half a turn"};
/// Of an option, which is read before the robot is.
inline constexpr Range kLimit{kNothing, 1e6};

/// Poses, joints and encoders, which may count turns.
inline constexpr Range kAngle{-36000.0, 36000.0, "deg", "a hundred turns"};

/// Coordinates of an instrument that stands anywhere: beyond it doubles no longer resolve 0.1 um.
inline constexpr Range kInstrument{-1e9, 1e9, "mm", "a thousand kilometres"};

/// Standard deviations that instruments state. Weights far outside leave the range of numbers.
inline constexpr Range kNoise{1e-5, 1e6, "", "no instrument is outside"};

/// Speeds and accelerations of joints, feeds.
inline constexpr Range kSpeed{kNothing, 1e7, "", "no drive is outside"};

/// Costs, in any money and by any law.
inline constexpr Range kCost{kNothing, 1e12};

/// What the files of a printer's firmware say of it, in mm, deg, steps or percent.
inline constexpr Range kPrinter{-1e5, 1e5, "", "no printer is larger than 100 m"};
inline constexpr Range kPositiveOfPrinter{kNothing, kPrinter.most, kPrinter.unit, kPrinter.why};

/// Components of directions and quaternions, of any length.
inline constexpr Range kDirection{-1e6, 1e6};

/// Counts and labels.
inline constexpr Range kCount{1.0, 1e6};

}  // namespace paracal::plausible
