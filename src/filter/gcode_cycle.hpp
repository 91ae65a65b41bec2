#pragma once

// Private to io: canned cycles of drilling and boring, as the motions that they stand for.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode_block.hpp"

namespace paracal::io {

/// Where a cycle begins and what its numbers mean.
struct CycleStart {
  std::size_t normal = 2;  ///< axis along which it goes in
  double place = 0.0;      ///< where that axis stands, mm
  double shift = 0.0;      ///< place = stated * mm_per_unit + shift
  double mm_per_unit = 1.0;
  bool is_incremental = false;  ///< R counts from the initial level, the bottom from R

  double stated(double at_place) const;
};

/// G73, G81, G82, G83, G85 and G89 as LinuxCNC carries them out [linuxcnc, canned cycles]. What a cycle is told holds
/// until another motion is chosen; so do G98 and G99, and the path mode, which cycles set to exact stop (G61) for as
/// long as they take.
class GcodeCycle {
 public:
  /// A block chooses this cycle.
  /// @param code  10 times the code.
  /// @param goes_on  the block before it was in a cycle.
  void choose(int code, bool goes_on);
  void choose_return(bool to_clearance) { returns_to_clearance_ = to_clearance; }
  void choose_path_mode(const GcodeBlock& block, int code);
  void forget();

  /// Takes the numbers of a block in a cycle; they hold for the next ones, too.
  void take(const GcodeBlock& block, std::size_t normal);

  /// The motions of a block whose numbers have been taken.
  /// @param motion_at  where the cycle's own word stands in the block, if it does.
  /// @param lines  gets them.
  /// @returns why not; else empty.
  std::string_view expand(const GcodeBlock& block, std::optional<std::size_t> motion_at, const CycleStart& start,
                          std::vector<std::string>& lines);

  /// Whether the controller has been given motions for the last cycles, and so knows nothing of them.
  bool is_expanded() const { return is_expanded_; }
  /// A cycle that the controller is to carry out itself, with what the block leaves to those before it.
  /// @returns one line; none where the block says it all.
  std::vector<std::string> restated(const GcodeBlock& block, std::size_t normal);

  /// Whether a hole was pecked.
  bool has_pecked() const { return has_pecked_; }

 private:
  class Motions;
  struct Hole;

  bool pecks() const { return code_ == 730 || code_ == 830; }
  bool dwells() const { return code_ == 820 || code_ == 890; }
  std::string_view find_hole(const GcodeBlock& block, const CycleStart& start, Hole& hole) const;
  void drill(const Hole& hole, double back_off, Motions& motions);

  int code_ = 0;
  std::optional<double> clearance_ = {}, bottom_ = {}, peck_ = {}, dwell_ = {};  ///< R, Z, Q, P
  std::optional<double> initial_level_ = {};  ///< where the axis stood before the first of several cycles, mm
  std::optional<bool> returns_to_clearance_ = {};
  std::optional<std::string> path_mode_ = "G64";  ///< LinuxCNC's at power-on
  bool is_expanded_ = false;
  bool has_pecked_ = false;
};

}  // namespace paracal::io
