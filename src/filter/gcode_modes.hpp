#pragma once

// Private to io: what a G-code controller remembers from line to line, as far as it decides where targets are.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode_arc.hpp"
#include "gcode_block.hpp"
#include "gcode_cycle.hpp"
#include "gcode_extruder.hpp"
#include "gcode_loss.hpp"
#include "gcode_origin.hpp"
#include "target_line.hpp"

namespace paracal::io {

// Reasons that modes and motions share.
inline constexpr std::string_view kMalformed = "not a block of G-code, or a wrong checksum";
inline constexpr std::string_view kExpression = "parameters and expressions";
inline constexpr std::string_view kFlow = "subprograms, jumps and loops";
inline constexpr std::string_view kInverseTime = "a line to divide whose feed is an inverse time (G93), or may be";
inline constexpr std::string_view kUnknownCode = "a G code that is not known here";

/// Modal state of a program. What a line does not let know for certain is unknown until the program states it again.
class GcodeModes {
 public:
  /// @param axis_count  3: X, Y, Z; 4: and C.
  GcodeModes(std::size_t axis_count, const GcodeOptions& options);

  /// Takes the next block.
  /// @param target  gets what it states, if that is known in all axes.
  /// @returns why not, if the block moves, or may move, the axes; else empty.
  std::string_view take(const GcodeBlock& block, TargetLine& target);

  /// A line that cannot be read may have done anything but move the origin.
  void forget();
  /// Where systems lie may be another: the controller's parameters are assigned.
  void forget_systems();
  /// @returns whether anything was forgotten since it was last asked.
  bool has_forgotten() { return std::exchange(forgotten_, false); }

  /// Lines that stand for the block which was taken last; none: it stands for itself. They are to be taken next.
  std::vector<std::string> instead() { return std::exchange(instead_, {}); }
  /// All of them have been taken: for the program, the motion is still the cycle's.
  void resume_cycle() { motion_ = Motion::cycle; }
  bool has_pecked() const { return cycle_.has_pecked(); }
  bool took_rotation_of_systems_as_zero() const { return origin_.takes_rotation_as_zero(); }

  /// Whether targets were stated while C never was: it is taken as 0.
  bool took_rotation_as_zero() const { return rotation_ == Rotation::taken_as_zero; }

 private:
  enum class Motion : std::uint8_t { unknown, none, rapid, straight, clockwise, anticlockwise, spline, cycle };
  enum class Distance : std::uint8_t { unknown, absolute, incremental };
  enum class Rotation : std::uint8_t { unstated, taken_as_zero, stated };

  /// What the codes of one block ask for beside modes.
  struct Request {
    std::optional<Motion> motion = {};  ///< stated in this block
    TextRange motion_word = {};
    std::string_view refused = {};  ///< the block can do what is not known here
    bool takes_axes = false;        ///< axis words are parameters, not a target
    bool calls_here = false;        ///< axis words are what this place is called from now on
    bool goes_elsewhere = false;    ///< ends where the program does not say
    bool has_tool_length = false;   ///< H is of G43
    bool is_thread = false;         ///< goes elsewhere, and cuts
    bool has_m_code = false;
    bool ends_subprogram = false;        ///< M99
    bool is_setting = false;             ///< of M codes whose axis words are numbers of the firmware's, not places
    bool acts_after = false;             ///< M0, M2
    bool in_machine = false;             ///< G53
    AxisValues shift{};                  ///< place = stated + shift
    std::optional<Loss> then_lost = {};  ///< after the block, no place is known
    bool then_unknown = false;           ///< nor any mode
  };

  /// The axis words of a block.
  struct Axes {
    std::array<const GcodeWord*, kAxes> word{};
    std::size_t count = 0;
    bool has_duplicate = false, has_flag = false, has_number = false, has_expression = false;
  };

  using Places = std::array<std::optional<double>, kAxes>;

  Axes axes_of(const GcodeBlock& block) const;
  void put_in_order(const GcodeBlock& block);
  Request apply_codes(const GcodeBlock& block, const Axes& axes);
  void apply_g(int tenths, const GcodeBlock& block, const Axes& axes, Request& request);
  void apply_m(int tenths, const GcodeBlock& block, Request& request);
  void call_here_or_shift(const Axes& axes, Request& request);
  void shift_origin();
  void carry(const GcodeOrigin::Change& change);
  /// What a word states, mm or deg, where the unit is known.
  double in_mm(std::size_t axis, const GcodeWord& word) const;
  void define_system(const GcodeBlock& block, const Axes& axes);
  void lose(const Axes& axes);
  void lose_all(Loss loss);
  std::string_view take_rotation(const Axes& axes);
  std::string_view take_optional(const GcodeBlock& block, const Axes& axes, TargetLine& target);
  static bool may_be_work(const GcodeBlock& block, const Axes& axes, const Request& request, Motion motion);
  std::string_view move(const GcodeBlock& block, const Axes& axes, Request& request, TargetLine& target);
  std::string_view expand_cycle(const GcodeBlock& block, const Axes& axes, const Request& request,
                                std::string_view passed, TargetLine& target);
  std::string_view move_to(const GcodeBlock& block, const Axes& axes, const Request& request, TargetLine& target);
  std::string_view why_special(const GcodeBlock& block, const Request& request, Motion motion, TargetLine& target);
  std::string_view take_turns(const GcodeBlock& block, ArcWords& words) const;
  std::string_view why_unknown(const Places& from, Motion motion) const;
  void call_here(const Axes& axes, TargetLine& target);
  std::string_view add_arc(const GcodeBlock& block, const Request& request, bool is_clockwise, TargetPath& path) const;
  void state(const Axes& axes, const Request& request, TargetLine& target) const;
  DividedLine divided(const GcodeBlock& block, const Request& request, bool is_rapid);
  void restate_arc(const GcodeBlock& block, const Request& request, bool is_left, TargetLine& target) const;
  static bool is_work(const GcodeBlock& block, const Axes& axes, Motion motion);
  static bool is_arc(Motion motion) { return motion == Motion::clockwise || motion == Motion::anticlockwise; }

  std::size_t axis_count_;
  DialectTraits traits_;
  Motion motion_ = Motion::none;
  Distance distance_ = Distance::absolute;
  std::optional<double> mm_per_unit_ = 1.0;
  std::optional<ArcNormal> normal_ = 2;
  std::optional<bool> centre_is_place_ = false;
  std::optional<bool> inverse_time_ = false;
  Extruder extruder_;
  GcodeOrigin origin_;
  unsigned transforms_ = 0;           ///< bits: the path is offset, turned or scaled
  Places place_ = {};                 ///< last stated, mm and deg, in the frame of the first target
  std::array<Loss, kAxes> lost_{};    ///< why a place is not known
  std::array<bool, kAxes> passed_{};  ///< stated by a line that was passed through
  Rotation rotation_ = Rotation::stated;
  bool forgotten_ = false;
  bool saves_places_ = false;         ///< G60 came: G61 goes back
  bool arcs_are_lines_ = false;       ///< the controller may be in another motion mode than the program
  bool lost_rewritten_mode_ = false;  ///< was it, when something unknown came?
  GcodeCycle cycle_;
  std::vector<std::string> instead_ = {};
  std::vector<const GcodeWord*> codes_ = {};  ///< G and M of the block that is taken, in their order
};

}  // namespace paracal::io
