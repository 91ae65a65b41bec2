#include "advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace paracal {
namespace {

constexpr std::size_t kMostNotes = 5;

std::string in_mm(const LadderFigure& layer) { return fmt::format("{:.3f}", layer.value); }
std::string in_percent(const LadderFigure& size) { return fmt::format("{:+.2f} %", 1e2 * size.value); }

/// "(0.012 to 0.034)"
std::string interval(const LadderFigure& layer) { return fmt::format("({:.3f} to {:.3f})", layer.low, layer.high); }
std::string interval_in_percent(const LadderFigure& size) {
  return fmt::format("({:+.2f} to {:+.2f} %)", 1e2 * size.low, 1e2 * size.high);
}

std::string_view values_of(Rung rung) {
  constexpr std::array<std::string_view, 5> kWords{"no value", "the endstops", "endstops and radius",
                                                   "endstops, radius and tower angles",
                                                   "endstops, radius, tower angles and rods"};
  return kWords.at(static_cast<std::size_t>(rung));
}

class Advisor {
 public:
  Advisor(const DeltaReadings& good, PrinterCalibration& found) : good_(good), found_(found) {}

  void headline(std::string text) { found_.findings.insert(found_.findings.begin(), std::move(text)); }
  /// What an owner has to know or to do; beyond five notes it is a detail.
  void note(std::string text) {
    (found_.findings.size() < kMostNotes ? found_.findings : found_.details).push_back(std::move(text));
  }
  void detail(std::string text) { found_.details.push_back(std::move(text)); }
  bool has_distances() const { return !good_.distances.empty(); }
  const Ladder& ladder() const { return found_.ladder; }

  std::string change() const {
    const RungValues &from = ladder().saved(), &to = ladder().best();
    return fmt::format(
        "Change {}: first layer {} -> {} mm rms {}, size of prints {} -> {} {}. Intervals hold with 95 %.",
        values_of(to.rung), in_mm(from.first_layer), in_mm(to.first_layer), interval(to.first_layer),
        in_percent(from.size), in_percent(to.size), interval_in_percent(to.size));
  }

  std::string keep(bool is_same) const {
    const RungValues& saved = ladder().saved();
    return fmt::format(
        "Keep your values: {}. First layer {} mm rms {}, size of prints {} {}. Intervals hold with 95 %.",
        is_same ? "there is nothing to change" : why_kept(), in_mm(saved.first_layer), interval(saved.first_layer),
        in_percent(saved.size), interval_in_percent(saved.size));
  }

  /// Paper at a place of the probe.
  void trigger() {
    const TriggerError& trigger = found_.trigger;
    if (trigger.varies) {
      note(
          fmt::format("The trigger height of the probe varies by {:.2f} mm from place to place. Only heights by hand "
                      "count. Measure the trigger height at each place of a mesh (G30 H), or use another probe.",
                      trigger.spread));
      return;
    }
    if (!trigger.is_stated) return;
    note(fmt::format(
        "Paper and probe differ by {:.2f} mm at {} place{}: the trigger height of the probe is off by that. "
        "Correct z_offset (column height_mm) by {:+.2f} mm. All results follow the paper.",
        std::abs(trigger.value), trigger.places, trigger.places == 1 ? "" : "s", -trigger.value));
  }

  /// What all heights have in common: stated with what may be behind it and how to find out.
  void common_shift() {
    const CommonShift& shift = found_.shift;
    if (!shift.is_stated) return;
    note(fmt::format(
        "All heights are off by {:+.2f} mm or more: by these readings the bed is {} than by the saved "
        "values. Endstops that follow it: position_endstop {:.1f} {:.1f} {:.1f} mm.",
        shift.value, shift.value > 0.0 ? "higher" : "lower", shift.endstop[0], shift.endstop[1], shift.endstop[2]));
    note(fmt::format("Likely causes of this common shift: {}.", fmt::join(shift.likely_causes(), "; ")));
    note(what_to_do_about(shift));
  }

  static std::string what_to_do_about(const CommonShift& shift) {
    if (shift.is_accepted) return "The common shift is accepted (--accept-shift): all values include it.";
    const std::string apart = "The new values do not include the common shift";
    if (shift.has_wrong_sign) {
      return "The probe triggers with the nozzle below the bed, which is impossible: correct the sign of z_offset "
             "(column height_mm). " +
             apart + ", and --accept-shift has no effect.";
    }
    if (shift.is_by_hand) return apart + ". The heights by hand confirm it: add --accept-shift.";
    return fmt::format(
        "{}. To find its cause, lower the nozzle slowly onto a sheet of paper at the bed's centre. If the firmware "
        "then shows Z near 0, state the trigger height of the probe (column height_mm, of Klipper z_offset). If it "
        "shows Z near {:+.2f}, the bed is there: add --accept-shift.",
        apart, shift.value);
  }

