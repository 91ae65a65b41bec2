#include "validation_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "calibration/fit/placement.hpp"
#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "numerics/square_root.hpp"
#include "paracal/error.hpp"
#include "visits.hpp"

namespace paracal::detail {
namespace {

/// Places of the set-up's unknowns but the scales of instruments.
std::vector<Eigen::Index> columns_without_scales(const Observation& observation) {
  const std::vector<Eigen::Index> scales = observation.scale_columns();
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < observation.nuisance_count(); ++k) {
    if (std::ranges::find(scales, k) == scales.end()) columns.push_back(k);
  }
  return columns;
}

/// The set-up that was fitted without scales, among the unknowns of the same readings with scales: a dial that is askew
/// by a degree is too far from straight for one linear step.
void take_set_up(const Placement& fitted, const Observation& observation, Eigen::VectorXd& unknowns) {
  Eigen::Index next = 0;
  for (const Eigen::Index column : columns_without_scales(observation)) unknowns(column) = fitted.setup(next++);
}

/// Sets the factor of the noise to what repeated visits show where nobody stated it, or where they contradict what was
/// stated.
/// @returns degrees of freedom of the noise; empty where nothing tells it.
std::optional<double> find_noise(Observation& observation, const Eigen::VectorXd& unknowns, Validation& validation) {
  constexpr double kSmallest = 1e-2;  // readings without any noise still follow the machine to some 0.1 um
  const bool stated = all_stated(observation);
  const auto noise = noise_of_visits(scatter_of_visits(observation, unknowns), stated);
  if (!noise) return std::nullopt;
  if (std::isinf(noise->dof)) return noise->dof;
  if (stated) {
    validation.notes.push_back(fmt::format(
        "repeated visits of a pose scatter {:.1f} times as much as the stated noise: check the stated sigma",
        noise->factor));
  }
  observation.let_noise_be(std::max(noise->factor, kSmallest));
  return noise->dof;
}

/// The sum of squares that is left when set-up and errors z = L u, u ~ N(0, I), have been found, and its degrees of
/// freedom: the readings' rows less what finding their set-up takes; what is known of it beforehand counts as read.
Scatter disagreement(const Observation& observation, const Eigen::VectorXd& unknowns,
                     const Eigen::MatrixXd& covariance) {
  const Eigen::Index setup = observation.nuisance_count(), n = observation.unknown_count();
  InformationRoot rows(n), all(n);
  (void)observation(unknowns, rows);
  observation.add_priors(unknowns, all);
  const auto freedom = static_cast<double>(rows.row_count() + all.row_count() - setup);
  Eigen::MatrixXd block(n, n + 1);
  block << rows.root(), rows.reachable();
  block.middleCols(setup, n - setup) *= square_root(covariance);
  for (Eigen::Index k = setup; k < n; ++k) all.add_prior(k, 0.0, 0.0, 1.0);
  all.add(block);
  const double beyond = rows.squared_residuals() - rows.reachable().squaredNorm();
  return {beyond + all.squared_residuals() - all.reachable().squaredNorm(), freedom};
}

/// How readings move when source errors, or the scale of the instruments, are other than stated and the set-up follows.
/// With rows [J_a | J_e], a the set-up and e the rest, whose information a fit of the set-up has the root R,
///
///   d v / d e = J_e - J_a S,   S = R_aa^-1 R_ae,    noise left: 1 - |R_aa^-T J_a^T|^2
///
/// so that what a set-up takes up, as a plane does the height of the whole robot, is no uncertainty of what is left.
class FollowingSetUp {
 public:
  /// @param observation  while its joints are where the model has them.
  FollowingSetUp(const Observation& observation, const Eigen::VectorXd& unknowns)
      : set_up_(columns_without_scales(observation)), rest_(observation.scale_columns()) {
    for (Eigen::Index k = observation.nuisance_count(); k < observation.unknown_count(); ++k) rest_.push_back(k);
    InformationRoot all(observation.unknown_count());
    (void)with_priors(observation)(unknowns, all);
    const Eigen::MatrixXd root = all.root();
    const auto n = static_cast<Eigen::Index>(set_up_.size());
    Eigen::MatrixXd ordered(root.rows(), root.cols());
    ordered << root(Eigen::all, set_up_), root(Eigen::all, rest_);
    const Eigen::MatrixXd upper = upper_of_qr(ordered);
    inverse_.resize(n, n);  // Eigen decomposes nothing that is empty
    if (n > 0) inverse_ = pseudo_inverse(upper.topLeftCorner(n, n));
    follows_ = product(inverse_, upper.topRightCorner(n, root.cols() - n));
  }

  /// Of one number, over its noise: what is left of the noise, and of the rest.
  /// @param row  [J_a | J_e | v] in the order of the unknowns.  @param covariance  of the rest.
  struct Left {
    double noise = 1.0, rest = 0.0;
  };
  Left left(const Eigen::RowVectorXd& row, const Eigen::MatrixXd& covariance) const {
    const Eigen::RowVectorXd by_set_up = row(set_up_), by_rest = row(rest_) - product(by_set_up, follows_);
    return {std::max(1.0 - product(by_set_up, inverse_).squaredNorm(), 0.0),
            product(by_rest, covariance).row(0).dot(by_rest)};
  }

