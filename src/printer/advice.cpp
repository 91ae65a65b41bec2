#include "advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace paracal {
namespace {

constexpr double kCertain = 0.95;

bool no_kind_worse(const PredictionErrors& errors, const PredictionErrors& than) {
  return errors.height <= than.height && errors.distance <= than.distance;
}

/// Heights tell how flat a machine goes, and hardly how large: values that explain them a little better than those in
/// use may lose more in size, which nobody measured, than they gain. Only where the saved values are far off, the mean
/// square error of held-out heights falling by 5 parts in 6 (a factor of 2.4), are heights enough.
bool is_enough_of_heights(const PrinterCandidate& values, const PrinterCalibration& found) {
  constexpr double kMuch = 5.0 / 6.0;
  return !found.measurements.distances.empty() || values.gain.value >= kMuch;
}

/// Better than the saved values by more than chance: by what the calibration knows and by the readings that were held
/// out; either may be certain alone if the other does not contradict. Heights that were held out say nothing of the
/// size of prints, and those of a bowed bed the wrong thing: what is known has to be certain of that by itself.
bool better(const PrinterCandidate& values, const PrinterCalibration& found) {
  constexpr double kLikely = 0.8;
  if (!found.tested() || values.some_kind_worse || !is_enough_of_heights(values, found)) return false;
  const double likely = found.measurements.distances.empty() || found.bed.is_bowed ? kCertain : kLikely;
  return (values.least_chance() >= kCertain && values.gain.value > 0.0) ||
         (values.least_chance() >= likely && values.gain.low > 0.0);
}

/// On no kind of readings more than a twentieth worse.
bool as_good_as_firmware(const PrinterCalibration& found) {
  constexpr double kAsGood = 1.05;
  const PredictionErrors theirs = found.by_firmware.held_out;
  return no_kind_worse(found.written.held_out, {kAsGood * theirs.height, kAsGood * theirs.distance});
}

/// Seven heights cannot test a fit of six numbers: there the whole calibration, which its priors hold, must predict
/// what it has not seen better than the saved values do.
bool better_of_few(const PrinterCalibration& found) {
  return found.tested() && found.by_firmware.least_chance() >= kCertain && found.written.gain.low > 0.0;
}

PrinterAdvice advice_of(bool few, const PrinterCalibration& found) {
  if (few) return better_of_few(found) ? PrinterAdvice::take_firmware : PrinterAdvice::keep_saved;
  const bool ours =
      found.projection.ok() && found.calibration.verdict != Verdict::not_converged && better(found.written, found);
  const bool theirs = found.firmware.ok() && better(found.by_firmware, found);
  if (ours && as_good_as_firmware(found)) return PrinterAdvice::accept_new;
  return theirs ? PrinterAdvice::take_firmware : PrinterAdvice::keep_saved;
}

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

  void saved_values(bool same) {
    constexpr double kBelongs = 1.01;                          // of the optimum's cost
    const double floor = 1e-6 * static_cast<double>(count());  // mm^2
    const bool belongs = found_.saved.ok() && found_.saved.cost <= kBelongs * found_.firmware.cost + floor;
    if (belongs || same || !found_.firmware.ok()) return;
    say(fmt::format(
        "the saved values do not belong to these readings: they explain the heights to {:.3f} mm, where the firmware's "
        "own fit would to {:.3f} mm. Was something changed, or the calibration not saved?",
        found_.saved.rms_height, found_.firmware.rms_height));
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
    if (has_distances()) size();
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
    say(fmt::format("{}; for that the size of prints may be off by {:.2f} %{}",
                    found_.bed.is_bowed && !found_.bed.is_told
                        ? fmt::format("what walls or calliper add to all distances is not known (U = {:.3f} mm, k = 2)",
                                      2.0 * size.bias_std)
                    : size.bias_can_be_told
                        ? fmt::format("the distances show no common error of walls or calliper (U = {:.3f} mm, k = 2)",
                                      2.0 * size.bias_std)
                        : "all distances are about alike: whether walls or calliper make them 0.2 mm too long or the "
                          "machine is larger, they cannot tell",
                    1e2 * size.open, size.bias_can_be_told ? "" : ": measure distances of two lengths"));
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
  if (same) return findings.say("nothing to change: the saved values are those of this calibration");
  findings.say(
      result.tested()
          ? fmt::format("warning: keep what you have: nothing is better by more than chance; to decide, {}",
                        findings.wanted(few))
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
    case PrinterAdvice::keep_saved:
      break;
  }
  return "keep_saved";
}

}  // namespace paracal
