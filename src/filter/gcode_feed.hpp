#pragma once

// Private to the filter: the feed of a program (F; G93, G94, G95).

#include <cstdint>
#include <optional>

#include "gcode_block.hpp"
#include "target_line.hpp"

namespace paracal::io {

/// What a program says of its feed. F counts along X, Y and Z, in the unit in force; of a line along which these rest,
/// along A, B and C, in deg [linuxcnc, feed rate].
class GcodeFeed {
 public:
  enum class Mode : std::uint8_t { unknown, per_time, inverse_time };

  /// @param counts_all_axes  F counts along all axes, mm and deg alike, as Fanuc's controllers have it.
  GcodeFeed(bool counts_all_axes, bool is_stated_by_motions)
      : counts_all_axes_(counts_all_axes), is_stated_by_motions_(is_stated_by_motions) {}

  /// A feed is stated anew in another mode.
  void set_mode(Mode mode);
  void forget(Mode mode);
  /// Another line begins, in which F has not been stated yet.
  void begin_line() { stated_ = {}; }
  /// The F word of a block, if it has one, in a unit of so many mm.
  void take(const GcodeBlock& block, std::optional<double> mm_per_unit);
  /// Of this line.
  /// @param is_governed  the block moves at feed.
  FeedOfLine of_line(bool is_governed, std::optional<double> mm_per_unit) const;

 private:
  bool counts_all_axes_, is_stated_by_motions_;
  Mode mode_ = Mode::per_time;
  std::optional<double> value_ = {};  ///< mm a minute, or what else F is
  StatedNumber stated_ = {};          ///< in this line
};

}  // namespace paracal::io