  void gross() {
    const auto say = [&](std::string_view kind, const std::vector<std::size_t>& numbers) {
      if (numbers.empty()) return;
      const bool is_one = numbers.size() == 1;
      note(fmt::format("Outlier{} excluded: {}{} {}. Measure {} again.", is_one ? "" : "s", kind, is_one ? "" : "s",
                       fmt::join(numbers, ", "), is_one ? "it" : "them"));
    };
    say("height", ladder().gross.heights);
    say("distance", ladder().gross.distances);
  }

  /// Lengths that nobody cuts so.
  void rods() {
    constexpr double kCut = 1.0;  // mm
    const std::array<double, 3>& rod = found_.saved.geometry.rod;
    const auto [least, most] = std::ranges::minmax(rod);
    if (most - least <= kCut) return;
    note(fmt::format("The rods are entered as {:.2f}, {:.2f} and {:.2f} mm. Rods are usually cut alike: measure them.",
                     rod[0], rod[1], rod[2]));
  }

  /// What would settle the rung above the advised one.
  void next_rung() {
    if (const auto wanted = what_is_wanted(); !wanted.empty()) note(wanted);
  }

  void size() {
    const RungValues& best = ladder().best();
    if (has_distances()) {
      return detail(
          "Sizes hold for the plastic that was measured. For a plastic that shrinks differently, measure a "
          "print of it.");
    }
    if (best.rung < Rung::radius || best.holds_radius) return;
    const double change = best.size.value - ladder().saved().size.value;
    if (std::abs(change) <= LadderRules{}.size) return;
    note(
        fmt::format("The new radius changes the size of prints by {:+.2f} %, because the heights cannot be levelled "
                    "without it. Measure a print before and after.",
                    1e2 * change));
  }

  void ladder_of_values() {
    for (const RungValues& one : ladder().rungs) {
      if (one.rung == Rung::saved) continue;
      detail(fmt::format(
          "Rung {}: first layer {} mm rms {}, better with a probability of {:.1f} %; size of prints {} {}{}; "
          "at Z0 the nozzle is up to {:.2f} mm below the bed{}.",
          name(one.rung), in_mm(one.first_layer), interval(one.first_layer), 1e2 * std::min(one.chance, 0.999),
          in_percent(one.size), interval_in_percent(one.size), one.holds_radius ? ", the radius held back" : "",
          std::max(one.depth, 0.0), one.is_allowed ? "" : ": not advised"));
    }
  }

  void readings() {
    detail(fmt::format("Noise of a height {:.3f} mm{} (1 standard deviation, with the unevenness of the bed).",
                       ladder().noise_height,
                       has_distances() ? fmt::format(", of a distance {:.3f} mm", ladder().noise_distance) : ""));
    const ReadingNumbers& alone = ladder().unchecked;
    const auto say = [&](std::string_view kind, const std::vector<std::size_t>& numbers) {
      if (numbers.empty()) return;
      detail(
          fmt::format("Not checked by any other reading: {}s {}. An error there would not be detected; measure "
                      "these twice.",
                      kind, fmt::join(numbers, ", ")));
    };
    say("height", alone.heights);
    say("distance", alone.distances);
  }

  void saved_values() {
    constexpr double kBelongs = 1.01;                          // of the optimum's cost
    const double floor = 1e-6 * static_cast<double>(count());  // mm^2
    if (!found_.firmware.ok() || (found_.saved.ok() && found_.saved.cost <= kBelongs * found_.firmware.cost + floor))
      return;
    detail(
        fmt::format("The saved values are not the firmware's fit of these readings: they leave {}, the fit leaves {} "
                    "(rms). If the printer was changed after these readings, measure again.",
                    left_by(found_.saved), left_by(found_.firmware)));
  }

  void programs() {
    for (const std::string& one : found_.programs.calibration.notes) detail(one);
    detail(
        "Not determined by these measurements: the bed shifts along x or y, or rotates about z. Prints do not show "
        "it, so nothing is to be done.");
  }

 private:
  std::size_t count() const { return good_.heights.size() + good_.distances.size(); }

  /// "0.012 mm in heights and 0.034 mm in distances"
  std::string left_by(const DeltaFit& fit) const {
    const std::string heights = fmt::format("{:.3f} mm in heights", fit.rms_height);
    return has_distances() ? fmt::format("{} and {:.3f} mm in distances", heights, fit.rms_distance) : heights;
  }

  /// Of the rungs that are not allowed, the one that would gain most.
  const RungValues& nearest() const {
    const auto& rungs = ladder().rungs;
    return *std::ranges::min_element(rungs.begin() + 1, rungs.end(), {},
                                     [](const RungValues& one) { return one.first_layer.value; });
  }

