#pragma once

// Private to the filter: into how many pieces a path is cut, so that the straight lines which the controller draws
// between corrected targets keep the machine on it.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "target_line.hpp"

namespace paracal::io {

/// @returns the target of each place, both in the frame of paths; nothing where it cannot be corrected.
std::vector<std::optional<AxisValues>> corrected(const TargetCorrection& correction, const FilterSettings& settings,
                                                 std::span<const AxisValues> places);

/// Cuts paths into pieces of even length.
///
/// A piece that ends where it should still leaves its path between its ends: an arc by its sagitta, any path by how far
/// the correction c(t) = target - wanted bends,
///
///   max over t of |c(t) - ((1 - t) c(0) + t c(1))|,
///
/// turns of A, B and C counted at 100 mm from their axes. Both together stay within the chord.
class PathDivision {
 public:
  PathDivision(const TargetCorrection& correction, const FilterSettings& settings);

  struct Cut {
    std::uint32_t pieces = 1;
    std::string_view hindrance = {};  ///< why it is not cut as it should be; of an arc: why it cannot be corrected
  };
  std::vector<Cut> cut(std::span<const TargetLine> lines) const;

 private:
  struct Trial {
    std::size_t line;
    std::uint32_t pieces = 1;
  };

  Cut cut_arc(const TargetLine& line) const;
  bool may_bend(const TargetLine& line, std::uint32_t pieces) const;
  void cut_bent(std::span<const TargetLine> lines, std::vector<Trial> trials, std::vector<Cut>& cuts) const;

  const TargetCorrection& correction_;
  FilterSettings settings_;
  double straight_length_;  ///< mm: shorter lines hardly bend
};

}  // namespace paracal::io
