#pragma once

// Private to calibration: single facts that may be otherwise than stated.

#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "variance_table.hpp"

namespace paracal::detail {

/// A fact on trial.
struct SuspectedFact {
  Fact fact;
  std::string subject;  ///< "e_z of limb 2"
  double odds = 0.0;    ///< before the readings
  double off = 0.0;     ///< of a pose: how far, noises of a reading
  double worth = 0.0;   ///< logarithm of the odds that a linear model promises after them
};

/// Those that the readings speak for, most probable first: one error, one kind of error on all limbs, one joint centre,
/// one pose. With columns F of what a fact would add, the squares of the residuals drop by
///
///   T = t^T (F^T P F)^-1 t,   t = F^T z,
///
/// of all their Q over d degrees of freedom, and the likelihood rises by (d / 2) log(Q / (Q - T)) whatever their scale.
/// @param at  of the mode.
std::vector<SuspectedFact> suspected_facts(const StageFit& fit, const std::vector<Station>& stations,
                                           const VarianceTable& table, const VarianceTable::At& at);

}  // namespace paracal::detail
