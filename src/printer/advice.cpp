#include "advice_rules.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace paracal {
namespace {

using detail::better, detail::is_enough_of_heights, detail::kCertain, detail::scratches_bed;

/// As errors of held-out readings are stated: "0.123 and 0.045 mm".
std::string in_words(const PredictionErrors& errors, bool has_distances) {
  return has_distances ? fmt::format("{:.3f} and {:.3f} mm", errors.height, errors.distance)
                       : fmt::format("{:.3f} mm", errors.height);
}

std::string in_words(const PairedGain& gain) {
  return fmt::format("{:+.0f} % (90 % interval {:+.0f} to {:+.0f} %)", -1e2 * gain.value, -1e2 * gain.high,
                     -1e2 * gain.low);
}

/// In percent. No printer is known better than to a thousandth.
double probability(const PrinterCandidate& values) { return 1e2 * std::min(values.least_chance(), 0.999); }

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
    say(fmt::format(
        "All heights are off by {:+.2f} mm or more: by these readings the bed is {} than by the saved "
        "values. Endstops that follow it: position_endstop {:.1f} {:.1f} {:.1f} mm.",
        shift.value, shift.value > 0.0 ? "higher" : "lower", shift.endstop[0], shift.endstop[1], shift.endstop[2]));
    say(fmt::format("Likely causes of this common shift: {}.", fmt::join(shift.likely_causes(), "; ")));
    if (shift.is_accepted) {
      return say("The common shift is accepted (--accept-shift): all values below include it.");
    }
    if (shift.has_wrong_sign) {
      return say(
          "The probe triggers with the nozzle below the bed, which is impossible: correct the sign of z_offset "
          "(column height_mm). The new values do not include the common shift, and --accept-shift has no effect.");
    }
    if (shift.is_by_hand) {
      return say("The new values do not include the common shift. The heights by hand confirm it: add --accept-shift.");
    }
    say("The new values do not include the common shift. To find its cause, lower the nozzle slowly onto a sheet of "
        "paper at the bed's centre.");
    say(
        fmt::format("If the firmware then shows Z near 0, state the trigger height of the probe (column height_mm, of "
                    "Klipper z_offset). If it shows Z near {:+.2f}, the bed is there: add --accept-shift.",
                    shift.value));
  }

  /// Paper at a place of the probe.
  void trigger() {
    const TriggerError& trigger = found_.trigger;
    if (!trigger.is_stated) return;
    say(fmt::format(
        "Paper and probe differ by {:.2f} mm at {} place{}: the trigger height of the probe is off by that. "
        "Correct z_offset (column height_mm) by {:+.2f} mm. All results follow the paper.",
        std::abs(trigger.value), trigger.places, trigger.places == 1 ? "" : "s", -trigger.value));
  }

  void saved_values(bool same) {
    constexpr double kBelongs = 1.01;                          // of the optimum's cost
    const double floor = 1e-6 * static_cast<double>(count());  // mm^2
    const bool belongs = found_.saved.ok() && found_.saved.cost <= kBelongs * found_.firmware.cost + floor;
    if (belongs || same || !found_.firmware.ok()) return;
    say(
        fmt::format("The saved values are not the firmware's fit of these readings: they leave {}, the fit leaves {} "
                    "(rms). If the printer was changed after these readings, measure again.",
                    left_by(found_.saved), left_by(found_.firmware)));
  }

  /// "0.012 mm in heights and 0.034 mm in distances"
  std::string left_by(const DeltaFit& fit) const {
    std::string heights = readings_.heights.empty() ? "" : fmt::format("{:.3f} mm in heights", fit.rms_height);
    if (!has_distances()) return heights;
    return fmt::format("{}{}{:.3f} mm in distances", heights, heights.empty() ? "" : " and ", fit.rms_distance);
  }

  void what_is_determined() {
    for (const std::string& note : found_.calibration.notes) say(note);
    if (found_.bed.is_bowed) bowed();
    if (has_distances()) {
      size();
    } else {
      say("Heights alone hardly determine the size of prints. For that, print the object and measure its distances.");
    }
    if (!found_.uncheckable.empty()) unnoticed();
    say(fmt::format("The readings determine {} parameter combination{}; the rest are typical values of such printers.",
                    found_.calibration.rank, found_.calibration.rank == 1 ? "" : "s"));
    say("Not determined by these measurements: the bed shifts along x or y, or rotates about z. Prints do not show it, "
        "so nothing is to be done.");
  }

  void bowed() {
    const BedFlatness& bed = found_.bed;
    const std::string edge =
        fmt::format("its edge lies {:+.2f} mm (U {:.2f} mm, k = 2) above its centre", bed.edge, 2.0 * bed.edge_std);
    say(bed.is_told ? fmt::format("The bed is not flat: {}. The heights are corrected for it.", edge)
                    : fmt::format("Heights and distances do not agree. Either the bed is not flat: {}, or the bed is "
                                  "flat and all distances are {:+.2f} mm too long. To find out, lay a straight edge "
                                  "across the bed.",
                                  edge, bed.or_bias));
  }

  void size() {
    const PrintSize& size = found_.size;
    if (size.bias_is_there) {
      say(
          fmt::format("All distances are {:+.3f} mm too long (U {:.3f} mm, k = 2): an offset of walls or calliper. "
                      "The distances are corrected for it.",
                      size.bias, 2.0 * size.bias_std));
    } else {
      say(fmt::format("The size of prints may be off by {:.2f} % (95 %). {}{}", 1e2 * size.open, open_bias(),
                      size.bias_can_be_told ? "" : " Also measure distances of two lengths, one twice the other."));
    }
    say("Sizes hold for the plastic that was measured. For a plastic that shrinks differently, measure a print of it.");
  }

  /// What is not known of walls and calliper.
  std::string open_bias() const {
    const PrintSize& size = found_.size;
    if (found_.bed.is_bowed && !found_.bed.is_told) {
      return fmt::format("An offset of walls or calliper is not determined (U {:.3f} mm, k = 2).", 2.0 * size.bias_std);
    }
    if (size.bias_can_be_told) {
      return fmt::format(
          "All distances may be {:+.3f} mm too long (U {:.3f} mm, k = 2). This is not significant, so they are not "
          "corrected; repeat them to find out.",
          size.bias, 2.0 * size.bias_std);
    }
    const auto [least, most] = std::ranges::minmax(readings_.distances, {}, &PrintedDistance::distance);
    return fmt::format(
        "All distances are {:.0f} to {:.0f} mm, so a calliper offset of 0.2 mm and a wrong scale look the same.",
        least.distance, most.distance);
  }

  void unnoticed() {
    std::string names = of_kind("height", readings_.heights.size());
    const std::string distances = of_kind("distance", readings_.distances.size());
    names += (names.empty() || distances.empty() ? "" : " and ") + distances;
    say(fmt::format(
        "Not checked by any other reading: {}. An error of 1 mm in a height or 0.5 mm in a distance would not be "
        "detected: measure these twice.",
        found_.uncheckable.size() == count() ? "all readings" : names));
  }

  /// Those of one kind that cannot be checked, by name where they are few.
  std::string of_kind(std::string_view kind, std::size_t of) const {
    constexpr std::size_t kFew = 4;
    std::vector<std::string_view> names;
    for (const std::string& one : found_.uncheckable) {
      if (one.starts_with(kind)) names.push_back(one);
    }
    if (names.size() <= kFew) return fmt::format("{}", fmt::join(names, ", "));
    return names.size() == of ? fmt::format("all {}s", kind)
                              : fmt::format("{} of the {} {}s (--json names them)", names.size(), of, kind);
  }

  void judged() {
    const PrinterCandidate &ours = found_.written, &theirs = found_.by_firmware;
    say(
        fmt::format("Expected error of print shape (rms): new values {:.0f} um, firmware's fit {:.0f} um, saved values "
                    "{:.0f} um. The controller's settings cannot correct the last {:.0f} um.",
                    1e3 * ours.expected_shape, 1e3 * theirs.expected_shape, 1e3 * found_.expected_shape,
                    1e3 * found_.projection.accuracy.shape_rms));
    if (!found_.tested()) return;
    say(
        fmt::format("Held-out readings, predicted from the others (rms, {}): new values {}, firmware's fit {}, saved "
                    "values {}.",
                    has_distances() ? "heights and distances" : fmt::format("heights in {} groups", found_.groups),
                    in_words(ours.held_out, has_distances()), in_words(theirs.held_out, has_distances()),
                    in_words(found_.held_out, has_distances())));
    say(fmt::format("Mean square of these errors against the saved values{}: new values {}{}.",
                    found_.saved_is_fit ? " (which are the firmware's fit)" : "", in_words(ours.gain),
                    found_.saved_is_fit ? "" : ", firmware's fit " + in_words(theirs.gain)));
  }

  /// Why nothing is better, in the words of what was asked of the new values.
  std::string why_kept(bool few) const {
    const PrinterCandidate& ours = found_.written;
    const auto [ours_height, ours_distance] = ours.held_out;
    const PredictionErrors& saved = found_.held_out;
    if (ours.some_kind_worse) {
      const bool heights = ours_height > saved.height;
      return fmt::format(
          "the new values predict held-out {} worse than the saved values do, to {:.3f} mm instead of {:.3f} mm",
          heights ? "heights" : "distances", heights ? ours_height : ours_distance,
          heights ? saved.height : saved.distance);
    }
    if (few) return fmt::format("fewer than {} heights alone cannot test new values", detail::kFewestHeights);
    if (scratches_bed(ours)) {
      return fmt::format("with the new values, the nozzle at Z0 would be up to {:.2f} mm below the bed", ours.depth);
    }
    if (!is_enough_of_heights(ours, found_)) {
      return "heights alone hardly determine the size of prints, and the new values predict them only a little better";
    }
    if (better(ours, found_)) {
      return "the firmware's fit predicts held-out readings better than the new values, but it is not certain to be "
             "better than the saved values";
    }
    if (ours.least_chance() >= kCertain) {
      return fmt::format(
          "the new values are better with a probability of {:.1f} %, but held-out readings do not confirm it",
          probability(ours));
    }
    return fmt::format("the new values are better with a probability of only {:.1f} %; {:.0f} % is required",
                       probability(ours), 1e2 * kCertain);
  }

  /// What would make advice possible.
  std::string wanted(bool few) const {
    if (few) {
      return fmt::format("measure {} more heights, or print the object and measure distances of two lengths",
                         std::max<std::size_t>(detail::kFewestHeights - readings_.heights.size(), 6));
    }
    if (!has_distances()) return "print the object and measure distances of two lengths";
    if (found_.bed.is_bowed) return "lay a straight edge across the bed and compare the height of its edge";
    if (!found_.size.bias_can_be_told) return "print the object at two sizes and measure its distances";
    return "repeat the distances, or measure more heights";
  }

  /// The advice in one sentence.
  std::string headline(bool same, bool few) const {
    switch (found_.advice) {
      case PrinterAdvice::accept_new:
        return fmt::format(
            "Accept the new values: they are better than the saved values with a probability of {:.1f} %.",
            probability(found_.written));
      case PrinterAdvice::take_firmware:
        return fmt::format(
            "Use the firmware's fit: it is better than the saved values with a probability of {:.1f} %. The new values "
            "are not certain to be better than it.",
            probability(found_.by_firmware));
      case PrinterAdvice::accept_shift:
        return "Accept the saved values with the common shift: no reading shows that another shape is better.";
      default:
        break;
    }
    if (same) return "Keep your values: there is nothing to change, they are those of this calibration.";
    if (found_.tested()) return fmt::format("Keep your values: {}.", why_kept(few));
    return fmt::format("Keep your values: {} readings are too few to check the {} parameters of the firmware's fit.",
                       count(), found_.firmware.parameters);
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
    result.advice = PrinterAdvice::check_input;
    findings.say("Check your file and your readings: something is wrong, and nothing is advised until it is found.");
    for (const std::string& one : implausible) findings.say(one);
    findings.trigger();
    return findings.common_shift();
  }
  const auto differs = [&](const DeltaGeometry& one) {
    const Eigen::Array<double, DeltaNumber::count, 1> by =
        (numbers_of(one) - numbers_of(result.saved.geometry)).array();
    return by.segment<2>(DeltaNumber::angle).abs().maxCoeff() * one.radius > kSame ||
           by.head<3>().abs().maxCoeff() > kSame || by.tail<8>().abs().maxCoeff() > kSame;
  };
  const bool same = !differs(result.written.geometry);
  const std::size_t gross = std::ranges::count(result.calibration.lengths, true, &LengthResidual::excluded);
  const bool few = readings.distances.empty() && readings.heights.size() - gross < kFewestHeights;
  result.advice = same ? PrinterAdvice::keep_saved : advice_of(few, result);
  if (result.advice == PrinterAdvice::keep_saved && result.shift.is_accepted) {
    result.advice = PrinterAdvice::accept_shift;
  }
  findings.say(findings.headline(same, few));
  findings.trigger();
  findings.common_shift();
  findings.judged();
  findings.saved_values(same);
  findings.what_is_determined();
  if (result.advice == PrinterAdvice::keep_saved && !same) {
    findings.say(fmt::format("To decide, {}.", findings.wanted(few)));
  }
}

std::string_view name(PrinterAdvice advice) {
  constexpr std::array<std::string_view, 5> kNames{"accept_new", "take_firmware", "keep_saved", "accept_shift",
                                                   "check_input"};
  return kNames.at(static_cast<std::size_t>(advice));
}

}  // namespace paracal
