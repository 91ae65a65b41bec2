#pragma once

// Private to io: where the origin of a program's coordinates lies.

#include <array>
#include <optional>

#include "paracal/filter/target_filter.hpp"
#include "target_path.hpp"

namespace paracal::io {

/// Coordinates of a program in the frame of its first target: place = stated + shift. Systems (G54 to G59.3) whose
/// origins in the machine are known go over into each other; of others, of tools and of what else moves the origin it
/// is only known whether they are those of the first target.
class GcodeOrigin {
 public:
  explicit GcodeOrigin(const WorkOffsets& offsets);

  // What these do to the coordinates of places that are known: what is to be added, or nothing: they are lost.
  using Change = std::optional<AxisValues>;

  /// @param number  1 to 9: G54 to G59.3.
  Change choose_system(std::size_t number);
  /// G10 L2.
  /// @param number  of the system; 0: the one in force.
  /// @param stated  mm and deg in the machine, of axes that it states; others stay. A C of which nothing is known is 0.
  Change define_system(std::size_t number, const std::array<std::optional<double>, kAxes>& stated);
  /// G43, G49.
  void compensate_tool(bool is_on);
  /// Something else has moved it.
  void move();
  /// All offsets may be others now.
  void forget_offsets();
  /// G92: the place is called otherwise, mm and deg.
  void call(std::size_t axis, double place, double stated);

  /// A target is stated: its frame is that of all.
  void fix();
  bool is_fixed() const { return first_.has_value(); }
  /// Whether coordinates are those of the first target, or there is none yet.
  bool is_first() const;
  AxisValues shift() const;
  /// Of coordinates of the machine (G53); nothing where that is not known.
  std::optional<AxisValues> shift_of_machine() const;

  /// Whether systems were defined without C.
  bool takes_rotation_as_zero() const { return takes_rotation_as_zero_; }

  bool operator==(const GcodeOrigin&) const = default;

 private:
  using Offset = std::optional<AxisValues>;

  struct First {
    std::size_t system;
    Offset offset;
    bool has_tool;
    int moves;
    bool operator==(const First&) const = default;
  };

  std::array<Offset, WorkOffsets::kSystems + 1> offsets_{};  ///< of systems; before them that of power-on, if another
  std::size_t system_;
  bool is_called_before_;  ///< G92 may hold from another program
  bool has_tool_ = false;
  bool takes_rotation_as_zero_ = false;
  int moves_ = 0;
  AxisValues called_{};  ///< G92 since the first target
  std::optional<First> first_ = {};
};

}  // namespace paracal::io
