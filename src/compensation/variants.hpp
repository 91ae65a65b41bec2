#pragma once

#include <vector>

#include "paracal/compensation/export.hpp"
#include "paracal/mechanism/machine.hpp"
#include "recording.hpp"

namespace paracal::compensation_detail {

/// Of the search in float: rounding then leaves more than further steps could find.
inline constexpr int kSingleSteps = 2;
inline constexpr int kVariantPoses = 5000;  ///< at which the error of a variant is measured, half of them on the rims

/// Steps of the search for the tilt: of the exact method the usual number.
int usual_steps(ExportVariant variant);

/// The largest distance of the plate from the commanded position, and of the slide, mm, with joints that a variant
/// finds: at kVariantPoses poses drawn from the workspace.
double variant_error(const Robot& robot, const Machine& built, ExportVariant variant);

/// The largest difference of the rates of the closed form from those of the exact method, relative to the largest of
/// their coordinate.
double rate_error(const Robot& robot, const Machine& built);

/// The machine with these errors.
/// @throws InvalidArgument unless has_compensator().
Machine built_for_export(const Robot& robot, const SourceErrors& errors);

/// The numbers of a machine in the order of an export, so that a controller can take those of a later calibration:
/// numbers, then a number that stands for their layout and the robot without errors, then
///
///   sum = layout + 1 numbers[0] + 2 numbers[1] + ...
struct ParameterSet {
  std::vector<std::string> names;
  std::vector<double> numbers;
  double layout, sum;
};
/// What joints are commanded by after the closure, for each limb.
using CommandCurves = std::array<DriveCurve<double>, kMaxLimbs>;
bool are_even(const CommandCurves& curves);
/// How many numbers of a curve an export has: first, spacing, sizes; turning, sine, cosine.
inline constexpr std::size_t kCurveNumbers = kDriveKnots + 5;

/// @param curves  which stand behind the numbers of the limbs where one is uneven.
ParameterSet parameter_set(const RecordedMachine& recorded, const Machine& nominal, const CommandCurves& curves);

}  // namespace paracal::compensation_detail
