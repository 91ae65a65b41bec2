#include "verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "calibration/variances/reading_order.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// "alpha0 of all limbs, e_x of limb 2".
std::string listed(const std::vector<SourceSelector>& selectors) {
  std::string text;
  for (const SourceSelector& one : selectors) {
    text += fmt::format("{}{} of {}", text.empty() ? "" : ", ", name(one.source),
                        one.limb ? fmt::format("limb {}", *one.limb + 1) : "all limbs");
  }
  return text;
}

/// A limit that U in use breaks, in words; empty when all are kept.
std::string broken_limit(const AcceptanceLimits& limits, const std::optional<Use>& use) {
  if (!limits.any()) return {};
  if (!use) return "no uncertainty over the workspace is available to compare with the limits: measure more poses";
  if (limits.rotation && !use->rotation)
    return "the limit on rotation does not apply to a plate that does not turn: remove it";
  const auto broken = [](const char* what, const UseQuantity& one, double unit, const char* name) {
    return one.kept() ? std::string()
                      : fmt::format(
                            "U of {} over the workspace is {:.3g} {}, above the limit of {:.3g} {}: measure more "
                            "poses, or each pose more often",
                            what, one.U * unit, name, *one.limit * unit, name);
  };
  std::string text = broken("distances", use->distance, 1.0, "mm");
  if (text.empty()) text = broken("aligned positions", use->aligned, 1.0, "mm");
  if (text.empty() && use->rotation) {
    text = broken("rotations", *use->rotation, to_degrees(1.0), "deg");
  }
  return text;
}

/// What seeking every error under its tolerance would be worth where the offsets alone were sought.
std::optional<std::string> promise_of_fine(const Finished& of, const FitSummary& fit, const Use& use) {
  const bool offsets_alone = of.options.method == Method::best && fit.stages.back().name == "rough";
  if (!offsets_alone) return std::nullopt;
  const Use fine = use_over_workspace(of.robot, promised(of.robot, of.measurements, of.options)).any;
  if (fine.distance.U >= use.distance.U) return std::nullopt;
  return fmt::format(
      "only the encoder offsets were estimated: U of distances is {:.2g} mm. The fine stage (--stage fine) would reach "
      "about {:.2g} mm",
      use.distance.U, fine.distance.U);
}

Use limited(Use use, const AcceptanceLimits& limits) {
  use.distance.limit = limits.distance;
  use.aligned.limit = limits.volumetric;
  if (use.rotation) use.rotation->limit = limits.rotation;
  return use;
}

}  // namespace

std::vector<std::string> assumptions(const Finished& of, const Posterior& posterior) {
  const CalibrationOptions& options = of.options;
  const StageFit& fit = of.fit;
  const Explanation* const explanation = of.explanation;
  std::vector<std::string> assumed;
  const auto assume = [&](std::string_view text) { assumed.emplace_back(text); };
  std::ranges::for_each(options.tolerances.value_or(tolerances_of(of.robot)).assumed, assume);
  if (!options.fixed.empty()) assume(fmt::format("known exactly: {}", listed(options.fixed)));
  if (options.scale_std > 0.0) {
    assume(fmt::format(
        "the scale of the readings is correct within {:.3g} ppm (standard deviation; set yours with --scale-ppm)",
        1e6 * options.scale_std));
  }
  const Scatter visits = scatter_of_visits(fit.observation(), fit.fit().parameters);
  const bool unstated = !all_stated(fit.observation());
  const bool told = std::ranges::any_of(posterior.components,
                                        [](const Component& one) { return one.told && one.cause == Cause::motion; });
  if (explanation && explanation->is_ambiguous) {
    assume(
        "no pose was visited twice and no noise is stated, so noise and joints that do not repeat look alike: U of a "
        "single visit includes both. Visit poses twice, or state the noise (--sigma-known), to separate them");
  } else if (unstated && visits.redundancy < 1.0 && !told) {
    assume("noise includes backlash, friction and load: no pose was visited twice and no noise is stated (--sigma-mm)");
  }
  if (posterior.visit_std.size() > 0) {
    assume("the machine is as warm and as loaded in operation as during the measurement");
    const bool drifts = std::ranges::any_of(posterior.components,
                                            [](const Component& one) { return one.told && one.cause == Cause::drift; });
    if (!drifts && !returns_to_poses(fit.observation())) {
      assume(
          "nothing drifted during the measurement: no pose was visited again after others, so drift looks like errors "
          "of parts. Visit all poses once, then all again, to see it");
    }
    assume(
        "parts are rigid where single errors are concerned: uneven drives and parts that bend look like errors of "
        "parts (U of poses includes both)");
    if (visits.redundancy < 1.0 && explanation && !explanation->is_ambiguous) {
      assume(fmt::format("joints repeat within some {:.2g} mm at the plate: visit poses twice to measure it",
                         options.discrepancies.visits));
    }
  }
  if (unstated && fit.scatter().redundancy < 1.0) {
    assume(fmt::format("the noise is {:.3g} mm: too few readings determine it (state yours with --sigma-mm)",
                       reading_noise(fit.observation())));
  }
  const auto held = std::ranges::count(posterior.parameters, true, &ParameterEstimate::held);
  if (held > 0) {
    assume(fmt::format("{} other errors are fixed at nominal; every uncertainty includes their tolerances", held));
  }
  return assumed;
}

