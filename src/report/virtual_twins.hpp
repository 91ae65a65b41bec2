#pragma once

// Private to report.

#include <array>
#include <vector>

#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::report::detail {

/// Where a largest error stands.
struct Place {
  int layer = 0;        ///< 0 top, 1 middle, 2 bottom
  double radius = 0.0;  ///< mm
};

/// Twins of the published machine: Table 4's position errors, tilt errors drawn from Table 2, measured at the paper's
/// 19 fine poses (each three times with 17 um a coordinate, the mean retained) and calibrated by the paper's method.
struct Twins {
  int count = 0;
  std::vector<double> distance = {}, volumetric = {}, rotation = {};  ///< largest after calibration, mm and rad
  std::vector<Place> worst_distance = {}, worst_volumetric = {}, worst_rotation = {};  ///< where they stand
  /// As Table 4, mm and rad.
  std::array<std::array<std::vector<double>, kPositionSourceCount>, kMaxLimbs> identified = {};
};

Twins calibrate_twins(const Robot& robot, const SourceErrors& table4, int count);

/// Quantile of a sample that is not empty.
double quantile(std::vector<double> values, double share);

}  // namespace paracal::report::detail
