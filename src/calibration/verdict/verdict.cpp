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
std::string broken_limit(const Calibration& calibration) {
  const AcceptanceLimits& limits = calibration.options.limits;
  if (!limits.any()) return {};
  if (!calibration.use)
    return "no uncertainty over the workspace is available to compare with the limits: measure more poses";
  if (limits.rotation && !calibration.use->rotation)
    return "the limit on rotation does not apply to a plate that does not turn: remove it";
  const auto broken = [](const char* what, const UseQuantity& one, double unit, const char* name) {
    return one.kept() ? std::string()
                      : fmt::format(
                            "U of {} over the workspace is {:.3g} {}, above the limit of {:.3g} {}: measure more "
                            "poses, or each pose more often",
                            what, one.U * unit, name, *one.limit * unit, name);
  };
  std::string text = broken("distances", calibration.use->distance, 1.0, "mm");
  if (text.empty()) text = broken("aligned positions", calibration.use->aligned, 1.0, "mm");
  if (text.empty() && calibration.use->rotation) {
    text = broken("rotations", *calibration.use->rotation, to_degrees(1.0), "deg");
  }
  return text;
}

}  // namespace

void add_assumptions(const StageFit& fit, const std::optional<Explanation>& explanation, Calibration& calibration) {
  const CalibrationOptions& options = calibration.options;
  const auto assume = [&](std::string_view text) { calibration.assumed.emplace_back(text); };
  std::ranges::for_each(options.tolerances.value_or(tolerances_of(calibration.robot)).assumed, assume);
  if (!options.fixed.empty()) assume(fmt::format("known exactly: {}", listed(options.fixed)));
  if (options.scale_std > 0.0) {
    assume(fmt::format(
        "the scale of the readings is correct within {:.3g} ppm (standard deviation; set yours with --scale-ppm)",
        1e6 * options.scale_std));
  }
  const Scatter visits = scatter_of_visits(fit.observation(), fit.fit().parameters);
  const bool unstated = !all_stated(fit.observation());
  const bool told = std::ranges::any_of(calibration.components,
                                        [](const Component& one) { return one.told && one.cause == Cause::motion; });
  if (explanation && explanation->is_ambiguous) {
    assume(
        "no pose was visited twice and no noise is stated, so noise and joints that do not repeat look alike: U of a "
        "single visit includes both. Visit poses twice, or state the noise (--sigma-known), to separate them");
  } else if (unstated && visits.redundancy < 1.0 && !told) {
    assume("noise includes backlash, friction and load: no pose was visited twice and no noise is stated (--sigma-mm)");
  }
  if (calibration.visit_std.size() > 0) {
    assume("the machine is as warm and as loaded in operation as during the measurement");
    const bool drifts = std::ranges::any_of(calibration.components,
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
  const auto held = std::ranges::count(calibration.parameters, true, &ParameterEstimate::held);
  if (held > 0) {
    assume(fmt::format("{} other errors are fixed at nominal; every uncertainty includes their tolerances", held));
  }
}

void add_controller(const Measurements& measurements, Calibration& calibration) {
  ControllerModel& controller = calibration.options.controller;
  controller = with_readings(std::move(controller), measurements);
  std::ranges::move(controller_assumptions(controller, calibration.robot), std::back_inserter(calibration.assumed));
}

std::optional<Use> state_use(const StageFit& fit, Calibration& calibration) {
  if (!calibration.options.states_use || !fit.converged() || calibration.covariance.size() == 0) return {};
  std::optional<Use> uncalibrated;
  try {
    UseOfVisits use =
        use_over_workspace(calibration.robot, known_errors(calibration), covariance_of_tolerances(calibration));
    calibration.use = use.any;
    calibration.use_mean = use.mean;
    uncalibrated = use.uncalibrated;
  } catch (const Unreachable&) {
    calibration.notes.emplace_back("the calibrated machine cannot reach its whole workspace: check the robot file");
    return {};
  }
  const AcceptanceLimits& limits = calibration.options.limits;
  for (std::optional<Use>* use : {&calibration.use, &calibration.use_mean}) {
    (*use)->distance.limit = limits.distance;
    (*use)->aligned.limit = limits.volumetric;
    if ((*use)->rotation) (*use)->rotation->limit = limits.rotation;
  }
  return uncalibrated;
}

void add_components(Calibration& calibration) {
  for (const Component& one : calibration.components) {
    (one.told ? calibration.notes : calibration.assumed)
        .push_back(fmt::format("{}{} (probability {:.0f} %)", one.told ? "" : "possibly, ", one.text,
                               std::floor(100.0 * one.probability)));
  }
  if (calibration.fit_probability && 1.0 - *calibration.fit_probability < calibration.options.tell_chance) {
    calibration.notes.push_back(
        fmt::format("the readings scatter only {:.2g} times as much as their stated sigmas, so U is too large: state a "
                    "smaller sigma",
                    *calibration.unit_weight_std));
  }
}

void add_promise_of_fine(const Measurements& measurements, Calibration& calibration) {
  const bool offsets_alone = calibration.options.method == Method::best && calibration.stages.back().name == "rough";
  if (!offsets_alone || !calibration.use) return;
  const Robot& robot = calibration.robot;
  const Use fine = use_over_workspace(robot, promised(robot, measurements, calibration.options)).any;
  if (fine.distance.U >= calibration.use->distance.U) return;
  calibration.notes.push_back(
      fmt::format("only the encoder offsets were estimated: U of distances is {:.2g} mm. The fine stage (--stage fine) "
                  "would reach about {:.2g} mm",
                  calibration.use->distance.U, fine.distance.U));
}

void judge(const LeastSquaresResult& fit, bool determined, const Compared& found, Calibration& calibration) {
  const auto say = [&](Verdict verdict, std::string_view reason) {
    calibration.verdict = verdict;
    calibration.reasons.emplace_back(reason);
  };
  if (fit.status == LeastSquaresStatus::not_evaluable) {
    return say(Verdict::not_converged,
               "the nominal machine cannot reach every station, or a reading is impossible: check that joints, "
               "distances and sigmas belong to this robot (deg, mm)");
  }
  if (fit.status == LeastSquaresStatus::not_converged) {
    return say(
        Verdict::not_converged,
        fmt::format("the fit did not converge in {} iterations: check the input and the robot file", fit.iterations));
  }
  const auto sought = std::ranges::count(calibration.parameters, false, &ParameterEstimate::held);
  if (!determined) {
    return say(Verdict::not_identifiable,
               fmt::format("the readings determine {} of {} parameters: {}", calibration.rank, sought,
                           calibration.options.free.empty()
                               ? "measure more poses"
                               : "give the errors of --free a tolerance, or fix a correlated one (--fix)"));
  }
  if (!calibration.chance) {
    return say(Verdict::rejected, fmt::format("{} readings for {} parameters leave no degrees of freedom to check the "
                                              "fit: measure more poses or state their sigma",
                                              calibration.readings, sought));
  }
  if (*calibration.chance > calibration.options.largest_chance) {
    calibration.reasons.push_back(fmt::format(
        "the improvement is not significant (p-value {:.2g}, limit {:g}): measure more poses or with less noise",
        *calibration.chance, calibration.options.largest_chance));
  }
  std::ranges::move(unexplained(found, calibration), std::back_inserter(calibration.reasons));
  if (std::string broken = broken_limit(calibration); !broken.empty()) calibration.reasons.push_back(std::move(broken));
  calibration.verdict = calibration.reasons.empty() ? Verdict::accepted : Verdict::rejected;
}

}  // namespace paracal::detail
