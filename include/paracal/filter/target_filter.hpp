#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/compensation/target_correction.hpp"
#include "paracal/io/file.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal::io {

/// Unchanged lines that contain, or may contain, a target.
struct PassedThrough {
  std::string_view reason;
  std::int64_t count = 0;
  std::int64_t first_line = 0;  ///< from 1
  /// Number of working lines, and the first: at feed between two corrected targets (where the plate jumps by the
  /// correction), or work of the program (at feed across the part, extruding).
  std::int64_t between = 0, first_between = 0;
};

/// A target and the corrected target that is sent instead.
struct CorrectedTarget {
  std::int64_t line = 0;  ///< from 1
  Pose wanted, target;    ///< in {O}

  /// mm
  double distance() const { return (target.position - wanted.position).norm(); }
};

/// Result of a filter.
struct FilterSummary {
  std::int64_t lines = 0;
  std::int64_t corrected = 0;  ///< targets that were corrected
  std::int64_t added = 0;      ///< lines: pieces of divided paths, feeds
  std::vector<PassedThrough> passed;
  /// Corrected targets outside the robot's workspace, and the line of the first.
  std::int64_t outside = 0, first_outside = 0;
  /// The ten largest corrections, the largest first.
  std::vector<CorrectedTarget> farthest;
  /// For a robot with joint limits: blocks at feed that exceed them, and the line of the first.
  std::int64_t over_limit = 0, first_over_limit = 0;
  std::vector<std::string> assumed;  ///< assumptions, in words

  bool complete() const { return passed.empty(); }
  /// Only approach and retreat are unchanged: homing, rapids, tool changes; before the first corrected target and after
  /// the last also macros and motions along Z.
  bool whole() const {
    return std::ranges::all_of(passed, [](const PassedThrough& one) { return one.between == 0; });
  }
};

/// Numbers for the axes of a program: X, Y, Z in mm and A, B, C in deg.
using ProgramAxes = std::array<double, 6>;

/// Origins of a controller's work coordinate systems in its machine coordinates.
struct WorkOffsets {
  static constexpr std::size_t kSystems = 9;  ///< G54 to G59, G59.1 to G59.3
  /// Nothing if unknown.
  std::array<std::optional<ProgramAxes>, kSystems> systems = {};
  std::size_t active = 0;   ///< before the first line, from 1; 0: unknown
  bool is_shifted = false;  ///< G92 is active before the first line, or that is unknown

  bool operator==(const WorkOffsets&) const = default;
};

/// LinuxCNC's parameter file (linuxcnc.var), in mm and deg: a number and a value per line. A system that is rotated
/// (5230, 5250, ...) or lacks parameters is unknown.
/// @throws InputFileError for any other line, or implausible values.
WorkOffsets read_work_offsets(const TextFile& file);

/// Offsets of tools by their numbers.
using ToolTable = std::map<int, ProgramAxes>;

/// LinuxCNC's tool table (tool.tbl), in mm: T1 P1 Z50.2 D6 ;comment. Axes that are not stated are 0.
/// @throws InputFileError for other lines, and for a repeated tool.
ToolTable read_tool_table(const TextFile& file);

/// Words that move nothing, one per line: macros (TIMELAPSE_TAKE_FRAME) and codes (G187, M905); # begins a comment.
/// @throws InputFileError for lines of several words, and for codes that move axes.
std::vector<std::string> read_harmless_words(const TextFile& file);

/// The controller that reads a program: controllers differ in some codes.
enum class GcodeDialect : std::uint8_t {
  any,  ///< codes on which they differ are unknown
  linuxcnc,
  klipper,
  marlin,
  reprapfirmware,
  fanuc_like,
};

/// Facts about a program, and settings of its correction.
struct GcodeOptions {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the program in {O}, mm: robot = program + origin
  std::optional<Pose> start = {};                    ///< before the first line, in the program's frame
  /// Largest deviation of the plate from an arc or a straight line between corrected targets, mm.
  double chord = 0.01;
  GcodeDialect dialect = GcodeDialect::any;
  /// Macros and codes that do not change position, origin or modes.
  std::vector<std::string> harmless = {};
  /// With it `origin` is that of a tool of length 0, and G43 adds the length; without it that of the first tool.
  std::optional<ToolTable> tools = {};
  /// G54 to G59.3 and G53 are corrected if these offsets, or the program (G10 L2), state their origins.
  /// Otherwise no G92 is assumed to be active before the first line.
  WorkOffsets offsets = {};
  unsigned threads = 0;  ///< of the correction; 0: one per core. The text does not depend on it.
};

/// G-code (RS-274, RepRap) with the axes of its motions G0 to G3 replaced by the corrected target: X, Y, Z, the tilts
/// A, B, C of the plate, or C of an end-effector (phi), as far as the robot moves them. Arcs become chords, lines with
/// a curved correction are divided, and F is restated if a block would take a different time. Everything else stays
/// byte for byte. Lines that cannot be corrected with certainty are unchanged and counted; see
/// docs/part-programs-reference.md. Memory does not grow with the file.
/// @throws InputFileError when `in` cannot be read to its end, and with the line for code that a filter must not
/// change: O words, parameters, expressions, canned cycles, rotated, scaled or offset paths, offsets set in the
/// program, a tool length while the plate tilts.
FilterSummary filter_gcode(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                           const GcodeOptions& options = {});

/// A pose table (CSV) with the numbers of its pose columns replaced by the corrected target; everything else stays byte
/// for byte. A row with more or fewer fields than the header, or without finite numbers, is unchanged and counted.
/// @throws InputFileError when the header lacks a column of what the robot moves.
/// @throws InputFileError also when `in` cannot be read to its end.
FilterSummary filter_pose_table(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                                unsigned threads = 0);

}  // namespace paracal::io
