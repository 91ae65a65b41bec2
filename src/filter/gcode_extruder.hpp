#pragma once

// Private to the filter: the extruder of a printer, in G-code.

#include <optional>

#include "gcode_block.hpp"
#include "gcode_dialect.hpp"
#include "target_line.hpp"

namespace paracal::io {

/// What a printer's program says of its extruder.
class Extruder {
 public:
  explicit Extruder(ExtruderRule rule) : rule_(rule) {}

  void forget() {
    is_relative_ = axes_are_relative_ = std::nullopt;
    place_.reset();
  }
  void forget_place() { place_.reset(); }
  /// M82, M83.
  void set_relative(bool is_relative);
  /// G90, G91.
  void set_distance(bool axes_are_relative);
  /// G92 E.
  void call(const GcodeWord& word) { place_ = word.is_number() ? std::optional(word.value) : std::nullopt; }
  /// @returns what a motion does; nothing where that is unknown.
  std::optional<ExtrusionOfLine> move(const GcodeBlock& block);

 private:
  std::optional<bool> is_relative() const;

  ExtruderRule rule_;
  std::optional<bool> is_relative_ = false, axes_are_relative_ = false;
  std::optional<double> place_ = {};
};

}  // namespace paracal::io
