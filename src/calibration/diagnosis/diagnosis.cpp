#include "paracal/calibration/diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "calibration/verdict/parameter_table.hpp"
#include "mistakes.hpp"
#include "paracal/units.hpp"
#include "wrong_nominal.hpp"

namespace paracal {
namespace {

using detail::Input;
using detail::Mistake;
using detail::TrialFit;

/// Nats by which the evidence must grow before anyone is told that his input is wrong: a chance of e^-30, even where
/// forty mistakes are tried.
constexpr double kFarMoreProbable = 30.0;
/// Mistakes within this of the best explain the readings equally well, nats.
constexpr double kEqual = 10.0;
/// Root mean square of errors over the standard deviations of their tolerances: about 0.7 after a fit, which leaves
/// what the readings do not tell at zero.
constexpr double kWithinTolerances = 1.3;

struct Explanation {
  const Mistake* mistake = nullptr;
  TrialFit fit;
};

/// Mistakes whose nominal robot lies about as near to the readings as the best one's. Among those alike (what only the
/// errors of the machine can tell apart) the most frugal come first.
std::vector<const Mistake*> promising(const Input& given, const std::vector<Mistake>& mistakes) {
  constexpr double kAlike = 1.25, kAsNear = 4.0;
  constexpr std::size_t kMost = 20;
  std::vector<std::pair<double, const Mistake*>> misfits;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Mistake& mistake : mistakes) {
    const auto input = detail::undone(given, mistake);
    const double misfit = input ? detail::nominal_misfit(*input) : std::numeric_limits<double>::infinity();
    misfits.emplace_back(misfit, &mistake);
    nearest = std::min(nearest, misfit);
  }
  std::erase_if(misfits, [&](const auto& one) { return !(one.first <= kAsNear * nearest) || std::isinf(one.first); });
  std::ranges::stable_sort(
      misfits, {}, [&](const auto& one) { return std::floor(std::log(one.first / nearest) / std::log(kAlike)); });
  std::vector<const Mistake*> near;
  for (std::size_t k = 0; k < std::min(misfits.size(), kMost); ++k) near.push_back(misfits[k].second);
  std::ranges::sort(near);
  return near;
}

/// Scale of the noise above which a fit leaves something to explain: readings scatter more than their repeats do, than
/// was stated, or than any instrument may.
double largest_scale(const TrialFit& fit) {
  constexpr double kLeastScatter = 0.3;  // of the sigmas: repeats of rounded readings may agree to the last digit
  constexpr double kOfRepeats = 2.0, kOfStated = 3.0, kOfAssumed = 10.0;
  if (fit.repeats) return kOfRepeats * std::max(*fit.repeats, kLeastScatter);
  return fit.is_stated ? kOfStated : kOfAssumed;
}

/// Next to nothing is left of what there was to explain: what remains may be another fault (backlash), or sigmas in
/// another unit.
bool is_next_to_nothing(const TrialFit& fit, const std::optional<TrialFit>& given) {
  constexpr double kNextToNothing = 0.01;
  return given && fit.scale < kNextToNothing * given->scale;
}

/// Fits that stand for something else than noise and tolerances.
bool differs(double one, double two) {
  constexpr double kDiffers = 1.5;
  return one > kDiffers * two || two > kDiffers * one;
}

/// Readings lie closer to the machine, or its errors closer to nominal.
bool is_better(const TrialFit& fit, const TrialFit& given) {
  return (fit.scale < given.scale && differs(fit.scale, given.scale)) ||
         (fit.tension < given.tension && differs(fit.tension, given.tension));
}

/// Whether a fit leaves nothing to explain. Neither one wrong number in the robot file nor another robot makes up for
/// errors beyond their tolerances.
bool explains(const Mistake& mistake, const TrialFit& fit, const std::optional<TrialFit>& given) {
  const bool of_robot = mistake.kind == detail::MistakeKind::nominal || mistake.kind == detail::MistakeKind::robot;
  if (of_robot && fit.tension > kWithinTolerances) return false;
  if (given && !is_better(fit, *given)) return false;
  return fit.scale <= largest_scale(fit) || is_next_to_nothing(fit, given);
}

std::vector<Explanation> fits_of(const Input& given, const std::vector<const Mistake*>& mistakes) {
  std::vector<Explanation> all;
  for (const Mistake* mistake : mistakes) {
    if (auto fit = detail::fit_without(given, *mistake)) all.push_back({mistake, std::move(*fit)});
  }
  return all;
}

double objective_of(const Explanation& one) { return one.fit.objective; }

/// Those as good as the best, one of a family, the most frugal first.
std::vector<Explanation> best_of(std::vector<Explanation> all) {
  if (all.empty()) return {};
  const double least = objective_of(*std::ranges::min_element(all, {}, objective_of));
  std::vector<Explanation> best;
  for (Explanation& one : all) {
    if (objective_of(one) > least + kEqual) continue;
    const auto relative =
        std::ranges::find(best, one.mistake->family, [](const Explanation& other) { return other.mistake->family; });
    if (relative == best.end()) {
      best.push_back(std::move(one));
    } else if (objective_of(one) < objective_of(*relative) - 1e-3) {
      *relative = std::move(one);
    }
  }
  return best;
}

/// How well readings fit: "0.017 mm", with what else makes a difference to the other fit.
std::string quality(const TrialFit& fit, const TrialFit& other) {
  std::string text = detail::two_digits(fit.noise) + " mm";
  if (fit.rotation_noise && other.rotation_noise && differs(*fit.rotation_noise, *other.rotation_noise)) {
    text += fmt::format(" and {} deg", detail::two_digits(to_degrees(*fit.rotation_noise)));
  }
  if (fit.tension > kWithinTolerances && differs(fit.tension, other.tension)) {
    text += fmt::format(" (errors {:.1f} times as large as their tolerances)", fit.tension);
  }
  return text;
}

std::string text_of(const std::vector<std::string>& causes, const TrialFit& fit, const std::optional<TrialFit>& given) {
  const std::string cause = fmt::format("{}", fmt::join(causes, "; or "));
  if (!given)
    return fmt::format("{}: corrected, the residuals are {} mm. Check the input", cause, detail::two_digits(fit.noise));
  return fmt::format("{}: corrected, the residuals drop from {} to {}. Check the input", cause, quality(*given, fit),
                     quality(fit, *given));
}

Diagnosis diagnosis_of(const std::vector<Explanation>& best, const std::optional<TrialFit>& given) {
  constexpr std::size_t kNamed = 4;
  Diagnosis diagnosis;
  for (const Explanation& one : best) {
    if (diagnosis.causes.size() < kNamed) diagnosis.causes.push_back(one.mistake->text);
  }
  const TrialFit& fit = best.front().fit;
  diagnosis.rms_explained = fit.noise;
  if (given) diagnosis.rms_as_given = given->noise;
  diagnosis.largest_noise = fit.noise * largest_scale(fit) / fit.scale;
  diagnosis.text = text_of(diagnosis.causes, fit, given);
  return diagnosis;
}

/// Something is wrong that makes a mistake likely, but none of them makes good for it.
Diagnosis without_cause(const TrialFit& nearest, const TrialFit& given) {
  Diagnosis diagnosis{.rms_as_given = given.noise, .rms_explained = nearest.noise};
  diagnosis.largest_noise = given.noise * largest_scale(given) / given.scale;
  diagnosis.text = fmt::format(
      "no common input mistake explains the residuals of {}; the most likely one leaves {}. Check units, signs, pose "
      "names and dimensions",
      quality(given, nearest), quality(nearest, given));
  return diagnosis;
}

/// What no mistake of the input is needed for: the input as given, even with a part out of its tolerance.
double objective_without_mistake(const Input& given, const std::optional<TrialFit>& as_given) {
  if (!as_given) return std::numeric_limits<double>::infinity();
  double least = as_given->objective;
  for (const Mistake& part : detail::wrong_parts(*as_given)) {
    if (const auto fit = detail::fit_without(given, part)) least = std::min(least, fit->objective);
  }
  return least;
}

/// What came of mistakes that were tried.
struct Findings {
  std::vector<Explanation> best;    ///< none: nothing explains the readings
  std::optional<TrialFit> nearest;  ///< the most probable, whether it explains them or not

