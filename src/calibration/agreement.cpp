#include "agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "observation.hpp"
#include "paracal/error.hpp"
#include "scatter.hpp"
#include "square_root.hpp"
#include "tails.hpp"

namespace paracal::detail {
namespace {

CalibrationOptions as_for_a_fit(const ValidationOptions& options) {
  CalibrationOptions fit;
  fit.noise = options.noise;
  fit.noise_is_known = options.noise_is_known;
  fit.frame = options.frame;
  fit.rotation_zero = options.rotation_zero;
  fit.reflectors = options.reflectors;
  fit.scale_std = options.scale_std;
  return fit;
}

/// The readings of one machine, whose set-up alone is sought, where it fits best. The scale is none of it: it would
/// take what is wrong with the machine.
struct Placement {
  Placement(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
            const SourceErrors& errors)
      : observation(robot, measurements, options, {}) {
    const auto start = observation.start(errors);
    if (!start) throw Unreachable("validation: the machine does not close at one of the stations");
    setup = *start;
    if (setup.size() > 0) setup = solve_least_squares(with_priors(observation), *start).parameters;
    stations = observation.stations(setup);
  }

  Residual residual(const Group& group) const { return observation.residual(group, {*stations, setup}).reversed(); }

  Observation observation;
  Eigen::VectorXd setup;
  std::shared_ptr<const std::vector<StationState>> stations;
};

/// Sets the factor of the noise to what repeated visits show where nobody stated it, or where they contradict what was
/// stated.
/// @returns degrees of freedom of the noise; empty where nothing tells it.
std::optional<double> find_noise(Observation& observation, const Eigen::VectorXd& unknowns, Validation& validation) {
  constexpr double kFewest = 3.0, kContradiction = 1e-3;
  constexpr double kSmallest = 1e-2;  // readings without any noise still follow the machine to some 0.1 um
  const bool stated = all_stated(observation);
  const double if_believed = std::numeric_limits<double>::infinity();
  const Scatter visits = scatter_of_visits(observation, unknowns);
  if (visits.redundancy < kFewest || !std::isfinite(visits.sum))
    return stated ? std::optional(if_believed) : std::nullopt;
  const double factor = std::max(std::sqrt(visits.sum / visits.redundancy), kSmallest);
  if (stated) {
    if (chi_square_tail(visits.sum, visits.redundancy) > kContradiction) return if_believed;
    validation.notes.push_back(
        fmt::format("visits of a pose scatter {:.1f} times as much as the noise that is stated", factor));
  }
  observation.components().stated_noise = observation.components().unstated_noise = factor;
  return visits.redundancy;
}

/// The sum of squares that is left when set-up and errors z = L u, u ~ N(0, I), have been found.
double least_sum(const Observation& observation, const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& covariance) {
  const Eigen::Index setup = observation.nuisance_count(), n = observation.unknown_count();
  InformationRoot rows(n), all(n);
  if (!observation(unknowns, rows)) return 0.0;
  Eigen::MatrixXd block(n, n + 1);
  block << rows.root(), rows.reachable();
  block.middleCols(setup, n - setup) *= square_root(covariance);
  observation.add_priors(unknowns, all);
  for (Eigen::Index k = setup; k < n; ++k) all.add_prior(k, 0.0, 0.0, 1.0);
  all.add(block);
  const double beyond = rows.squared_residuals() - rows.reachable().squaredNorm();
  return beyond + all.squared_residuals() - all.reachable().squaredNorm();
}

/// Rows of readings less what finding their set-up takes; what is known of the set-up beforehand counts as read.
double freedom_of(const Observation& observation, const Eigen::VectorXd& unknowns) {
  InformationRoot readings(observation.unknown_count()), priors(observation.unknown_count());
  (void)observation(unknowns, readings);
  observation.add_priors(unknowns, priors);
  return static_cast<double>(readings.row_count() + priors.row_count() - observation.nuisance_count());
}

double chance_of(const Agreement& agreement) {
  if (std::isinf(agreement.noise_dof)) return chi_square_tail(agreement.chi_square, agreement.freedom);
  return fisher_tail(std::max(agreement.chi_square, 0.0) / agreement.freedom, agreement.freedom, agreement.noise_dof);
}

}  // namespace

void add_agreement(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                   const ValidationOptions& options, Validation& validation) {
  const CalibrationOptions fit = as_for_a_fit(options);
  const Placement nominal(robot, measurements, fit, {}), calibrated(robot, measurements, fit, known.errors);
  Observation observation(robot, measurements, fit, known.parameters, true);
  const Eigen::VectorXd unknowns = *observation.start(known.errors);
  const double freedom = freedom_of(observation, unknowns);
  if (freedom < 1.0) throw InvalidArgument("validation: expected more readings than their set-up has unknowns");
  const std::optional<double> noise_dof = find_noise(observation, unknowns, validation);
  observation.components().joint = known.expanded_joint_std();
  const bool is_known = known.covariance.size() > 0;
  const Eigen::MatrixXd covariance =
      is_known ? known.expanded_covariance()
               : Eigen::MatrixXd::Zero(std::ssize(known.parameters), std::ssize(known.parameters));
  const auto stations = observation.stations(unknowns);
  for (const Group& group : observation.groups()) {
    const ReadingSeries& series = observation.series_of(group);
    if (series.quantity() == Quantity::coordinate) continue;
    const VarianceComponents& factors = observation.components();
    const double sigma = observation.sigma_of(group) * (group.stated ? factors.stated_noise : factors.unstated_noise);
    const double variance = observation.variances(group, {*stations, unknowns}, covariance)(0);
    validation.readings.push_back({series.label(group.index, measurements.stations), nominal.residual(group).length(0),
                                   calibrated.residual(group).length(0), sigma,
                                   kCoverageFactor * sigma * std::sqrt(variance),
                                   series.quantity() == Quantity::distance});
  }
  if (!is_known || !noise_dof || (std::isfinite(*noise_dof) && freedom - *noise_dof < 1.0)) {
    validation.notes.emplace_back(is_known ? "no sigma is stated and too few poses were visited twice: whether the "
                                             "calibration's uncertainty holds cannot "
                                             "be told from these readings"
                                           : "the calibration states no uncertainty: whether it holds cannot be told");
    return;
  }
  Agreement agreement{
      .chi_square = least_sum(observation, unknowns, covariance), .freedom = freedom, .noise_dof = *noise_dof};
  if (std::isfinite(*noise_dof)) {  // repeats scatter as they do, by which the noise was told
    agreement.chi_square -= *noise_dof;
    agreement.freedom -= *noise_dof;
  }
  if (!std::isfinite(agreement.chi_square)) {
    validation.notes.emplace_back(
        "residuals over their sigmas leave the range of numbers: whether the calibration's uncertainty holds cannot be "
        "told");
    return;
  }
  agreement.chance = chance_of(agreement);
  validation.agreement = agreement;
}

}  // namespace paracal::detail
