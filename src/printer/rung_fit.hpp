#pragma once

// Private to printer: readings and priors as rows, and the fit of some numbers to them.

#include <Eigen/Core>
#include <optional>

#include "paracal/printer/ladder.hpp"

namespace paracal::detail {

/// Standard deviations of readings, mm.
struct ReadingNoise {
  double height = 0.0, distance = 0.0;
};

/// Rows [d r / d numbers | r] over standard deviations, heights before distances.
struct Rows {
  Eigen::MatrixXd by_numbers;  ///< with a column each of DeltaNumber
  Eigen::VectorXd residual;

  Eigen::Index count() const { return residual.size(); }
};

/// Predicted less measured. Empty where the geometry does not close at a reading.
std::optional<Rows> reading_rows(const DeltaGeometry& geometry, const DeltaReadings& readings,
                                 const ReadingNoise& noise);

/// What is known of a printer before it is measured, at a geometry.
Rows prior_rows(const DeltaGeometry& geometry, const DeltaGeometry& saved, bool has_distances,
                const LadderPriors& priors);

/// Weight of the square of a residual u, rho'(u) / 2 u, in rho(u) = 2 c^2 (sqrt(1 + u^2 / c^2) - 1), c = 3.
double soft_weight(double residual);

/// The numbers that a rung changes.
/// @param fits_radius  else it stays as at the start.
DeltaBasis rung_basis(Actuator actuator, Rung rung, bool fits_radius = true);

/// The least sum of rho over all rows; numbers outside of the basis stay as at the start.
/// @returns empty where the start does not close at a reading.
std::optional<DeltaGeometry> fit_numbers(const DeltaGeometry& start, const DeltaGeometry& saved,
                                         const DeltaReadings& readings, const DeltaBasis& basis,
                                         const ReadingNoise& noise, const LadderPriors& priors);

}  // namespace paracal::detail
