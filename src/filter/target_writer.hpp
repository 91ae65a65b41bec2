#pragma once

// Private to the filter: lines with corrected targets.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "target_line.hpp"

namespace paracal::io {

/// Puts corrected targets into lines. It knows what the controller was told, and so holds for axes that a line does not
/// state; in the frame of paths, which no G92 moves.
class TargetWriter {
 public:
  TargetWriter(std::string& out, std::span<const std::size_t> axes) : out_(out), axes_(axes) {}

  /// @param text  without its end.
  /// @param end  of the line; between the lines that it becomes another stands where it is empty.
  /// @param targets  where the pieces of its path end, at even t; one that is not divided has one.
  /// @returns how many lines there are more than before.
  std::size_t write(std::string_view text, std::string_view end, const TargetLine& line,
                    std::span<const AxisValues> targets);
  /// A line that calls the place it finds by other numbers: the controller stands where it was told.
  void call(std::string_view text, const TargetLine& line);
  /// Whether a motion is longer or shorter than it was, and so takes another time: nobody knows its feed.
  bool has_unknown_feed() const { return has_unknown_feed_; }
  /// A line that is passed through, behind one that states the program's feed where another is in force.
  /// @returns how many lines there are more than before.
  std::size_t pass(std::string_view text, std::string_view end, const TargetLine& line);

 private:
  struct Edit {
    TextRange replaced;
    std::size_t begin, end;  ///< in edited_
  };
  struct Piece;

  std::size_t restore_feed(std::string_view end, const TargetLine& line);
  void edit_line(std::string_view text, const TargetLine& line, const Piece& piece);
  void drop_arc(const TargetLine& line);
  void edit_axes(std::string_view text, const TargetLine& line, const AxisValues& target);
  std::optional<double> feed_of(const TargetLine& line, const Piece& piece, const AxisValues& from);
  std::optional<double> word_of_feed(const TargetLine& line, const Piece& piece, const AxisValues& from);
  void edit_feed(std::string_view text, const TargetLine& line, const Piece& piece, const AxisValues& from);
  void edit_extrusion(std::string_view text, const TargetLine& line, const Piece& piece);
  static void append_extrusion(std::string& to, std::string_view text, const TargetLine& line, const Piece& piece);
  void append_piece(std::string_view text, const TargetLine& line, const Piece& piece);
  void begin_edit(std::size_t begin, std::size_t end);
  void end_edit();
  void apply(std::string_view text);
  double held(std::size_t axis, const TargetLine& line) const;
  bool changes_nothing(const TargetLine& line, std::span<const AxisValues> targets) const;
  bool is_moved(std::size_t axis, const AxisValues& target, const TargetLine& line) const;

  std::string& out_;
  std::span<const std::size_t> axes_;  ///< that the robot moves
  AxisValues told_{};
  std::optional<double> told_feed_ = {};  ///< nothing: that which the program has stated
  bool has_unknown_feed_ = false;
  std::vector<Edit> edits_;  ///< in order of their places
  std::string edited_;       ///< their texts
};

}  // namespace paracal::io
