#include "advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "advice_rules.hpp"

namespace paracal {
namespace {

using detail::better, detail::is_enough_of_heights, detail::kCertain, detail::lowers_nozzle;

/// As errors of held-out readings are told: "heights 0.123 mm, distances 0.045 mm".
std::string in_words(const PredictionErrors& errors, bool has_distances) {
  return fmt::format("{:.3f} mm", errors.height) +
         (has_distances ? fmt::format(" and {:.3f} mm", errors.distance) : std::string());
}

std::string gain_in_words(const char* values, const PrinterCandidate& one) {
  return fmt::format(
      "{}: the mean square of these errors against that of the saved values: {:+.0f} % (90 % interval {:+.0f} to "
      "{:+.0f} "
      "%); by all that is known, better over the place of the readings, above a plane and above the bed, with a chance "
      "of {:.1f} %",
      values, -1e2 * one.gain.value, -1e2 * one.gain.high, -1e2 * one.gain.low,
      1e2 * std::min(one.least_chance(), 0.999));
}

class Findings {
 public:
  Findings(const DeltaReadings& readings, PrinterCalibration& found) : readings_(readings), found_(found) {}

  void say(std::string_view text) { found_.findings.emplace_back(text); }
  bool has_distances() const { return !readings_.distances.empty(); }
  std::size_t count() const { return readings_.heights.size() + readings_.distances.size(); }

  /// What all heights have in common: stated with what may be behind it and how to find out.
  void common_shift() {
    const CommonShift& shift = found_.shift;
    if (!shift.is_stated) return;
    say(
        fmt::format("all heights are off by {:+.1f} mm alike: by them the bed stands {:.1f} mm {}: position_endstop "
                    "{:.1f} {:.1f} {:.1f} (homed height of each tower, mm)",
                    shift.value, std::abs(shift.value), shift.value > 0.0 ? "higher" : "lower", shift.endstop[0],
                    shift.endstop[1], shift.endstop[2]));
    say(fmt::format("likely causes of the common shift: {}", fmt::join(shift.likely_causes(), "; ")));
    if (shift.is_accepted) {
      return say("the common shift is accepted (--accept-shift): below, the saved values are those with it");
    }
    say(fmt::format(
        "the common shift is not part of the new values, which leave the bed's centre at the height that the saved "
        "values give it. To find its cause, lower the nozzle slowly onto a sheet of paper at the bed's centre. Where "
        "the firmware then shows Z near 0, state the trigger height of the probe (column height_mm, of Klipper "
        "z_offset). Where it shows Z "
        "near {:+.1f}, the bed stands there: add --accept-shift",
        shift.value));
  }

  void saved_values(bool same) {
    constexpr double kBelongs = 1.01;                          // of the optimum's cost
    const double floor = 1e-6 * static_cast<double>(count());  // mm^2
    const bool belongs = found_.saved.ok() && found_.saved.cost <= kBelongs * found_.firmware.cost + floor;
    if (belongs || same || !found_.firmware.ok()) return;
    say(fmt::format(
        "the saved values are not the firmware's fit of these readings: they explain {}, that would {}. They are of "
        "other readings, or something was changed since",
        explained(found_.saved), explained(found_.firmware)));
  }

  /// "the heights to 0.012 mm and the distances to 0.034 mm"
  std::string explained(const DeltaFit& fit) const {
    std::string heights = readings_.heights.empty() ? "" : fmt::format("the heights to {:.3f} mm", fit.rms_height);
    if (!has_distances()) return heights;
    return fmt::format("{}{}the distances to {:.3f} mm", heights, heights.empty() ? "" : " and ", fit.rms_distance);
  }

  void what_can_be_told() {
    for (const std::string& note : found_.calibration.notes) say(note);
    say(fmt::format("the readings tell {} thing{} about the machine; the rest is taken to be as printers usually are",
                    found_.calibration.rank, found_.calibration.rank == 1 ? "" : "s"));
    say(has_distances()
            ? "heights and distances do not show where along the bed the printer believes its centre, nor how it is "
              "turned about z"
            : "heights alone show how flat the nozzle goes where they were taken, and hardly the size of prints: for "
              "that measure printed distances; nor do they show the centre or the turn about z");
    if (found_.bed.is_bowed) bowed();
    if (has_distances()) {
      size();
      say("sizes are those of prints in the plastic that was measured: one that shrinks by 0.3 % makes the machine "
          "0.3 % larger, so that its prints come out right");
    }
    if (!found_.uncheckable.empty()) unnoticed();
  }

