#pragma once

// Private to calibration: what a validation is made of.

#include "paracal/calibration/validation.hpp"

namespace paracal::detail {

/// Adds the criteria of one pose, in the robot's frame, to the list:
///
///   AP = |G - commanded|,  RP = mean(l) + 3 S_l,  l_j = |x_j - G|,  G: barycentre of the repeats x_j
///   AD = |mean(D) - D_commanded|,  RD = 3 S_D,    D_j = |x_j - home|
void add_criteria(const std::string& name, const Pose& commanded, const std::vector<Pose>& repeats,
                  const PosePair& home, bool rotations, Iso9283& criteria);

/// Errors of distances and heights at the nominal and the calibrated machine.
struct ReadingErrors {
  PoseErrorSummary before, after;
};

/// Of readings of any kind against what a calibration says of itself: adds `readings` and `agreement`, and a note where
/// nobody can tell.
/// @throws InvalidArgument where the readings are no more than their set-up has unknowns.
ReadingErrors add_agreement(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                            const ValidationOptions& options, Validation& validation);

/// Holds the largest errors against their limits; without limits says whether they have shrunk by more than can be
/// measured. Reasons against the calibration, and notes, come to those that are there; accepted is what none is
/// against.
void check_limits(const Measurements& measurements, const ValidationOptions& options, Validation& validation);

}  // namespace paracal::detail
