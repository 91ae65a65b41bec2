#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
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
  /// How many of them stand between corrected targets, and the first: there the plate jumps by the correction.
  std::int64_t between = 0, first_between = 0;
};

/// What a filter did.
struct FilterSummary {
  std::int64_t lines = 0;
  std::int64_t corrected = 0;  ///< targets that are now the corrected ones
  std::vector<PassedThrough> passed;

  bool complete() const { return passed.empty(); }
  /// Nothing stands as it was between corrected targets; before the first and after the last, as approach and retreat,
  /// it may.
  bool whole() const {
    return std::ranges::all_of(passed, [](const PassedThrough& one) { return one.between == 0; });
  }
};

/// Takes the filtered text piece by piece.
using TextSink = std::function<void(std::string_view)>;

/// Where program coordinates lie.
struct GcodeFrame {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the program in {O}, mm: robot = program + origin
  std::optional<Pose> start = {};                    ///< before the first line, in the program's frame
};

/// G-code (RS-274, RepRap) with X, Y, Z and C (phi, deg) of its absolute straight motions, G0 and G1, replaced by the
/// corrected target; everything else is left byte for byte. What cannot be corrected without guessing is passed through
/// and counted; docs/controllers.md has the list. Memory does not grow with the file.
/// @param threads  of the correction; 0: one a core. The text does not depend on it.
/// @throws InputFileError when `in` cannot be read to its end.
FilterSummary filter_gcode(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                           const GcodeFrame& frame = {}, unsigned threads = 0);

/// A pose table (CSV) with the numbers of its pose columns replaced by the corrected target; everything else is left
/// byte for byte. A row without as many fields as the header, or without finite numbers, is passed through and counted.
/// @throws InputFileError when the header does not hold the columns of a pose; of a robot with a slide, phi too.
/// @throws InputFileError also when `in` cannot be read to its end.
FilterSummary filter_pose_table(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                                unsigned threads = 0);

}  // namespace paracal::io
