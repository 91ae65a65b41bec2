#include "acceptance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/fit/sought.hpp"
#include "paracal/units.hpp"
#include "parameter_table.hpp"

namespace paracal::detail {
namespace {

/// One quantity of U over the workspace, before and after, in the unit of messages.
struct Gain {
  std::string_view what, unit;
  double before = 0.0, after = 0.0;
};

std::vector<Gain> gains(const Use& before, const Use& after) {
  std::vector<Gain> all{{"distances", "mm", before.distance.U, after.distance.U},
                        {"aligned positions", "mm", before.aligned.U, after.aligned.U}};
  if (before.rotation && after.rotation) {
    all.push_back({"rotations", "deg", to_degrees(before.rotation->U), to_degrees(after.rotation->U)});
  }
  return all;
}

/// Empty where the machine is better known than before.
/// @param uses_tolerances  the fit does, so that no quantity may be known less well than by them. A fit of offsets
/// alone
///                         does not: heights leave its rotations open.
std::string without_gain(const std::vector<Gain>& all, double largest, bool uses_tolerances) {
  constexpr const char* kCheck = "Check the input, the joints and the instrument";
  const auto worse = std::ranges::find_if(all, [&](const Gain& one) { return one.after > largest * one.before; });
  if (uses_tolerances && worse != all.end()) {
    return fmt::format(
        "U of {} over the workspace is {} {}; before the calibration, by the tolerances alone, it is {} {}. {}",
        worse->what, two_digits(worse->after), worse->unit, two_digits(worse->before), worse->unit, kCheck);
  }
  if (std::ranges::any_of(all, [](const Gain& one) { return one.after < one.before; })) return {};
  return fmt::format(
      "U over the workspace is not below that of the uncalibrated machine ({} of {} {}, by the tolerances "
      "alone {} {}): measure more poses or with less noise",
      all.front().what, two_digits(all.front().after), all.front().unit, two_digits(all.front().before),
      all.front().unit);
}

/// Mean square of the factor by which parts of a group are beyond their tolerances, before any reading: its logarithm
/// is exponentially distributed with this mean, where a table of variances was made (Spreads::positions).
double beyond_tolerances(const CalibrationOptions& options, const Posterior& posterior) {
  constexpr double kMost = 10.0;
  if (posterior.visit_std.size() == 0) return 1.0;
  const double rest = 1.0 - 2.0 * options.discrepancies.tolerances;
  return rest > 1.0 / kMost ? 1.0 / rest : kMost;
}

bool is_any(const Observation& observation, bool stated) {
  return std::ranges::any_of(observation.groups(), [&](const Group& one) { return one.stated == stated; });
}

}  // namespace

Compared compared_with_expected(const Finished& of, const FitSummary& fit, const Posterior& posterior) {
  const Observation& observation = of.observation();
  const double scatter = fit.unit_weight_std.value_or(1.0);
  Compared found{.identifies_errors = std::ranges::any_of(posterior.parameters, &ParameterEstimate::identified),
                 .uses_tolerances = has_priors(observation)};
  if (is_any(observation, true)) found.stated_noise = of.explanation ? of.explanation->stated_noise : scatter;
  if (is_any(observation, false)) {
    const double beside = has_priors(observation) ? 1.0 : scatter;
    found.unstated_noise =
        of.explanation ? largest_unstated(of.explanation->noise) : observation.unstated_noise() * beside;
  }
  if (!of.explanation) return found;
  found.absorbed = of.explanation->absorbed;
  found.allowed = of.explanation->allowed;
  return found;
}

Eigen::MatrixXd covariance_of_tolerances(const Robot& robot, const CalibrationOptions& options,
                                         const Posterior& posterior) {
  const std::vector<SoughtSource> tolerated = all_with_priors(robot, options);
  std::vector<SoughtSource> errors;
  for (const ParameterEstimate& estimate : posterior.parameters) {
    SoughtSource error{estimate.limb, estimate.source, 0.0};
    const auto found =
        std::ranges::find_if(tolerated, [&](const SoughtSource& one) { return is_same_error(one, error); });
    if (found != tolerated.end()) error = *found;
    if (!error.prior_std) return {};
    errors.push_back(error);
  }
  return beyond_tolerances(options, posterior) *
         prior_covariance(errors, options.common, Eigen::VectorXd::Ones(std::ssize(errors)));
}

namespace {

std::string lack_of_gain(const Compared& found, const CalibrationOptions& options) {
  if (!found.uncalibrated || !found.use) return {};
  return without_gain(gains(*found.uncalibrated, *found.use), options.largest_use_ratio, found.uses_tolerances);
}

}  // namespace

bool is_better_known(const Compared& found, const CalibrationOptions& options) {
  return lack_of_gain(found, options).empty();
}

std::vector<std::string> unexplained(const Compared& found, const CalibrationOptions& options) {
  std::vector<std::string> reasons;
  if (!found.identifies_errors && found.combinations < 1.0) {
    reasons.emplace_back(
        "no error is identified: the tolerances say more of each than the readings do. Measure more poses or with less "
        "noise");
  }
  if (found.stated_noise > options.largest_noise_factor) {
    reasons.push_back(
        fmt::format("the readings scatter {:.0f} times as much as their stated sigmas: check units, pose names and the "
                    "instrument",
                    found.stated_noise));
  }
  if (found.unstated_noise > options.largest_unstated_noise) {
    reasons.push_back(
        fmt::format("the readings scatter {} mm, {:.0f} times the noise of such an instrument: check units, pose "
                    "names and the instrument",
                    two_digits(found.noise), found.unstated_noise));
  }
  if (found.allowed > 0.0 && found.absorbed > options.largest_absorbed * found.allowed) {
    reasons.push_back(
        fmt::format("joints, drives and poses deviate from the geometry by {} mm at the plate, and the tolerances "
                    "allow errors of {} mm: the geometry does not explain the readings. Check the input and the "
                    "joints",
                    two_digits(found.absorbed), two_digits(found.allowed)));
  }
  if (std::string text = lack_of_gain(found, options); !text.empty()) reasons.push_back(std::move(text));
  return reasons;
}

}  // namespace paracal::detail
