#include "posterior.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/fit/pair_covariance.hpp"
#include "numerics/dense.hpp"
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
  const Eigen::MatrixXd through = product(fit.observation().information(fit.fit().parameters).root(), covariance);
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
Spread bare_spread(const Finished& of, const FitSummary& fit, const Scatter& scatter) {
  const Observation& observation = of.observation();
  const bool stated = all_stated(observation), is_paper = of.options.method == Method::paper;
  const std::optional<double> unit_weight = unit_weight_std(scatter);
  if (!unit_weight && !stated) return {};
  const double times = unit_weight.value_or(1.0);
  const Spectrum all = analyse(of.fit.fit().at_answer.root(), kRankTolerance);
  const Eigen::Index n = observation.source_count();
  Spread spread;
  if (is_paper) {
    spread.errors =
        covariance_of_pairs(of.measurements, observation, of.fit.fit().parameters, all.covariance, scatter.sum);
  } else if (is_determined(of, fit)) {
    const double factor = stated ? std::max(1.0, times) : times;
    spread.covariance = spread.noise = all.covariance * factor * factor;
    spread.errors = spread.covariance.bottomRightCorner(n, n);
  }
  spread.errors_by_noise = spread.errors;
  const bool known = stated && times <= 1.0 && !is_paper;
  if (!known) spread.noise_dof = std::max(scatter.redundancy, 1.0);
  return spread;
}

/// Values, standard deviations, their degrees of freedom and shares of information: the sought errors, then those held.
/// @param with_drives  of the sought errors; empty: the machine is rigid.
std::vector<ParameterEstimate> estimates(const Finished& of, const std::vector<SoughtSource>& held,
                                         const Eigen::VectorXd& with_drives, const Posterior& known) {
  const Observation& observation = of.observation();
  const Eigen::MatrixXd &covariance = known.covariance, &noise = known.noise_covariance;
  std::vector<SoughtSource> all = observation.sought();
  all.insert(all.end(), held.begin(), held.end());
  std::vector<ParameterEstimate> estimates;
  for (Eigen::Index k = 0; k < std::ssize(all); ++k) {
    const SoughtSource& one = all[static_cast<std::size_t>(k)];
    ParameterEstimate parameter{.limb = one.limb, .source = one.source, .held = k >= observation.source_count()};
    parameter.value = parameter.expected = known.expected(one.limb, one.source);
    if (k < with_drives.size()) parameter.with_drives = parameter.expected + with_drives(k);
    if (!parameter.held) parameter.value += of.fit.fit().parameters(observation.nuisance_count() + k);
    parameter.prior_std = one.prior_std;
    if (k < covariance.rows()) {
      parameter.std = std::sqrt(covariance(k, k));
      parameter.dof = known.noise_dof * std::pow(covariance(k, k) / std::max(noise(k, k), 1e-300), 2);
    }
    if (one.prior_std && parameter.std) {
      parameter.data_share = 1.0 - std::min(1.0, std::pow(*parameter.std / *one.prior_std, 2));
    }
    estimates.push_back(parameter);
  }
  return estimates;
}

CalibratedRegion region_of(const Measurements& measurements, const Observation& observation) {
  CalibratedRegion region;
  for (const Group& group : observation.groups()) {
    if (group.active) region.add(measurements.stations[group.station].commanded.position);
  }
  return region;
}

}  // namespace

std::optional<double> unit_weight_std(const Scatter& scatter) {
  if (scatter.redundancy < 0.5) return std::nullopt;
  return std::sqrt(scatter.sum / scatter.redundancy);
}

bool visits_tell_noise(const Finished& of, const Scatter& scatter) {
  if (!of.explanation || !of.explanation->repeats || !all_stated(of.observation())) return false;
  const std::optional<double> found = unit_weight_std(scatter);
  return found && *found >= of.explanation->stated_noise;
}

bool is_determined(const Finished& of, const FitSummary& fit) {
  const Observation& observation = of.observation();
  if (has_priors(observation)) return !leaves_open(of.fit);
  if (fit.rank == observation.source_count()) return true;
  const bool may_leave_motions = of.options.method == Method::paper || fit.stages.size() == 1;
  return may_leave_motions && std::ranges::all_of(fit.null_space, &NullDirection::gauge);
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

Spread spread_of(const Finished& of, const FitSummary& fit, const Scatter& scatter, bool tells_noise) {
  if (!has_priors(of.observation())) return bare_spread(of, fit, scatter);
  if (leaves_open(of.fit)) return {};
  const Eigen::Index n = of.observation().source_count();
  Spread all{.covariance = of.fit.covariance()};
  all.errors = all.covariance.bottomRightCorner(n, n);
  if (tells_noise) {
    all.noise = noise_part(of.fit, all.covariance);
    all.errors_by_noise = all.noise.bottomRightCorner(n, n);
  }
  all.noise_dof = noise_freedom(of.fit, scatter);
  return all;
}

Posterior posterior_of(const Finished& of, const FitSummary& fit, const Scatter& scatter, const Spread& spread,
                       std::vector<Component> components) {
  const bool explained = of.explanation != nullptr && spread.errors.size() > 0;
  Posterior all = explained ? of.explanation->known
                            : Posterior{.covariance = spread.errors, .noise_covariance = spread.errors_by_noise};
  const bool contradicted =
      explained && visits_tell_noise(of, scatter) && of.explanation->stated_noise > of.options.causes.stated_noise;
  all.expected = of.options.expected.value_or(SourceErrors{});
  all.noise_dof = contradicted ? std::max(1.0 * fit.degrees_of_freedom, 1.0) : spread.noise_dof;
  all.region = region_of(of.measurements, of.observation());
  all.components = std::move(components);
  Considered considered = consider_held(of, std::move(all.covariance), std::move(all.noise_covariance));
  all.covariance = std::move(considered.covariance);
  all.noise_covariance = std::move(considered.noise);
  all.parameters =
      estimates(of, considered.held, of.explanation ? of.explanation->with_drives : Eigen::VectorXd(), all);
  return all;
}

Posterior errors_alone(const Finished& of, std::vector<Component> components) {
  Posterior all{.expected = of.options.expected.value_or(SourceErrors{}), .components = std::move(components)};
  if (of.fit.fit().status != LeastSquaresStatus::not_evaluable) all.parameters = estimates(of, {}, {}, all);
  return all;
}

}  // namespace paracal::detail