  void bowed() {
    const BedFlatness& bed = found_.bed;
    const std::string edge = fmt::format("the bed's edge lies {:+.2f} mm (U = {:.2f} mm, k = 2) above its centre",
                                         bed.edge, 2.0 * bed.edge_std);
    say(bed.is_told
            ? fmt::format("the bed is no plane: {}; that is taken off the heights", edge)
            : fmt::format("heights and distances contradict each other: {}, or the bed is flat and all distances were "
                          "read {:+.2f} mm too long; these readings cannot tell which",
                          edge, bed.or_bias));
  }

  void size() {
    const PrintSize& size = found_.size;
    if (size.bias_is_there) {
      say(
          fmt::format("all distances were read {:+.3f} mm (U = {:.3f} mm, k = 2) too long: walls or calliper; that is "
                      "taken off, and the size of prints is known without it",
                      size.bias, 2.0 * size.bias_std));
      return;
    }
    say(fmt::format("{}; for that the size of prints may be off by {:.2f} %{}", open_bias(), 1e2 * size.open,
                    size.bias_can_be_told ? "" : ": measure distances of two lengths, one twice the other"));
  }

  /// What is not known of walls and calliper.
  std::string open_bias() const {
    const PrintSize& size = found_.size;
    if (found_.bed.is_bowed && !found_.bed.is_told) {
      return fmt::format("what walls or calliper add to all distances is not known (U = {:.3f} mm, k = 2)",
                         2.0 * size.bias_std);
    }
    if (size.bias_can_be_told) {
      return fmt::format(
          "what walls or calliper add to all distances, {:+.3f} mm by these readings (U = {:.3f} mm, k = 2), is not "
          "told from nothing and stays on them",
          size.bias, 2.0 * size.bias_std);
    }
    const auto [least, most] = std::ranges::minmax(readings_.distances, {}, &PrintedDistance::distance);
    return fmt::format(
        "of distances of {:.0f} to {:.0f} mm, read as these were, it cannot be told whether walls or calliper make "
        "them 0.2 mm too long or the machine is larger",
        least.distance, most.distance);
  }

  void unnoticed() {
    if (found_.uncheckable.size() == count()) {
      return say(
          "no reading can be checked by the others: 1 mm in a height or 0.5 mm in a distance would go unnoticed");
    }
    std::string names = of_kind("height", readings_.heights.size());
    const std::string distances = of_kind("distance", readings_.distances.size());
    names += (names.empty() || distances.empty() ? "" : "; ") + distances;
    say(fmt::format("cannot be checked by the others, 1 mm in a height or 0.5 mm in a distance would go unnoticed: {}",
                    names));
  }

  /// Those of one kind that cannot be checked.
  std::string of_kind(std::string_view kind, std::size_t of) const {
    std::string names;
    std::size_t count = 0;
    for (const std::string& one : found_.uncheckable) {
      if (!one.starts_with(kind)) continue;
      names += (names.empty() ? "" : ", ") + one;
      ++count;
    }
    return count == of && of > 0 ? fmt::format("all {}s", kind) : names;
  }

  void judged() {
    const PrinterCandidate &ours = found_.written, &theirs = found_.by_firmware;
    say(
        fmt::format("shape of prints over the place of the readings, expected from all that is known: off by {:.0f} um "
                    "(rms) with the saved values, {:.0f} um with the firmware's fit, {:.0f} um with the new ones, of "
                    "which the controller has no parameter for {:.0f} um",
                    1e3 * found_.expected_shape, 1e3 * theirs.expected_shape, 1e3 * ours.expected_shape,
                    1e3 * found_.projection.accuracy.shape_rms));
    if (!found_.tested()) return;
    say(
        fmt::format("readings held out and predicted from the others, by the firmware's formula{}, heights{}: {} with "
                    "the saved values, {} with the firmware's fit, {} with the new values",
                    found_.size.bias_is_there ? " and with the distances' bias" : "",
                    has_distances() ? " and distances" : fmt::format(" in {} groups", found_.groups),
                    in_words(found_.held_out, has_distances()), in_words(theirs.held_out, has_distances()),
                    in_words(ours.held_out, has_distances())));
    say(gain_in_words("new values", ours));
    if (found_.saved_is_fit) return say("the saved values are the firmware's fit of these readings");
    say(gain_in_words("firmware's fit", theirs));
  }

