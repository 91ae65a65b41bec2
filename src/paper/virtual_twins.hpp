#pragma once

// Private to report.

#include <array>
#include <vector>

#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::report::detail {

/// Where a largest error stands.
struct Place {
  int layer = 0;        ///< 0 top, 1 middle, 2 bottom: as io::Layer
  double radius = 0.0;  ///< mm

  static constexpr int kBottom = 2;
};

/// The largest errors over the 120 validation poses as an instrument reads them, a machine an entry.
struct Largest {
  std::vector<double> distance = {}, volumetric = {}, rotation = {};          ///< mm, mm, rad
  std::vector<Place> of_distance = {}, of_volumetric = {}, of_rotation = {};  ///< where they stand
};

/// Twins of the published machine: Table 4's position errors, tilt errors drawn from Table 2, measured at the paper's
/// 19 fine poses and calibrated by the paper's method. Every reading, of the 19 poses and of the validation, is off by
/// the published repeatability read as 3 sigma (0.017 mm a coordinate, 0.1 deg): what the paper averages over three
/// visits it does not say to be new approaches.
struct Twins {
  int count = 0;
  Largest before = {}, after = {};  ///< the fine calibration
  /// As Table 4, mm and rad.
  std::array<BySource<std::vector<double>>, kMaxLimbs> identified = {};
};

/// @param threads  0: all; every number of them gives the same twins.
Twins calibrate_twins(const Robot& robot, const SourceErrors& table4, int count, unsigned threads);

/// Tilt of the plate relative to home, |(eps_x, eps_y)| of the exact closure, over the same poses  [huang2016, section
/// 5.1]; a machine an entry, drawn as the twins are.
struct Tilts {
  std::vector<double> bottom = {};  ///< largest in the bottom layer, rad
  std::vector<Place> largest = {};  ///< where the largest of all layers stands
};

Tilts tilt_twins(const Robot& robot, const SourceErrors& table4, int count, unsigned threads);

}  // namespace paracal::report::detail
