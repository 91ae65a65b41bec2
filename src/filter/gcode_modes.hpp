#pragma once

// Private to the filter: what a G-code controller remembers from line to line, as far as it decides where targets are.

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "gcode_arc.hpp"
#include "gcode_block.hpp"
#include "gcode_dialect.hpp"
#include "gcode_extruder.hpp"
#include "gcode_feed.hpp"
#include "gcode_origin.hpp"
#include "target_line.hpp"

namespace paracal::io {

// Reasons that modes and motions share.
inline constexpr std::string_view kMalformed = "not a G-code block (remove checksums *NN: the host adds them)";

/// What to do about drilling, loops and subprograms.
inline constexpr std::string_view kExpand =
    "expand it in the post-processor, or use the LinuxCNC component (--target linuxcnc)";

/// A program that no filter may rewrite, wherever the line stands: what it does is known only to who runs it, or is
/// another motion than it states.
class RefusedProgram : public std::runtime_error {
 public:
  /// @param what  stands in the line, and @param advice  what to do.
  RefusedProgram(std::string_view what, std::string_view advice)
      : std::runtime_error(std::string(what)), advice_(advice) {}
  std::string_view advice() const { return advice_; }

 private:
  std::string_view advice_;  ///< outlives this
};

/// Modal state of a program. What a line does not let know for certain is unknown until the program states it again.
class GcodeModes {
 public:
  /// @param axes  of the robot, in the program's frame.
  GcodeModes(const RobotAxes& axes, const GcodeOptions& options);

  /// Takes the next block.
  /// @param target  gets what it states, if that is known in all axes.
  /// @returns why not, if the block moves, or may move, the axes; else empty.
  /// @throws RefusedProgram
  std::string_view take(const GcodeBlock& block, TargetLine& target);

  /// A line that cannot be read may have done anything but move the origin.
  void forget();

  bool took_as_zero_in_systems(std::size_t axis) const { return origin_.takes_as_zero(axis); }
  /// Whether targets were stated while this one of A, B and C never was: it is taken as 0.
  bool took_as_zero(std::size_t axis) const { return rotations_[axis] == Rotation::taken_as_zero; }
  bool took_no_shift_before() const { return origin_.takes_no_shift_before(); }
  bool took_tool_as_given() const { return origin_.takes_tool_as_given(); }
  /// Whether targets rely on G90 and G21 that a macro may have changed.
  bool trusted_macros() const { return trusted_macros_; }

 private:
  enum class Motion : std::uint8_t { unknown, none, rapid, straight, clockwise, anticlockwise };
  enum class Distance : std::uint8_t { unknown, absolute, incremental };
  enum class Rotation : std::uint8_t { unstated, taken_as_zero, stated };

  /// What the codes of one block ask for beside modes.
  struct Request {
    std::optional<Motion> motion = {};  ///< stated in this block
    TextRange motion_word = {};
    bool is_malformed = false;
    bool takes_axes = false;       ///< axis words are parameters, not a target
    bool calls_here = false;       ///< axis words are what this place is called from now on
    bool goes_elsewhere = false;   ///< ends where the program does not say
    bool is_idle = false;          ///< and works nowhere on the way: homing
    bool has_tool_length = false;  ///< H is of G43
    bool is_thread = false;        ///< goes elsewhere, and cuts
    bool is_dwell = false;         ///< G4
    bool has_m_code = false;
    bool is_macro = false;      ///< M98, M810 of printers
    bool is_setting = false;    ///< of M codes whose axis words are numbers of the firmware's, not places
    bool acts_after = false;    ///< M0, M2
    bool in_machine = false;    ///< G53
    AxisValues shift{};         ///< place = stated + shift
    bool then_lost = false;     ///< after the block, no place is known
    bool then_unknown = false;  ///< and no mode
  };

  /// The axis words of a block.
  struct Axes {
    std::array<const GcodeWord*, kAxes> word{};
    std::size_t count = 0;
    bool has_duplicate = false, has_flag = false, has_number = false;
  };

  using Places = std::array<std::optional<double>, kAxes>;