  /// Why nothing is better, in the words of what was asked of the new values.
  std::string why_kept(bool few) const {
    const PrinterCandidate& ours = found_.written;
    const auto [ours_height, ours_distance] = ours.held_out;
    const PredictionErrors& saved = found_.held_out;
    if (ours.some_kind_worse) {
      const bool heights = ours_height > saved.height;
      return fmt::format(
          "the new values predict {} that were held out worse than the saved ones do, {:.3f} mm instead "
          "of {:.3f} mm, whatever they gain elsewhere",
          heights ? "heights" : "distances", heights ? ours_height : ours_distance,
          heights ? saved.height : saved.distance);
    }
    if (few) return "so few heights hardly test values";
    if (lowers_nozzle(ours, found_)) {
      return fmt::format("the new values move the nozzle down by more than {:.1f} mm at the bed's centre",
                         CommonShift::kLargestUnasked);
    }
    if (!is_enough_of_heights(ours, found_)) {
      return "heights alone hardly tell the size of prints, and the new values do not explain them so much better that "
             "it would not matter";
    }
    if (better(ours, found_)) {
      return "the new values are better than the saved ones, but predict readings that were held out worse than the "
             "firmware's fit does, which is not known to be better than the saved ones";
    }
    const double chance = std::min(ours.least_chance(), 0.999);
    if (chance >= kCertain) {
      return fmt::format(
          "the new values are better with a chance of {:.1f} % by all that is known, but readings that "
          "were held out do not say so",
          1e2 * chance);
    }
    return fmt::format("the new values are better with a chance of {:.1f} %, of {:.0f} % that are asked", 1e2 * chance,
                       1e2 * kCertain);
  }

  /// What would make advice possible.
  std::string wanted(bool few) const {
    if (few) {
      return fmt::format("measure {} more heights, or print the object and measure distances of two lengths",
                         std::max<std::size_t>(detail::kFewestHeights - readings_.heights.size(), 6));
    }
    if (!has_distances()) return "print the object and measure distances of two lengths";
    if (found_.bed.is_bowed) return "lay a straight edge across the bed: it shows whether its edge is as high as said";
    if (!found_.size.bias_can_be_told) return "print the object at two sizes and measure its distances";
    return "repeat the distances, or measure more heights";
  }

 private:
  const DeltaReadings& readings_;
  PrinterCalibration& found_;
};

}  // namespace

void detail::advise(const DeltaReadings& readings, const std::vector<std::string>& implausible,
                    PrinterCalibration& result) {
  constexpr double kSame = 2e-3;  // mm: no printer shows less
  Findings findings(readings, result);
  if (!implausible.empty()) {
    for (const std::string& one : implausible) findings.say(one);
    findings.common_shift();
    result.advice = PrinterAdvice::check_input;
    return findings.say("warning: your file or your readings are wrong; nothing is advised before that is found");
  }
  const auto differs = [&](const DeltaGeometry& one) {
    const Eigen::Array<double, DeltaNumber::count, 1> by =
        (numbers_of(one) - numbers_of(result.saved.geometry)).array();
    return by.segment<2>(DeltaNumber::angle).abs().maxCoeff() * one.radius > kSame ||
           by.head<3>().abs().maxCoeff() > kSame || by.tail<8>().abs().maxCoeff() > kSame;
  };
  const bool same = !differs(result.written.geometry);
  findings.common_shift();
  findings.saved_values(same);
  findings.what_can_be_told();
  const std::size_t gross = std::ranges::count(result.calibration.lengths, true, &LengthResidual::excluded);
  const bool few = readings.distances.empty() && readings.heights.size() - gross < kFewestHeights;
  findings.judged();
  result.advice = same ? PrinterAdvice::keep_saved : advice_of(few, result);
  switch (result.advice) {
    case PrinterAdvice::accept_new:
      return findings.say("accept the new values");
    case PrinterAdvice::take_firmware:
      return findings.say(
          "warning: take the firmware's fit: it is better than the saved values, and the new ones are not known to be "
          "better than it");
    default:
      break;
  }
  if (result.shift.is_accepted) {
    result.advice = PrinterAdvice::accept_shift;
    return findings.say("accept the saved values with the common shift: nothing shows that another shape is better");
  }
  if (same) return findings.say("nothing to change: the saved values are those of this calibration");
  findings.say(
      result.tested()
          ? fmt::format("warning: keep what you have: {}; to decide, {}", findings.why_kept(few), findings.wanted(few))
          : fmt::format(
                "warning: keep what you have: {} readings are too few to check the {} numbers of the firmware's "
                "own fit with; {}",
                findings.count(), result.firmware.parameters, findings.wanted(few)));
}

std::string_view name(PrinterAdvice advice) {
  switch (advice) {
    case PrinterAdvice::accept_new:
      return "accept_new";
    case PrinterAdvice::take_firmware:
      return "take_firmware";
    case PrinterAdvice::check_input:
      return "check_input";
    case PrinterAdvice::accept_shift:
      return "accept_shift";
    case PrinterAdvice::keep_saved:
      break;
  }
  return "keep_saved";
}

}  // namespace paracal
