#include "spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/fit/pair_covariance.hpp"
#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "paracal/calibration/prediction.hpp"

namespace paracal::detail {
namespace {

/// Errors without a prior beside others that have one may together do what no reading sees, as e_x of all limbs does:
/// then neither readings nor priors hold it.
bool leaves_open(const StageFit& fit) {
  constexpr double kNothing = 1e-11;  // far below what exact readings leave to a prior
  const auto& sought = fit.observation().sought();
  const bool all = std::ranges::all_of(sought, [](const SoughtSource& one) { return one.prior_std.has_value(); });
  return !all && analyse(fit.fit().at_answer.root(), kNothing).rank < fit.observation().unknown_count();
}

/// C = (J^T V^-1 J + P)^-1 has the noise's part C J^T V^-1 J C, a product with the root of the readings alone: nothing,
/// and no rounding, of what only a prior says.
Eigen::MatrixXd noise_part(const StageFit& fit, const Eigen::MatrixXd& covariance) {
  constexpr double kRounding = 1e-12;  // of a variance
  InformationRoot readings(fit.observation().unknown_count());
  (void)fit.observation()(fit.fit().parameters, readings);  // closes, as the fit did
  const Eigen::MatrixXd through = product(readings.root(), covariance);
  Eigen::MatrixXd noise = product(through.transpose(), through);
  for (Eigen::Index k = 0; k < noise.rows(); ++k) {
    if (noise(k, k) > kRounding * covariance(k, k)) continue;
    noise.row(k).setZero();
    noise.col(k).setZero();
  }
  return noise;
}

/// What estimates the noise: the redundancy of the readings, unless all noise is stated.
double noise_freedom(const StageFit& fit, const Scatter& scatter) {
  return all_stated(fit.observation()) ? std::numeric_limits<double>::infinity() : std::max(scatter.redundancy, 1.0);
}

/// Without priors: scaled by the scatter, always where no sigma is stated, upwards only where all are.
Spread state_bare_covariance(const Measurements& measurements, const StageFit& fit, const Scatter& scatter_of_fit,
                             Calibration& calibration) {
  const Observation& observation = fit.observation();
  const bool stated = all_stated(observation);
  if (!calibration.unit_weight_std && !stated) return {};
  const double scatter = calibration.unit_weight_std.value_or(1.0);
  const Spectrum all = analyse(fit.fit().at_answer.root(), kRankTolerance);
  const Eigen::Index n = observation.source_count();
  Eigen::MatrixXd of_all;
  if (calibration.options.method == Method::paper) {
    calibration.noise_covariance =
        covariance_of_pairs(measurements, observation, fit.fit().parameters, all.covariance, scatter_of_fit.sum);
  } else if (is_determined(fit, calibration)) {
    const double factor = stated ? std::max(1.0, scatter) : scatter;
    of_all = all.covariance * factor * factor;
    calibration.noise_covariance = of_all.bottomRightCorner(n, n);
  }
  const bool known = stated && scatter <= 1.0 && calibration.options.method != Method::paper;
  if (!known) calibration.noise_dof = std::max(scatter_of_fit.redundancy, 1.0);
  calibration.covariance = calibration.noise_covariance;
  return {of_all, of_all};
}

}  // namespace

bool is_determined(const StageFit& fit, const Calibration& calibration) {
  const Observation& observation = fit.observation();
  if (has_priors(observation)) return !leaves_open(fit);
  if (calibration.rank == observation.source_count()) return true;
  const bool may_leave_motions = calibration.options.method == Method::paper || calibration.stages.size() == 1;
  return may_leave_motions && std::ranges::all_of(calibration.null_space, &NullDirection::gauge);
}

double found_parameters(const StageFit& fit, Eigen::Index rows, const Scatter& scatter) {
  const Observation& observation = fit.observation();
  if (!has_priors(observation)) {
    return static_cast<double>(rows - observation.nuisance_count()) - scatter.redundancy;
  }
  const Eigen::Index n = observation.source_count();
  const Eigen::MatrixXd priors = observation.prior_root(), covariance = fit.covariance().bottomRightCorner(n, n);
  return static_cast<double>(n) - product(priors, covariance).cwiseProduct(priors).sum();
}

Spread state_uncertainty(const Measurements& measurements, const StageFit& fit, const Scatter& scatter_of_fit,
                         bool tells_noise, Calibration& calibration) {
  const Observation& observation = fit.observation();
  // Of the sigmas as they were stated, whatever the fit then made of them.
  const double stated = all_stated(observation) ? std::pow(observation.components().stated_noise, 2) : 1.0;
  const double sum = scatter_of_fit.sum * stated, freedom = scatter_of_fit.redundancy;
  if (freedom >= 0.5) calibration.unit_weight_std = std::sqrt(sum / freedom);
  if (freedom >= 0.5 && all_stated(observation)) calibration.fit_probability = chi_square_tail(sum, freedom);
  if (!has_priors(observation)) return state_bare_covariance(measurements, fit, scatter_of_fit, calibration);
  if (leaves_open(fit)) return {};
  const Eigen::Index n = observation.source_count();
  Spread all{fit.covariance()};
  calibration.covariance = all.covariance.bottomRightCorner(n, n);
  if (tells_noise) {
    all.noise = noise_part(fit, all.covariance);
    calibration.noise_covariance = all.noise.bottomRightCorner(n, n);
  }
  calibration.noise_dof = noise_freedom(fit, scatter_of_fit);
  return all;
}

void take(const Explanation& explanation, bool stated, Calibration& calibration) {
  constexpr double kContradicted = 1.2;  // stated noise that the readings tell instead
  const auto n = static_cast<Eigen::Index>(explanation.noise.rows());
  calibration.covariance = explanation.covariance.topLeftCorner(n, n);
  calibration.noise_covariance = explanation.noise;
  calibration.drives = explanation.drives;
  calibration.drive_covariance = explanation.covariance.bottomRows(explanation.covariance.rows() - n);
  calibration.drive_sizes = explanation.drive_sizes;
  calibration.omitted_poses = explanation.omitted_poses;
  calibration.joint_std = explanation.joint_std;
  calibration.visit_std = explanation.visit_std;
  if (!stated || !explanation.repeats || !calibration.unit_weight_std ||
      *calibration.unit_weight_std < explanation.stated_noise)
    return;
  calibration.unit_weight_std = explanation.stated_noise;
  if (explanation.stated_noise > kContradicted)
    calibration.noise_dof = std::max(1.0 * calibration.degrees_of_freedom, 1.0);
  const double freedom = calibration.degrees_of_freedom;
  calibration.fit_probability = chi_square_tail(freedom * std::pow(explanation.stated_noise, 2), freedom);
}

}  // namespace paracal::detail
