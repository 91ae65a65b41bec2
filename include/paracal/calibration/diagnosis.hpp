#pragma once

#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// What is wrong with the input of a calibration.
struct Diagnosis {
  std::string text = {};  ///< a sentence: the cause, its equals, how well readings fit with and without it
  /// The most frugal first; others explain the readings equally well. Empty: some mistake is far more probable than the
  /// input as given, but none explains the readings.
  std::vector<std::string> causes = {};
  std::optional<double> rms_as_given = {};  ///< mm, of the residuals of a robust fit; empty: out of the robot's reach
  double rms_explained = 0.0;               ///< mm, with the cause undone; of no cause with the nearest undone
  double largest_noise = 0.0;  ///< mm, of sound input: above it readings scatter more than repeats or sigmas state
};

/// Tries the common input mistakes and names the one that explains the readings: units, mirrored or swapped axes, order
/// of limbs, another robot, shifted rows, signs of phi and of tilts, mounts, one or two wrong nominal dimensions, a
/// setup that moved.
///
/// Each is undone and the readings fitted anew: maximum a posteriori for Student's t instead of normal noise, whose
/// scale is found as well, so that gross errors do not decide. The criterion is the logarithm of the evidence,
/// the probability of the readings given robot, tolerances and mistake (Laplace's approximation). A mistake is named
/// only if it is far more probable than the input as given, even with one part out of its tolerance. With it corrected,
/// the readings must scatter about as they repeat, or as stated, and less than as given.
///
/// @returns nothing where the input as given explains the readings about as well as any mistake does.
/// @throws InvalidArgument for readings that make no sense (see check()).
std::optional<Diagnosis> diagnose(const Robot& robot, const Measurements& measurements,
                                  const CalibrationOptions& options = {});

}  // namespace paracal
