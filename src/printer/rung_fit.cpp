#include "rung_fit.hpp"

#include <cmath>

#include "paracal/numerics/least_squares.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// From so many standard deviations on, a residual counts by its size and no longer by its square.
constexpr double kSoft = 3.0;

/// The saved numbers. Distances determine the angles of the towers, which then count from their design angles.
DeltaNumbers expected_numbers(const DeltaGeometry& saved, bool has_distances) {
  DeltaNumbers expected = numbers_of(saved);
  if (!has_distances) return expected;
  const double turned = saved.tower_angle[2] - design_angle(saved.tower_angle[2]);
  for (std::size_t i = 0; i < 2; ++i) {
    expected(DeltaNumber::angle + static_cast<Eigen::Index>(i)) = design_angle(saved.tower_angle[i]) + turned;
  }
  return expected;
}

double soft_residual(double residual) { return residual / std::sqrt(0.5 * (1.0 + std::hypot(1.0, residual / kSoft))); }

/// Rows whose squares sum up to rho.
void add_soft(const Rows& rows, const DeltaBasis& basis, InformationRoot& root) {
  Eigen::RowVectorXd row(basis.cols() + 1);
  for (Eigen::Index k = 0; k < rows.count(); ++k) {
    const double u = rows.residual(k), soft = soft_residual(u);
    const double slope = soft != 0.0 ? u * soft_weight(u) / soft : 1.0;
    row << slope * rows.by_numbers.row(k) * basis, soft;
    root.add(row);
  }
}

/// Three lengths that are cut alike: each near their mean, their mean near the stated one.
void add_lengths(Rows& rows, Eigen::Index& at, Eigen::Index first, const DeltaNumbers& off, double alike,
                 double length) {
  const double mean = off.segment<3>(first).mean();
  for (Eigen::Index i = 0; i < 3; ++i) {
    rows.by_numbers.row(at).segment<3>(first).setConstant(-1.0 / (3.0 * alike));
    rows.by_numbers(at, first + i) += 1.0 / alike;
    rows.residual(at++) = (off(first + i) - mean) / alike;
  }
  rows.by_numbers.row(at).segment<3>(first).setConstant(1.0 / (3.0 * length));
  rows.residual(at++) = mean / length;
}

}  // namespace

double soft_weight(double residual) { return 1.0 / std::hypot(1.0, residual / kSoft); }

std::optional<Rows> reading_rows(const DeltaGeometry& geometry, const DeltaReadings& readings,
                                 const ReadingNoise& noise) {
  const auto heights = std::ssize(readings.heights), distances = std::ssize(readings.distances);
  Rows rows{Eigen::MatrixXd(heights + distances, DeltaNumber::count), Eigen::VectorXd(heights + distances)};
  Eigen::Index at = 0;
  for (const BedReading& one : readings.heights) {
    const auto place = nozzle(geometry, one.drops);
    if (!place) return std::nullopt;
    rows.by_numbers.row(at) = nozzle_jacobian(geometry, one.drops, *place).row(2) / noise.height;
    rows.residual(at++) = (place->z() - one.height) / noise.height;
  }
  for (const PrintedDistance& one : readings.distances) {
    const auto from = nozzle(geometry, one.from), to = nozzle(geometry, one.to);
    if (!from || !to) return std::nullopt;
    const NozzleJacobian motion = nozzle_jacobian(geometry, one.to, *to) - nozzle_jacobian(geometry, one.from, *from);
    rows.by_numbers.row(at) = (*to - *from).normalized().transpose() * motion / noise.distance;
    rows.residual(at++) = ((*to - *from).norm() - one.distance) / noise.distance;
  }
  return rows;
}

Rows prior_rows(const DeltaGeometry& geometry, const DeltaGeometry& saved, bool has_distances,
                const LadderPriors& priors) {
  constexpr Eigen::Index kAlone = 7, kLengths = 4;  // endstops, angles, radius and shoulder; rows of three lengths
  const bool rotary = geometry.actuator == Actuator::revolute;
  const Eigen::Index count = kAlone + kLengths * (rotary ? 2 : 1);
  Rows rows{Eigen::MatrixXd::Zero(count, DeltaNumber::count), Eigen::VectorXd::Zero(count)};
  const DeltaNumbers off = numbers_of(geometry) - expected_numbers(saved, has_distances);
  Eigen::Index at = 0;
  const auto add = [&](Eigen::Index number, double std) {
    rows.by_numbers(at, number) = 1.0 / std;
    rows.residual(at++) = off(number) / std;
  };
  for (Eigen::Index i = 0; i < 3; ++i) add(DeltaNumber::endstop + i, priors.endstop);
  for (Eigen::Index i = 0; i < 2; ++i) add(DeltaNumber::angle + i, to_radians(priors.tower));
  add(DeltaNumber::radius, priors.radius);
  add(DeltaNumber::shoulder, priors.endstop);
  const double length = has_distances ? priors.measured : priors.length;
  add_lengths(rows, at, DeltaNumber::rod, off, priors.alike, length);
  if (rotary) add_lengths(rows, at, DeltaNumber::arm, off, priors.alike, length);
  return rows;
}

DeltaBasis rung_basis(Actuator actuator, Rung rung, bool fits_radius) {
  const bool rotary = actuator == Actuator::revolute;
  DeltaBasis basis = DeltaBasis::Zero(DeltaNumber::count, DeltaNumber::count);
  Eigen::Index held = 0;
  const auto tell = [&](Eigen::Index first, Eigen::Index count) {
    basis.block(first, held, count, count).setIdentity();
    held += count;
  };
  if (rung >= Rung::height) tell(DeltaNumber::endstop, 3);
  if (rung >= Rung::height && rotary) tell(DeltaNumber::shoulder, 1);
  if (rung >= Rung::radius && fits_radius) tell(DeltaNumber::radius, 1);
  if (rung >= Rung::towers) tell(DeltaNumber::angle, 2);
  if (rung >= Rung::rods) tell(DeltaNumber::rod, 3);
  if (rung >= Rung::rods && rotary) tell(DeltaNumber::arm, 3);
  return basis.leftCols(held);
}

std::optional<DeltaGeometry> fit_numbers(const DeltaGeometry& start, const DeltaGeometry& saved,
                                         const DeltaReadings& readings, const DeltaBasis& basis,
                                         const ReadingNoise& noise, const LadderPriors& priors) {
  const DeltaNumbers first = numbers_of(start);
  const auto geometry_of = [&](const Eigen::VectorXd& unknowns) {
    return with_numbers(start, first + basis * unknowns);
  };
  const auto model = [&](const Eigen::VectorXd& unknowns, InformationRoot& root) {
    const DeltaGeometry geometry = geometry_of(unknowns);
    const auto rows = reading_rows(geometry, readings, noise);
    if (!rows) return false;
    add_soft(*rows, basis, root);
    add_soft(prior_rows(geometry, saved, !readings.distances.empty(), priors), basis, root);
    return true;
  };
  const LeastSquaresResult found =
      solve_least_squares(model, Eigen::VectorXd::Zero(basis.cols()), {.max_iterations = 100});
  if (found.status == LeastSquaresStatus::not_evaluable) return std::nullopt;
  return geometry_of(found.parameters);
}

}  // namespace paracal::detail
