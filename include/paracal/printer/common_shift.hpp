#pragma once

#include <array>
#include <string>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// The common error of all heights of a bed against the saved values; not a shape. A missing trigger height looks like
/// a bed that was moved. Values that follow a missing trigger height would drive the nozzle into the bed.
struct CommonShift {
  /// Above this it is stated, and followed only if the owner accepts it, mm. Below, owners adjust it by hand anyway;
  /// a sheet of paper and an inexact endstop cause as much.
  static constexpr double kLargestUnasked = 0.5;

  double value = 0.0;               ///< by which the bed's centre stands above where the saved values have it, mm
  bool is_stated = false;           ///< it is large, and a wrong file does not explain it
  bool is_accepted = false;         ///< by the owner: the saved values then include it
  std::array<double, 3> endstop{};  ///< of the saved values with it, mm

  /// Most likely first; empty where it is not stated.
  std::vector<std::string> likely_causes() const;
};

/// Rise of the nozzle at the bed's centre when `by` replaces `saved`, mm (below zero: it goes down). Tilt and bowl do
/// not count. NaN if one of the geometries does not close.
double common_shift(const DeltaGeometry& saved, const DeltaGeometry& by);

/// The geometry for a bed that is higher by `shift`: endstops, and shoulders of a rotary delta, are lower by it.
DeltaGeometry with_bed_higher(const DeltaGeometry& geometry, double shift);

/// The readings without the shift.
DeltaReadings without_shift(DeltaReadings readings, double shift);

}  // namespace paracal
