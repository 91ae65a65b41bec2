#pragma once

// Private to io: what a G-code controller remembers from line to line, as far as it decides where targets are.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "gcode_block.hpp"
#include "target_line.hpp"

namespace paracal::io {

/// Modal state of a program. What a line does not let know for certain is unknown until the program states it again.
class GcodeModes {
 public:
  /// @param axis_count  3: X, Y, Z; 4: and C.
  /// @param start  where the program's coordinates stand before the first line, if that is known.
  GcodeModes(std::size_t axis_count, const std::optional<AxisValues>& start);

  /// Takes the next block.
  /// @param target  gets the target, if the block is an absolute straight motion to one that is known in all axes.
  /// @returns why not, if the block moves, or may move, the axes; else empty.
  std::string_view take(const GcodeBlock& block, TargetLine& target);

  /// A line that cannot be read may have done anything but move the origin.
  void forget();

 private:
  enum class Motion : std::uint8_t { unknown, none, straight, curve, cycle };
  enum class Distance : std::uint8_t { unknown, absolute, incremental };

  /// Where program coordinates lie in the machine: a change of any of these moves them.
  struct Origin {
    int system = 0;  ///< 10 times the code, 540 to 593; 0: that of power-on
    bool tool_length = false;
    int shifts = 0;  ///< how often something else has moved it
    bool operator==(const Origin&) const = default;
  };

  /// What the codes of one block ask for beside modes.
  struct Request {
    std::optional<Motion> motion = {};  ///< stated in this block
    std::string_view refused = {};      ///< the block can do what is not known here
    bool takes_axes = false;            ///< axis words are parameters, not a target
    bool goes_elsewhere = false;        ///< ends where the program does not say
    bool has_m_code = false;
    bool is_setting = false;    ///< of M codes whose axis words are numbers of the firmware's, not places
    bool in_machine = false;    ///< G53
    bool then_lost = false;     ///< after the block, no place is known
    bool then_unknown = false;  ///< nor any mode
  };

  /// The axis words of a block.
  struct Axes {
    std::array<const GcodeWord*, kAxes> word{};
    std::size_t count = 0;
    bool has_duplicate = false, has_flag = false, has_number = false, has_expression = false;
  };

  Axes axes_of(const GcodeBlock& block) const;
  Request apply_codes(const GcodeBlock& block, const Axes& axes);
  void apply_g(int tenths, const GcodeBlock& block, const Axes& axes, Request& request);
  void apply_m(int tenths, const GcodeBlock& block, Request& request);
  void shift_origin();
  void lose(const Axes& axes);
  void lose_all() { place_.fill(std::nullopt); }
  std::string_view take_optional(const GcodeBlock& block, const Axes& axes);
  std::string_view move(const GcodeBlock& block, const Axes& axes, const Request& request, TargetLine& target);
  std::string_view move_to(const Axes& axes, Motion motion, TargetLine& target);
  void state(const Axes& axes, TargetLine& target);

  std::size_t axis_count_;
  Motion motion_ = Motion::none;
  Distance distance_ = Distance::absolute;
  std::optional<double> mm_per_unit_ = 1.0;
  Origin origin_;
  std::optional<Origin> first_origin_ = {};  ///< of the first motion: the one that the user's origin speaks of
  unsigned transforms_ = 0;                  ///< bits: the path is offset, turned or scaled
  std::array<std::optional<double>, kAxes> place_ = {};  ///< last stated, mm and deg
  std::array<bool, kAxes> passed_{};                     ///< stated by a line that was passed through
};

}  // namespace paracal::io
