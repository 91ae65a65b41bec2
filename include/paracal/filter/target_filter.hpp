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

/// Lines that were left as they are although they hold, or may hold, a target.
struct PassedThrough {
  std::string_view reason;
  std::int64_t count = 0;
  std::int64_t first_line = 0;  ///< from 1
  /// How many of them count, and the first: at feed between two corrected targets, where the plate jumps by the
  /// correction, or a motion of the program's work (at feed across the part, extruding).
  std::int64_t between = 0, first_between = 0;
};

/// A target and what the controller is told instead.
struct CorrectedTarget {
  std::int64_t line = 0;  ///< from 1
  Pose wanted, target;    ///< in {O}

  /// mm
  double distance() const { return (target.position - wanted.position).norm(); }
};

/// What a block asks of the joint that it asks the most of, for its limits.
struct JointLoad {
  std::int64_t line = 0;                   ///< from 1
  std::size_t joint = 1;                   ///< from 1
  double speed = 0.0, acceleration = 0.0;  ///< largest along the block, rad/s and rad/s^2 or mm/s and mm/s^2
  double of_limit = 0.0;                   ///< the larger of both as a part of its limit
};

/// What a filter did.
struct FilterSummary {
  std::int64_t lines = 0;
  std::int64_t corrected = 0;  ///< targets that are now the corrected ones
  std::int64_t added = 0;  ///< lines: pieces of paths that one straight line between corrected ends would leave, feeds
  std::vector<PassedThrough> passed;
  /// Corrected targets outside of the robot's workspace, and the line of the first.
  std::int64_t outside = 0, first_outside = 0;
  /// The ten that the correction moves farthest, that one first.
  std::vector<CorrectedTarget> farthest;
  /// Of a robot with joint limits: blocks at feed that ask for more, the line of the first, and the ten that ask the
  /// most, the hardest first.
  std::int64_t over_limit = 0, first_over_limit = 0;
  std::vector<JointLoad> hardest;
  std::vector<std::string> assumed;  ///< what was taken for granted, in words

  bool complete() const { return passed.empty(); }
  /// What stands as it was is approach and retreat alone: homing, rapids, tool changes; before the first corrected
  /// target and after the last macros and motions along Z, too.
  bool whole() const {
    return std::ranges::all_of(passed, [](const PassedThrough& one) { return one.between == 0; });
  }
};

/// Where the origins of a controller's work coordinate systems lie in the coordinates of its machine.
struct WorkOffsets {
  static constexpr std::size_t kSystems = 9;  ///< G54 to G59, G59.1 to G59.3
  /// X, Y, Z in mm and C in deg; nothing where that is not known.
  std::array<std::optional<std::array<double, 4>>, kSystems> systems = {};
  std::size_t active = 0;   ///< before the first line, from 1; 0: unknown
  bool is_shifted = false;  ///< G92 holds before the first line, or that is not known

  bool operator==(const WorkOffsets&) const = default;
};

/// LinuxCNC's parameter file (linuxcnc.var), in mm and deg: a number and a value a line. A system that is turned (5230,
/// 5250, ...) or whose parameters are not all there is not known.
/// @throws InputFileError when a line is no such pair, or what it states makes no sense.
WorkOffsets read_work_offsets(const TextFile& file);

/// Offsets of tools by their numbers: X, Y, Z in mm and C in deg.
using ToolTable = std::map<int, std::array<double, 4>>;

/// LinuxCNC's tool table (tool.tbl), in mm: T1 P1 Z50.2 D6 ;comment. Axes that are not stated are 0.
/// @throws InputFileError for other lines, and for a tool that comes twice.
ToolTable read_tool_table(const TextFile& file);

/// Words that move nothing, one a line: macros (TIMELAPSE_TAKE_FRAME) and codes (G187, M905); # begins a comment.
/// @throws InputFileError for lines of several words, and for codes that move axes.
std::vector<std::string> read_harmless_words(const TextFile& file);

/// Who is to read a program, as far as controllers read programs differently.
enum class GcodeDialect : std::uint8_t {
  any,  ///< what they do not agree on is not known
  linuxcnc,
  klipper,
  marlin,
  reprapfirmware,
  fanuc_like,
};

/// What is known of a program, and how it is to be corrected.
struct GcodeOptions {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the program in {O}, mm: robot = program + origin
  std::optional<Pose> start = {};                    ///< before the first line, in the program's frame
  /// How far the plate may leave an arc or a straight line between corrected targets, mm.
  double chord = 0.01;
  GcodeDialect dialect = GcodeDialect::any;
  /// Macros and codes that leave the plate, the origin and modes as they are.
  std::vector<std::string> harmless = {};
  /// With it `origin` is that of a tool without length, and G43 adds the tool's; without it that of the first tool.
  std::optional<ToolTable> tools = {};
  /// G54 to G59.3 and G53 are corrected as far as these, or the program (G10 L2), say where they lie.
  /// Where they do not, no G92 is taken to hold before the first line.
  WorkOffsets offsets = {};
  unsigned threads = 0;  ///< of the correction; 0: one a core. The text does not depend on it.
};

/// G-code (RS-274, RepRap) with X, Y, Z and C (phi, deg) of its motions G0 to G3 replaced by the corrected target; arcs
/// become chords, lines along which the correction bends are divided; F is stated anew where a block would take another
/// time; everything else is left byte for byte. What cannot be corrected without guessing is passed through and
/// counted; docs/part-programs-reference.md has the list. Memory does not grow with the file.
/// @throws InputFileError when `in` cannot be read to its end, and with the line for what no filter may rewrite: O
/// words, parameters, expressions, canned cycles, turned, scaled or offset paths, offsets set on the way.
FilterSummary filter_gcode(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                           const GcodeOptions& options = {});

/// A pose table (CSV) with the numbers of its pose columns replaced by the corrected target; everything else is left
/// byte for byte. A row without as many fields as the header, or without finite numbers, is passed through and counted.
/// @throws InputFileError when the header does not hold the columns of a pose; of a robot with a slide, phi too.
/// @throws InputFileError also when `in` cannot be read to its end.
FilterSummary filter_pose_table(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                                unsigned threads = 0);

}  // namespace paracal::io