StatedUse use_of(const Finished& of, const FitSummary& fit, const Posterior& posterior) {
  if (!of.options.states_use || !of.fit.converged() || posterior.covariance.size() == 0) return {};
  try {
    const UseOfVisits found = use_over_workspace(of.robot, known_errors(posterior),
                                                 covariance_of_tolerances(of.robot, of.options, posterior));
    return {{limited(found.any, of.options.limits), limited(found.mean, of.options.limits)},
            found.uncalibrated,
            promise_of_fine(of, fit, found.any)};
  } catch (const Unreachable&) {
    return {.note = "the calibrated machine cannot reach its whole workspace: check the robot file"};
  }
}

void add_causes(const Posterior& posterior, const FitSummary& fit, const CalibrationOptions& options,
                Remarks& remarks) {
  for (const Component& one : posterior.components) {
    (one.told ? remarks.notes : remarks.assumed)
        .push_back(fmt::format("{}{} (probability {:.0f} %)", one.told ? "" : "possibly, ", one.text,
                               std::floor(100.0 * one.probability)));
  }
  if (fit.fit_probability && 1.0 - *fit.fit_probability < options.tell_chance) {
    remarks.notes.push_back(
        fmt::format("the readings scatter only {:.2g} times as much as their stated sigmas, so U is too large: state a "
                    "smaller sigma",
                    *fit.unit_weight_std));
  }
}

Outcome outcome_of(const Finished& of, const FitSummary& fit, bool determined, const std::optional<double>& chance,
                   const Compared& found) {
  const LeastSquaresResult& answer = of.fit.fit();
  if (answer.status == LeastSquaresStatus::not_evaluable) {
    return {Verdict::not_converged,
            {"the nominal machine cannot reach every station, or a reading is impossible: check that joints, "
             "distances and sigmas belong to this robot (deg, mm)"}};
  }
  if (answer.status == LeastSquaresStatus::not_converged) {
    return {Verdict::not_converged,
            {fmt::format("the fit did not converge in {} iterations: check the input and the "
                         "robot file",
                         answer.iterations)}};
  }
  const Eigen::Index sought = of.observation().source_count();
  if (!determined) {
    return {Verdict::not_identifiable,
            {fmt::format("the readings determine {} of {} parameters: {}", fit.rank, sought,
                         of.options.free.empty()
                             ? "measure more poses"
                             : "give the errors of --free a tolerance, or fix a correlated one (--fix)")}};
  }
  if (!chance) {
    return {Verdict::rejected,
            {fmt::format("{} readings for {} parameters leave no degrees of freedom to check the "
                         "fit: measure more poses or state their sigma",
                         fit.readings, sought)}};
  }
  std::vector<std::string> reasons;
  if (*chance > of.options.largest_chance) {
    reasons.push_back(fmt::format(
        "the improvement is not significant (p-value {:.2g}, limit {:g}): measure more poses or with less noise",
        *chance, of.options.largest_chance));
  }
  std::ranges::move(unexplained(found, of.options), std::back_inserter(reasons));
  if (std::string broken = broken_limit(of.options.limits, found.use); !broken.empty()) {
    reasons.push_back(std::move(broken));
  }
  const Verdict verdict = reasons.empty() ? Verdict::accepted : Verdict::rejected;
  return {verdict, std::move(reasons)};
}

}  // namespace paracal::detail