  std::string why_kept() const {
    const RungValues& one = nearest();
    const LadderRules rules;
    if (one.chance < rules.certain) {
      return fmt::format(
          "other values make the first layer better with a probability of only {:.0f} %, and {:.0f} % is "
          "required",
          std::floor(1e2 * one.chance), 1e2 * rules.certain);
    }
    if (one.depth > rules.deepest) {
      return fmt::format("with other values, the nozzle at Z0 would be up to {:.2f} mm below the bed", one.depth);
    }
    return fmt::format("other values would make the size of prints worse with a probability of {:.0f} %",
                       1e2 * one.chance_size);
  }

  /// Two lengths that a calliper measures on a print over most of the disk.
  std::string two_lengths() const {
    const double long_one = 10.0 * std::max(2.0, std::floor(0.11 * found_.print_radius));
    return fmt::format("two lengths of {:.0f} and {:.0f} mm", 10.0 * std::max(1.0, std::round(long_one / 30.0)),
                       long_one);
  }

  std::string what_is_wanted() const {
    const auto next = std::ranges::find_if(ladder().rungs.begin() + static_cast<std::ptrdiff_t>(ladder().advised) + 1,
                                           ladder().rungs.end(), [](const RungValues& one) { return !one.is_allowed; });
    const bool holds = std::ranges::any_of(ladder().rungs, &RungValues::holds_radius);
    if (!has_distances()) {
      if (holds) return fmt::format("Distances of {} on a print would settle the radius.", two_lengths());
      constexpr std::size_t kMany = 13;
      if (next != ladder().rungs.end() && good_.heights.size() < kMany) {
        return fmt::format("{} heights over the whole bed would settle {}.", kMany, values_of(next->rung));
      }
      return fmt::format("Distances of {} on a print would settle the size of prints.", two_lengths());
    }
    if (next == ladder().rungs.end()) return {};
    const auto [least, most] = std::ranges::minmax(good_.distances, {}, &PrintedDistance::distance);
    constexpr double kTwice = 1.5;
    if (most.distance < kTwice * least.distance) {
      return fmt::format(
          "All distances are {:.0f} to {:.0f} mm, so a calliper offset and a wrong scale look the same: "
          "also measure a length of about {:.0f} mm.",
          least.distance, most.distance, 0.4 * most.distance);
    }
    return fmt::format("More heights, or the same distances measured again, would settle {}.", values_of(next->rung));
  }

  const DeltaReadings& good_;
  PrinterCalibration& found_;
};

/// Values that differ by more than any printer shows.
bool differs(const DeltaGeometry& one, const DeltaGeometry& other) {
  constexpr double kSame = 2e-3;  // mm
  const Eigen::Array<double, DeltaNumber::count, 1> by = (numbers_of(one) - numbers_of(other)).array();
  return by.segment<2>(DeltaNumber::angle).abs().maxCoeff() * one.radius > kSame ||
         by.head<3>().abs().maxCoeff() > kSame || by.tail<8>().abs().maxCoeff() > kSame;
}

}  // namespace

void detail::advise(const DeltaReadings& good, const std::vector<std::string>& implausible,
                    PrinterCalibration& result) {
  Advisor advisor(good, result);
  if (!implausible.empty()) {
    result.advice = PrinterAdvice::check_input;
    advisor.headline(
        "Check your file and your readings: something is wrong, and nothing is advised until it is found.");
    for (const std::string& one : implausible) advisor.note(one);
    advisor.trigger();
    return advisor.common_shift();
  }
  const bool is_same = !differs(result.ladder.rungs.back().geometry, result.saved.geometry);
  const bool changes = differs(result.ladder.best().geometry, result.saved.geometry);
  if (changes) result.advice = PrinterAdvice::accept_new;
  if (!changes && result.shift.is_accepted) result.advice = PrinterAdvice::accept_shift;
  advisor.trigger();
  advisor.common_shift();
  advisor.gross();
  advisor.rods();
  advisor.size();
  if (!is_same) advisor.next_rung();
  if (result.advice == PrinterAdvice::accept_shift) {
    advisor.headline("Accept the saved values with the common shift: no reading shows that another shape is better.");
  } else {
    advisor.headline(changes ? advisor.change() : advisor.keep(is_same));
  }
  advisor.ladder_of_values();
  advisor.readings();
  advisor.saved_values();
  advisor.programs();
}

std::string_view name(PrinterAdvice advice) {
  constexpr std::array<std::string_view, 4> kNames{"accept_new", "keep_saved", "accept_shift", "check_input"};
  return kNames.at(static_cast<std::size_t>(advice));
}

}  // namespace paracal