  Axes axes_of(const GcodeBlock& block) const;
  void put_in_order(const GcodeBlock& block);
  Request apply_codes(const GcodeBlock& block, const Axes& axes);
  void apply_g(int tenths, const GcodeBlock& block, const Axes& axes, Request& request);
  void apply_m(int tenths, const GcodeBlock& block, Request& request);
  void choose_tool(const GcodeBlock& block, Request& request);
  void take_tool_length(const GcodeBlock& block);
  void take_tool_length(const Axes& axes);
  void refuse_axis_words(const Axes& axes) const;
  void refuse_missing_numbers(const GcodeBlock& block, const Axes& axes, const Request& request) const;
  void call_here_or_shift(const Axes& axes, Request& request);
  void carry(const GcodeOrigin::Change& change);
  void move_origin(const Axes& axes);
  /// What a word states, mm or deg, where the unit is known.
  double in_mm(std::size_t axis, const GcodeWord& word) const;
  GcodeOrigin::Stated in_mm(const Axes& axes) const;
  void define(const GcodeBlock& block, const Axes& axes, Request& request);
  void define_system(const GcodeBlock& block, const Axes& axes);
  void lose(const Axes& axes);
  void lose_all();
  std::string_view take_rotations(const Axes& axes);
  std::string_view take_macro();
  std::string_view take_optional(const GcodeBlock& block, const Axes& axes, TargetLine& target);
  std::string_view move(const GcodeBlock& block, const Axes& axes, Request& request, TargetLine& target);
  std::string_view find_shift(Request& request, Motion motion) const;
  std::string_view move_to(const GcodeBlock& block, const Axes& axes, const Request& request, TargetLine& target);
  std::string_view why_special(const GcodeBlock& block, const Request& request, Motion motion, TargetLine& target);
  std::string_view take_turns(const GcodeBlock& block, ArcWords& words) const;
  std::string_view why_unknown(const Places& from, Motion motion) const;
  bool turns_tool(const TargetPath& path) const;
  void call_here(const Axes& axes, TargetLine& target);
  std::string_view add_arc(const GcodeBlock& block, const Request& request, bool is_clockwise, TargetPath& path) const;
  void state(const Axes& axes, const Request& request, TargetLine& target) const;
  DividedLine divided(const GcodeBlock& block, const Request& request, bool is_rapid);
  void restate_arc(const GcodeBlock& block, const Request& request, bool is_left, TargetLine& target) const;
  static TargetLine::Weight weight_of(const GcodeBlock& block, const Axes& axes, Motion motion);
  static bool is_arc(Motion motion) { return motion == Motion::clockwise || motion == Motion::anticlockwise; }
  bool moves_at_feed(Motion motion) const { return motion != Motion::rapid || traits_.is_printer; }

  RobotAxes robot_axes_;
  std::string other_axes_ = "UVW";  ///< letters of axes that the robot does not move
  DialectTraits traits_;
  Motion motion_ = Motion::none;
  Distance distance_ = Distance::absolute;
  std::optional<double> mm_per_unit_ = 1.0;
  std::optional<ArcNormal> normal_ = 2;
  std::optional<bool> centre_is_place_ = false;
  GcodeFeed feed_;
  Extruder extruder_;
  GcodeOrigin origin_;
  Places place_ = {};                        ///< last stated, mm and deg, in the frame of the first target
  std::array<bool, kAxes> passed_{};         ///< stated by a line that was passed through
  std::array<Rotation, kAxes> rotations_{};  ///< of A, B and C; of others always stated
  std::optional<int> prepared_tool_ = {}, tool_ = {};
  std::optional<double> unit_of_tool_ = {};  ///< in force when the tool's length was stated last
  bool has_moved_ = false;                   ///< a block has asked for a motion
  bool arcs_are_lines_ = false;              ///< the controller may be in another motion mode than the program
  bool lost_rewritten_mode_ = false;         ///< was it, when something unknown came?
  bool relies_on_macro_ = false, trusted_macros_ = false;
  std::vector<const GcodeWord*> codes_ = {};  ///< G and M of the block that is taken, in their order
};

}  // namespace paracal::io