  bool name_a_cause(double enough) const { return !best.empty() && objective_of(best.front()) <= enough; }
  bool cast_doubt(double enough) const { return nearest && nearest->objective <= enough; }
};

Findings findings_of(const Input& given, const std::vector<const Mistake*>& mistakes,
                     const std::optional<TrialFit>& as_given) {
  std::vector<Explanation> all = fits_of(given, mistakes);
  if (all.empty()) return {};
  Findings findings{.best = {}, .nearest = std::ranges::min_element(all, {}, objective_of)->fit};
  std::erase_if(all, [&](const Explanation& one) { return !explains(*one.mistake, one.fit, as_given); });
  findings.best = best_of(std::move(all));
  return findings;
}

std::vector<const Mistake*> pointers_to(const std::vector<Mistake>& mistakes) {
  std::vector<const Mistake*> all;
  all.reserve(mistakes.size());
  for (const Mistake& mistake : mistakes) all.push_back(&mistake);
  return all;
}

/// What is sought only where nothing else explains the readings.
std::vector<Mistake> last_resorts(const Input& given, const TrialFit& as_given) {
  std::vector<Mistake> all = detail::moved_set_ups(given);
  if (auto scale = detail::wrong_scale(given, as_given)) all.push_back(std::move(*scale));
  std::ranges::move(detail::wrong_pairs(given, as_given), std::back_inserter(all));
  return all;
}

}  // namespace

std::optional<Diagnosis> diagnose(const Robot& robot, const Measurements& measurements,
                                  const CalibrationOptions& options) {
  check(measurements, robot.limb_count());
  const Input given{robot, measurements, options};
  const std::optional<TrialFit> as_given = detail::fit_robustly(given);
  const std::vector<Mistake> usual = detail::usual_mistakes(given);
  const std::vector<Mistake> nominals = as_given ? detail::wrong_nominals(given, *as_given) : std::vector<Mistake>{};
  std::vector<const Mistake*> tried = promising(given, usual);
  std::ranges::copy(pointers_to(nominals), std::back_inserter(tried));
  const Findings found = findings_of(given, tried, as_given);
  const double enough = objective_without_mistake(given, as_given) - kFarMoreProbable;
  if (found.name_a_cause(enough)) return diagnosis_of(found.best, as_given);
  if (!as_given) return std::nullopt;
  const std::vector<Mistake> others = last_resorts(given, *as_given);
  const Findings last = findings_of(given, pointers_to(others), as_given);
  if (last.name_a_cause(enough)) return diagnosis_of(last.best, as_given);
  if (!found.cast_doubt(enough)) return std::nullopt;
  return without_cause(*found.nearest, *as_given);
}

}  // namespace paracal