 private:
  std::vector<Eigen::Index> set_up_, rest_;  ///< columns; the scales of instruments are of the rest, and stand first
  Eigen::MatrixXd inverse_, follows_;        ///< R_aa^-1 and S
};

/// Of the scales of the instruments and the source errors.
Eigen::MatrixXd with_scales(const Observation& observation, double scale_std, const Eigen::MatrixXd& covariance) {
  const auto scales = static_cast<Eigen::Index>(observation.scale_columns().size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(scales + covariance.rows(), scales + covariance.rows());
  all.topLeftCorner(scales, scales).diagonal().setConstant(scale_std * scale_std);
  all.bottomRightCorner(covariance.rows(), covariance.cols()) = covariance;
  return all;
}

double chance_of(const Agreement& agreement) {
  if (std::isinf(agreement.noise_dof)) return chi_square_tail(agreement.chi_square, agreement.freedom);
  return fisher_tail(std::max(agreement.chi_square, 0.0) / agreement.freedom, agreement.freedom, agreement.noise_dof);
}

/// Distances and lengths, one by one.
/// @param observation  while its joints are where the model has them, as the set-up was fitted.
/// @param joint_std  of where they stand then.  @param covariance  of the scales and the sought errors.
std::vector<CheckedReading> checked_readings(const Placement& nominal, const Placement& calibrated,
                                             const Observation& observation, const Placed& at,
                                             const Eigen::VectorXd& joint_std, const Eigen::MatrixXd& covariance,
                                             const std::vector<Station>& stations) {
  std::vector<CheckedReading> readings;
  const auto is_listed = [](const ReadingSeries& series) {
    return series.quantity() == Quantity::distance || series.quantity() == Quantity::length;
  };
  if (std::ranges::none_of(observation.series(), [&](const auto& one) { return is_listed(*one); })) return readings;
  const FollowingSetUp set_up(observation, at.unknowns);
  Eigen::MatrixXd block;
  for (const Group& group : observation.groups()) {
    const ReadingSeries& series = observation.series_of(group);
    if (!is_listed(series)) continue;
    const double sigma = observation.sigma_of(group) * observation.noise_factor(group);
    observation.rows(group, at.stations, at.unknowns, block);
    const FollowingSetUp::Left left = set_up.left(block.row(0), covariance);
    const double wider = joint_std.size() > 0 ? observation.widening(group, at, joint_std)(0) : 1.0;
    const double variance = left.noise * wider + left.rest;
    readings.push_back({.text = series.label(group.index, stations),
                        .before = nominal.residual(group).length(0),
                        .after = calibrated.residual(group).length(0),
                        .sigma = sigma,
                        .U = kCoverageFactor * sigma * std::sqrt(variance),
                        .length = series.length_kind()});
  }
  return readings;
}

/// Adds `agreement`, or a note where nobody can tell.
void state_agreement(Scatter left, std::optional<double> noise_dof, bool is_known, Validation& validation) {
  if (noise_dof && std::isfinite(*noise_dof)) {  // repeats scatter as they do, by which the noise was told
    left.sum -= *noise_dof;
    left.redundancy -= *noise_dof;
  }
  if (!is_known) {
    validation.notes.emplace_back(
        "the calibration states no uncertainty, so these readings cannot check one: calibrate again with more poses");
  } else if (!noise_dof || left.redundancy < 1.0) {
    validation.notes.emplace_back(
        "these readings cannot check the uncertainty of the calibration: state their sigma (--sigma-mm) or visit poses "
        "twice");
  } else if (!std::isfinite(left.sum)) {
    validation.notes.emplace_back(
        "these readings cannot check the uncertainty of the calibration: their residuals over sigma overflow; check "
        "readings and sigmas");
  } else {
    validation.agreement = {.chi_square = left.sum, .freedom = left.redundancy, .noise_dof = *noise_dof};
    validation.agreement->chance = chance_of(*validation.agreement);
  }
}

}  // namespace

ReadingErrors add_agreement(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                            const ValidationOptions& options, Validation& validation) {
  const CalibrationOptions fit = as_for_a_fit(options);
  const Measurements actual = at_actual_joints(robot, known.drives(), measurements);
  const Placement nominal(robot, measurements, fit, {}), calibrated(robot, actual, fit, known.errors);
  Observation observation(robot, actual, fit, known.parameters, true);
  Eigen::VectorXd unknowns = *observation.start(known.errors);
  take_set_up(calibrated, observation, unknowns);
  const std::optional<double> noise_dof = find_noise(observation, unknowns, validation);
  const bool is_known = known.covariance.size() > 0;
  const Eigen::Index n = observation.source_count();
  const Eigen::MatrixXd covariance = is_known ? known.expanded_covariance() : Eigen::MatrixXd::Zero(n, n);
  const auto stations = observation.stations(unknowns);
  validation.readings =
      checked_readings(nominal, calibrated, observation, {*stations, unknowns}, known.joint_std_of_a_visit(),
                       with_scales(observation, fit.scale_std, covariance), measurements.stations);
  observation.let_joints_err(known.joint_std);
  const Scatter left = disagreement(observation, unknowns, covariance);
  if (left.redundancy < 1.0) {
    throw InvalidArgument(
        fmt::format("validation: expected more readings than unknowns of their setup ({}), got {}; measure more poses",
                    calibrated.observation.nuisance_count(), observation.groups().size()));
  }
  state_agreement(left, noise_dof, is_known, validation);
  return {nominal.summary(), calibrated.summary()};
}

}  // namespace paracal::detail
