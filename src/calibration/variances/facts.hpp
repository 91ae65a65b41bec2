#pragma once

// Private to calibration: the list of single facts that may be otherwise than stated, and which of them, alone or
// together, are worth a table of their own.

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
};

/// Facts that are tried together, by their places.
struct FactSet {
  std::vector<std::size_t> facts;
  std::vector<double> sizes = {};  ///< of each, as Fact::size
  std::vector<double> off = {};    ///< how far: noises of all readings of a pose; mm of a reflector
  double worth = 0.0;              ///< logarithm of the odds that a linear model promises after the readings
};

struct SuspectedFacts {
  std::vector<SuspectedFact> facts;
  std::vector<FactSet> sets;  ///< those that deserve a table
};

/// One error, one kind of error on all limbs, one joint centre, one pose, the place of a reflector, the noise of a
/// series; two or three of these together. With columns F of what facts would add, the squares of the residuals drop by
///
///   T = t^T (F^T P F)^-1 t,   t = F^T z,
///
/// of all their Q over d degrees of freedom, and the likelihood rises by (d / 2) log(Q / (Q - T)) whatever their scale.
/// P is that of a machine which is its geometry: joints that may stand anywhere would take up what is sought.
/// @param u  of the mode.
SuspectedFacts suspected_facts(const StageFit& fit, const Measurements& measurements, const CalibrationOptions& options,
                               const VarianceTable& table, const Eigen::VectorXd& u);

}  // namespace paracal::detail
