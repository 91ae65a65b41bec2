#include "verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "paracal/calibration/prediction.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// "alpha0 of all limbs, e_x of limb 2".
std::string listed(const std::vector<SourceSelector>& selectors, Actuator actuator) {
  std::string text;
  for (const SourceSelector& one : selectors) {
    text += fmt::format("{}{} of {}", text.empty() ? "" : ", ", name(one.source, actuator),
                        one.limb ? fmt::format("limb {}", *one.limb + 1) : "all limbs");
  }
  return text;
}

/// A limit that U in use breaks, in words; empty when all are kept.
std::string broken_limit(const Calibration& calibration) {
  const AcceptanceLimits& limits = calibration.options.limits;
  if (!limits.any()) return {};
  if (!calibration.use) return "no uncertainty in use could be stated to hold against the limits";
  if (limits.rotation && !calibration.use->rotation)
    return "a limit on rotation was set for a plate that does not turn";
  const auto broken = [](const char* what, const UseQuantity& one, double unit, const char* name) {
    return one.kept() ? std::string()
                      : fmt::format(
                            "U of {} over the workspace, {:.3g} {}, is above the limit of {:.3g} {}: measure "
                            "more poses, or more often",
                            what, one.U * unit, name, *one.limit * unit, name);
  };
  std::string text = broken("distances", calibration.use->distance, 1.0, "mm");
  if (text.empty()) text = broken("positions after alignment", calibration.use->aligned, 1.0, "mm");
  if (text.empty() && calibration.use->rotation) {
    text = broken("rotations", *calibration.use->rotation, to_degrees(1.0), "deg");
  }
  return text;
}

}  // namespace

void add_assumptions(const StageFit& fit, Calibration& calibration) {
  const CalibrationOptions& options = calibration.options;
  const auto assume = [&](std::string_view text) { calibration.assumed.emplace_back(text); };
  std::ranges::for_each(options.tolerances.value_or(tolerances_of(calibration.robot)).assumed, assume);
  if (!options.fixed.empty())
    assume(fmt::format("known exactly: {}", listed(options.fixed, calibration.robot.actuator())));
  if (options.scale_std > 0.0) {
    assume(fmt::format("the scale of the readings is right within {:.3g} ppm (one standard deviation)",
                       1e6 * options.scale_std));
  }
  const FitScatter scatter = fit_scatter(fit);
  const bool unstated = !all_stated(fit.observation());
  if (unstated && scatter.visits.redundancy < 1.0 && !fit.components().joint) {
    assume(
        "no pose was visited twice, and the noise is not stated: nobody can tell noise from backlash, friction or "
        "load");
  }
  if (unstated && fit.scatter().redundancy < 1.0) {
    assume(
        fmt::format("the readings leave nothing to tell their noise by: {:.3g} mm", reading_noise(fit.observation())));
  }
  const auto held = std::ranges::count(calibration.parameters, true, &ParameterEstimate::held);
  if (held > 0) {
    assume(fmt::format("{} other errors are held at nominal; their tolerances are in every uncertainty", held));
  }
}

void add_controller(const Measurements& measurements, Calibration& calibration) {
  ControllerModel& controller = calibration.options.controller;
  controller = with_readings(std::move(controller), measurements);
  std::ranges::move(controller_assumptions(controller, calibration.robot), std::back_inserter(calibration.assumed));
}

void state_use(const StageFit& fit, Calibration& calibration) {
  if (!calibration.options.states_use || !fit.converged() || calibration.covariance.size() == 0) return;
  try {
    calibration.use = use_over_workspace(calibration.robot, known_errors(calibration));
  } catch (const Unreachable&) {
    calibration.notes.emplace_back("the calibrated machine does not close everywhere in its workspace");
    return;
  }
  const AcceptanceLimits& limits = calibration.options.limits;
  calibration.use->distance.limit = limits.distance;
  calibration.use->aligned.limit = limits.volumetric;
  if (calibration.use->rotation) calibration.use->rotation->limit = limits.rotation;
}

void add_components(Calibration& calibration) {
  for (const Component& one : calibration.components) {
    (one.told ? calibration.notes : calibration.assumed)
        .push_back(one.told ? one.text + "; all uncertainties include it"
                            : fmt::format("{}, perhaps (chance alone would show as much in {:.1g} of machines): all "
                                          "uncertainties include it",
                                          one.text, one.chance));
  }
  if (calibration.fit_probability && 1.0 - *calibration.fit_probability < calibration.options.tell_chance) {
    calibration.notes.push_back(
        fmt::format("the readings scatter only {:.2g} times as much as their stated sigmas: the noise is less than was "
                    "stated, and U larger than it need be",
                    *calibration.unit_weight_std));
  }
}

void add_promise_of_fine(const Measurements& measurements, Calibration& calibration) {
  const bool offsets_alone = calibration.options.method == Method::best && calibration.stages.back().name == "rough";
  if (!offsets_alone || !calibration.use) return;
  const Robot& robot = calibration.robot;
  const Use fine = use_over_workspace(robot, promised(robot, measurements, calibration.options));
  if (fine.distance.U >= calibration.use->distance.U) return;
  calibration.notes.push_back(fmt::format(
      "these are the encoder offsets alone, which leave distances known to {:.2g} mm; the fine stage, which "
      "seeks every error under its tolerance, would know them to about {:.2g} mm",
      calibration.use->distance.U, fine.distance.U));
}

void judge(const LeastSquaresResult& fit, bool determined, Calibration& calibration) {
  const auto say = [&](Verdict verdict, std::string_view reason) {
    calibration.verdict = verdict;
    calibration.reasons.emplace_back(reason);
  };
  if (fit.status == LeastSquaresStatus::not_evaluable) {
    return say(Verdict::not_converged,
               "the nominal machine does not close at every station, or a reading is absurd: are joint angles, "
               "distances and sigmas those of this robot, in deg and mm?");
  }
  if (fit.status == LeastSquaresStatus::not_converged) {
    return say(Verdict::not_converged, fmt::format("the fit did not settle in {} iterations", fit.iterations));
  }
  const auto sought = std::ranges::count(calibration.parameters, false, &ParameterEstimate::held);
  if (!determined) {
    return say(Verdict::not_identifiable,
               fmt::format("the readings determine {} of {} parameters: {}", calibration.rank, sought,
                           calibration.options.free.empty()
                               ? "measure more poses"
                               : "give those that are sought without a prior a tolerance, or hold one that goes with "
                                 "them"));
  }
  if (!calibration.chance) {
    return say(Verdict::rejected,
               fmt::format("{} readings for {} parameters leave nothing to check the fit with: measure more poses or "
                           "state their sigma",
                           calibration.readings, sought));
  }
  if (*calibration.chance > calibration.options.largest_chance) {
    return say(Verdict::rejected,
               fmt::format("the improvement could be chance (probability {:.2g}, limit {:g}): these errors are not "
                           "shown to be real",
                           *calibration.chance, calibration.options.largest_chance));
  }
  if (const std::string broken = broken_limit(calibration); !broken.empty()) return say(Verdict::rejected, broken);
  calibration.verdict = Verdict::accepted;
}

}  // namespace paracal::detail
