#pragma once

// Private to the filter: where the origin of a program's coordinates lies.

#include <array>
#include <cstdint>
#include <optional>

#include "paracal/filter/target_filter.hpp"
#include "target_path.hpp"

namespace paracal::io {

/// Coordinates of a program in the frame of its first target. Axis by axis,
///
///   machine = stated + system (G54 to G59.3) + tool (G43) + shift (G92).
///
/// Each part is known as a base and what stands from there: base 0 is the machine's, others stand for what is not known
/// (G55 of a controller nobody has asked, tool 3). Two of the same base differ by what is known.
class GcodeOrigin {
 public:
  GcodeOrigin(const WorkOffsets& offsets, std::optional<ToolTable> tools);

  // What these do to the coordinates of places that are known: what is to be added, or nothing: the place is lost.
  using Change = std::array<std::optional<double>, kAxes>;
  using Stated = std::array<std::optional<double>, kAxes>;  ///< mm and deg, of axes that a line states

  /// @param number  1 to 9: G54 to G59.3.
  /// @param begins  before the first motion: a program that names its system has begun in it.
  Change choose_system(std::size_t number, bool begins);
  /// G10 L2.
  /// @param number  of the system; 0: the one in force.
  /// @param stated  in the machine. An A, B or C of which nothing is known is 0.
  Change define_system(std::size_t number, const Stated& stated);
  /// G43 of a tool; without a table its length along Z is not known.
  /// @param tool  nothing: that which is in the spindle, which the program has not said.
  /// @returns nothing where the table does not have it.
  std::optional<Change> take_length_of(std::optional<int> tool);
  /// G43.1; axes that it does not state stay.
  Change take_length(const Stated& stated);
  /// G49
  Change drop_length();
  /// G92: places that are known are called otherwise; others make their axis begin anew.
  /// @param places  before, in the frame of the first target.
  Change call(const Stated& places, const Stated& stated);
  /// G92.1, G92.2
  Change drop_shift();
  /// G52, G92.3, M206: something else has moved these axes.
  Change move(const std::array<bool, kAxes>& axes);

  /// Where all of them lie may be another.
  void forget();

  /// A target is stated: its frame is that of all.
  void fix();
  bool is_fixed() const { return first_[kSystem].has_value(); }
  /// place = stated + shift; nothing for an axis of which that is not known.
  Change shift() const;
  /// Of coordinates of the machine (G53).
  Change shift_of_machine() const;
  /// Whether it is the tool's length alone that is not known.
  bool is_other_tool() const;

  /// Whether the tool in force has, or may have, an offset along X, Y or Z.
  bool has_tool_along(std::size_t axis) const { return !(now_[kTool][axis] == Offset{}); }

  /// Whether systems were defined without this one of A, B and C.
  bool takes_as_zero(std::size_t axis) const { return taken_as_zero_[axis]; }
  /// Whether lengths of tools are taken to be along Z alone, and part of the program's origin.
  bool takes_tool_as_given() const { return takes_tool_as_given_; }

  /// Whether a G92 was ended of which only the program has spoken.
  bool takes_no_shift_before() const { return takes_no_shift_before_; }

  bool operator==(const GcodeOrigin&) const = default;

 private:
  struct Offset {
    int base = 0;
    double value = 0.0;
    bool operator==(const Offset&) const = default;
  };
  using Offsets = std::array<Offset, kAxes>;
  enum Part : std::uint8_t { kSystem, kTool, kShift, kParts };

  static std::optional<double> difference(const Offset& one, const Offset& other);
  Change set(Part part, const Offsets& offsets);
  Offset unknown() { return {++bases_, 0.0}; }
  Offsets all_unknown();

  std::array<Offsets, WorkOffsets::kSystems + 1> systems_{};  ///< before them that of power-on, if another
  std::size_t system_;
  std::optional<ToolTable> tools_;
  std::array<Offsets, kParts> now_{};
  std::array<std::optional<Offsets>, kParts> first_{};  ///< of the first target
  int bases_ = 0;                                       ///< those below stand for something already
  std::array<bool, kAxes> taken_as_zero_{};
  bool takes_tool_as_given_ = false;
  bool knows_shift_before_, takes_no_shift_before_ = false;
};

}  // namespace paracal::io
