#pragma once

// Private to calibration.

#include "paracal/calibration/validation.hpp"

namespace paracal::detail {

/// Adds the criteria of one pose, in the robot's frame, to the list:
///
///   AP = |G - commanded|,  RP = mean(l) + 3 S_l,  l_j = |x_j - G|,  G: barycentre of the repeats x_j
///   AD = |mean(D) - D_commanded|,  RD = 3 S_D,    D_j = |x_j - home|
void add_criteria(const std::string& name, const Pose& commanded, const std::vector<Pose>& repeats,
                  const PosePair& home, bool rotations, Iso9283& criteria);

}  // namespace paracal::detail
