#pragma once

// Private to io: parameters and expressions of G-code, as far as the program itself gives their values.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gcode_block.hpp"

namespace paracal::io {

/// Values of #1, #<name>, and what is computed with them [kramer2000, 3.3; linuxcnc]. What the program has not assigned
/// may hold anything, and so may what follows from it; so do those of the controller's own, from #5000 on and #<_...>.
class GcodeParameters {
 public:
  /// @param text  a number, #1, #<name>, [...], or a function with its brackets; angles in deg.
  /// @returns its value; nothing where that is not known, or not finite.
  std::optional<double> value(std::string_view text) const;

  /// Words whose expressions are known become numbers; then what the block assigns counts.
  /// @returns whether the controller's own parameters are assigned: where program coordinates lie may change.
  bool apply(GcodeBlock& block);

  /// #5000 and on, #<_...>: what the program does not assign the controller does.
  /// @param text  #1 or #<name>.
  bool is_of_controller(std::string_view text) const;

  void forget() { known_.clear(); }

  /// A subprogram begins: #1, #2, ... hold its arguments, named parameters without underscore are unknown.
  /// @returns what leave() wants at its end.
  GcodeParameters enter(std::span<const double> arguments);
  /// What is the caller's own is as it was; all else stays.
  void leave(GcodeParameters&& callers);

 private:
  friend class ExpressionReader;
  /// @returns a name for the parameter: a number's digits, or <name>; empty where that is not known.
  std::string name_of(std::string_view text) const;

  /// @returns whether a subprogram has a parameter of this name of its own.
  static bool is_local(const std::string& name);

  std::map<std::string, double, std::less<>> known_;
};

}  // namespace paracal::io
