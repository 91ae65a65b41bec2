#pragma once

#include <array>
#include <string>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// What all heights of a bed have in common against the saved values. It is no shape: a trigger height that nobody
/// stated looks like a bed that was moved, and to follow it where it is the former drives the nozzle into the bed.
struct CommonShift {
  /// Above this it is stated, and taken for real only if the owner says so, mm. Below, it is what an owner adjusts by
  /// hand anyway, and as much as a sheet of paper and a sloppy endstop make.
  static constexpr double kLargestUnasked = 0.5;

  double value = 0.0;               ///< by which the bed's centre stands above where the saved values have it, mm
  bool is_stated = false;           ///< it is large, and no wrong file explains it
  bool is_accepted = false;         ///< the owner says that the bed stands there: the saved values count with it
  std::array<double, 3> endstop{};  ///< of the saved values with it, mm

  /// Most likely first; empty where it is not stated.
  std::vector<std::string> likely_causes() const;
};

/// Height of the bed's centre as `by` has it, where `saved` believes it, mm: how much the nozzle rises there (below
/// zero: goes down) when `by` replaces `saved`. Neither tilt nor bowl count in it. NaN where either does not close.
double common_shift(const DeltaGeometry& saved, const DeltaGeometry& by);

/// The geometry of a bed that stands so much higher: endstops, and shoulders of a rotary delta, that much lower.
DeltaGeometry with_bed_higher(const DeltaGeometry& geometry, double shift);

/// Readings of the same shape above a bed that does not stand higher.
DeltaReadings without_shift(DeltaReadings readings, double shift);

}  // namespace paracal
