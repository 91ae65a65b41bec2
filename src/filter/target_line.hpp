#pragma once

// Private to the filter: the part that filters of targets share, whatever the format. A format reads lines and says
// where numbers of a target stand; what is common corrects the targets of many lines at once and writes their numbers.

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/line_reader.hpp"
#include "paracal/filter/target_filter.hpp"
#include "target_path.hpp"

namespace paracal::io {

/// Where something stands in a line.
struct TextRange {
  std::size_t begin = 0, end = 0;

  bool is_empty() const { return begin == end; }
};

/// A number in a line.
struct StatedNumber {
  std::size_t begin = 0, end = 0;
  double value = 0.0;  ///< in the unit of the line

  bool is_stated() const { return begin != end; }
};

/// What the extruder of a printer does on a line.
struct ExtrusionOfLine {
  StatedNumber stated;
  double from = 0.0;         ///< before the line; of a relative one 0
  bool is_relative = false;  ///< M83
};

/// The feed on a line of G-code.
struct FeedOfLine {
  enum class Rule : std::uint8_t { unknown, per_time, inverse_time };
  Rule rule = Rule::unknown;
  bool is_governed = false;           ///< the line moves at feed
  bool counts_all_axes = false;       ///< F counts along A, B and C, too, deg as mm
  bool is_stated_by_motions = false;  ///< F alone is no line: G1 F600
  std::optional<double> value = {};   ///< in force for the program, in the unit of the line
  StatedNumber stated = {};

  /// What F counts of a motion: its length in mm, or how far A, B and C turn where X, Y and Z rest, in deg; of both the
  /// whole where all axes count.
  double counted(double along, double turned, double mm_per_unit) const {
    constexpr double kAtRest = 1e-6;  // mm: for controllers this is no motion
    const double length = along / mm_per_unit;
    return counts_all_axes ? std::hypot(length, turned) : along > kAtRest ? length : turned;
  }
  bool restates() const { return rule == Rule::per_time && value.has_value(); }
};

/// What is to be known of a line of G-code that becomes several lines.
struct DividedLine {
  std::string_view hindrance = {};  ///< why it cannot; else empty
  TextRange motion = {};            ///< the word G0 to G3; empty, where it would stand, if the mode holds
  bool is_rapid = false;
  std::array<TextRange, 5> arc_words = {};  ///< I, J, K, R, P, as they stand; empty ones are none
  ExtrusionOfLine extrusion = {};
  bool stands_last = false;  ///< its other words act after the motion: M0, M2
};

/// A line that states a target.
struct TargetLine {
  enum class Kind : std::uint8_t {
    none,
    target,
    here,  ///< its numbers say what the place that the controller holds is called from now on: G92
    left,  ///< passed through; but for its motion and its feed, if what it would find in force is another
  };
  Kind kind = Kind::none;
  std::size_t index = 0;    ///< among the lines that are read together
  std::int64_t number = 0;  ///< in the file, from 1
  TargetPath path{};        ///< wanted; `to` is the target
  std::array<StatedNumber, kAxes> stated{};
  double mm_per_unit = 1.0;

  // Only of G-code, where axes that are not stated keep their last value.
  AxisValues shift{};                ///< path = stated + shift, mm and deg
  bool is_incremental = false;       ///< path.to = path.from + stated
  bool starts_known = false;         ///< so does path.from
  std::array<bool, kAxes> passed{};  ///< the controller was told path.from in a line that was passed through
  bool may_insert = false;           ///< other axes may be added
  std::size_t insert_at = 0;         ///< behind the last axis word
  bool with_blank = false, in_lower_case = false;  ///< how added words are written
  std::string_view restated = {};                  ///< of a line that is left: "2", "3" of its motion's word
  /// It is passed through, and what it does now is not what it did in the program, whether a corrected target follows
  /// or not.
  bool breaks = false;
  enum class Weight : std::uint8_t {
    idle,      ///< rapid, homing, a tool change: touches nothing
    approach,  ///< or retreat, at the ends of a program; between corrected targets more: along Z at feed, a macro
    work,      ///< at feed across the part, extruding, or what may be that
  };
  Weight weight = Weight::approach;
  FeedOfLine feed = {};
  DividedLine divided = {};

  /// How long it takes at its feed; nothing where that is not known.
  std::optional<double> seconds() const {
    constexpr double kMinute = 60.0;  // s
    const double length = feed.counted(path.length(), path.turned(), mm_per_unit);
    const bool is_known = feed.is_governed && starts_known && feed.value && *feed.value > 0.0 && length > 0.0;
    if (!is_known) return std::nullopt;
    return kMinute * (feed.rule == FeedOfLine::Rule::inverse_time ? 1.0 : length) / *feed.value;
  }
};

/// What differs between formats.
class TargetFormat {
 public:
  TargetFormat() = default;
  TargetFormat(const TargetFormat&) = delete;
  TargetFormat& operator=(const TargetFormat&) = delete;
  virtual ~TargetFormat() = default;

  /// Reads the next line.
  /// @param text  without the line end.
  /// @param target  has its number; gets what the line states.
  /// @returns why not, if it may hold a target and none is stated; else empty.
  virtual std::string_view read(std::string_view text, TargetLine& target) = 0;
  /// @throws InputFileError when something was missing.
  virtual void finish() const {}
  /// What was taken for granted.
  virtual std::vector<std::string> assumed() const { return {}; }
};

struct FilterSettings {
  RobotAxes axes;
  double chord = 0.0;  ///< mm; 0: straight lines are not divided
  unsigned threads = 0;
};

FilterSummary filter(LineReader& in, const TextSink& out, TargetFormat& format, const TargetCorrection& correction,
                     const FilterSettings& settings);

}  // namespace paracal::io
