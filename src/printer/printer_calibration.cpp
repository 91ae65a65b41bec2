#include "paracal/printer/printer_calibration.hpp"

#include <fmt/format.h>

#include <cmath>

#include "advice_rules.hpp"
#include "paracal/error.hpp"
#include "paracal/printer/plausibility.hpp"
#include "printer_fit.hpp"

namespace paracal {
namespace {

/// Radius of the place where the readings were taken, mm.
double covered_radius(const DeltaGeometry& geometry, const DeltaReadings& readings) {
  double radius = 0.0;
  const auto cover = [&](const JointDrops& drops) {
    if (const auto place = nozzle(geometry, drops)) radius = std::max(radius, place->head<2>().norm());
  };
  for (const BedReading& reading : readings.heights) cover(reading.drops);
  for (const PrintedDistance& reading : readings.distances) {
    cover(reading.from);
    cover(reading.to);
  }
  return radius;
}

/// The readings that the calibration did not leave out.
DeltaReadings without_gross(const DeltaReadings& all, const Calibration& calibration) {
  DeltaReadings good;
  for (std::size_t k = 0; k < calibration.lengths.size(); ++k) {
    if (!calibration.lengths[k].excluded) good.heights.push_back(all.heights[k]);
  }
  for (std::size_t k = 0; k < calibration.distances.size(); ++k) {
    if (!calibration.distances[k].excluded) good.distances.push_back(all.distances[k]);
  }
  return good;
}

/// Share by which the size of prints may be off (k = 2): what the bias leaves open of the mean distance.
/// @param stays  the bias as estimated that is not taken off, mm.
double open_size(const DeltaReadings& readings, double stays, double bias_std) {
  double sum = 0.0;
  for (const PrintedDistance& one : readings.distances) sum += one.distance;
  return sum > 0.0 ? (std::abs(stays) + 2.0 * bias_std) * static_cast<double>(readings.distances.size()) / sum : 0.0;
}

PrintSize size_of(const detail::ReadingTrial& trial, const DeltaReadings& readings) {
  const double std = trial.bias_can_be_told ? trial.bias_std : kDistanceBias;
  return {.bias_can_be_told = trial.bias_can_be_told,
          .bias_is_there = trial.bias_is_there,
          .bias = trial.bias_can_be_told ? trial.bias : 0.0,
          .bias_std = std,
          .open = open_size(readings, trial.bias_can_be_told && !trial.bias_is_there ? trial.bias : 0.0, std)};
}

/// Largest depth of the nozzle at z = 0 below the bed where its height was read, mm.
double depth_at_heights(const DeltaGeometry& geometry, const DeltaReadings& readings) {
  double depth = 0.0;
  for (const BedReading& one : readings.heights) {
    const auto at = nozzle(geometry, one.drops);
    depth = std::max(depth, at ? at->z() - one.height : INFINITY);
  }
  return depth;
}

PrinterCandidate candidate(const DeltaGeometry& geometry, const DeltaGeometry& saved, const DeltaReadings& readings,
                           const KnownPrinter& known, const std::optional<HeldOut>& held_out,
                           double HeldOutReading::*by) {
  PrinterCandidate one{.geometry = geometry,
                       .held_out = {},
                       .gain = {},
                       .some_kind_worse = false,
                       .chance_better = chance_better(known, geometry, saved),
                       .chance_above_bed = chance_better(known, geometry, saved, CountedFrom::bed),
                       .expected_shape = expected_shape(known, geometry),
                       .depth = std::max(depth_at_heights(geometry, readings), depth_at_zero(known, geometry))};
  if (!held_out) return one;
  one.held_out = held_out->errors(by);
  one.gain = held_out->gain(by);
  one.some_kind_worse = held_out->some_kind_worse(by);
  return one;
}

/// Readings that nobody would notice to be wrong: put off by so much, either way, they are not left out as gross. Tried
/// beside those that were not left out: what is wrong already would be found again at every trial.
std::vector<std::string> unnoticed(const DeltaGeometry& saved, const DeltaReadings& readings, const Calibration& found,
                                   const detail::PrinterFitOptions& options) {
  constexpr double kHeight = 1.0, kDistance = 0.5;  // mm
  constexpr std::size_t kMost = 100;                // of more readings each is checked by many
  std::vector<std::string> names;
  if (readings.heights.size() + readings.distances.size() > kMost) return names;
  const DeltaReadings good = without_gross(readings, found);
  const auto is_noticed = [&](const DeltaReadings& wrong, const auto& is_excluded) {
    const auto fit = detail::fit_printer(saved, wrong, options);
    return fit && is_excluded(fit->calibration);
  };
  const auto try_both = [&](const auto& off_by, const auto& is_excluded, std::string name) {
    DeltaReadings above = good, below = good;
    off_by(above, 1.0);
    off_by(below, -1.0);
    if (!is_noticed(above, is_excluded) || !is_noticed(below, is_excluded)) names.push_back(std::move(name));
  };
  std::size_t at = 0;  // among the good ones
  for (std::size_t k = 0; k < readings.heights.size(); ++k) {
    if (found.lengths[k].excluded) continue;
    try_both([&](DeltaReadings& all, double sign) { all.heights[at].height += sign * kHeight; },
             [&](const Calibration& trial) { return trial.lengths[at].excluded; }, fmt::format("height{}", k));
    ++at;
  }
  at = 0;
  for (std::size_t k = 0; k < readings.distances.size(); ++k) {
    if (found.distances[k].excluded) continue;
    try_both([&](DeltaReadings& all, double sign) { all.distances[at].distance += sign * kDistance; },
             [&](const Calibration& trial) { return trial.distances[at].excluded; }, fmt::format("distance{}", k));
    ++at;
  }
  return names;
}

std::vector<std::string> all_implausible(const DeltaGeometry& saved, const DeltaReadings& readings,
                                         const DeltaFit& fit) {
  std::vector<std::string> wrong = implausible(saved);
  const std::vector<std::string> more = implausible(saved, readings, fit);
  wrong.insert(wrong.end(), more.begin(), more.end());
  return wrong;
}

/// What rests on a wrong file or on wrong readings corrects no program.
void reject(const std::vector<std::string>& wrong, Calibration& calibration) {
  if (calibration.accepted()) calibration.verdict = Verdict::rejected;
  calibration.reasons.insert(calibration.reasons.begin(), wrong.begin(), wrong.end());
  calibration.use.reset();
}

/// Where no machine closes: with what is likely to be wrong.
[[noreturn]] void refuse(const DeltaGeometry& saved, const DeltaReadings& readings) {
  const std::vector<std::string> wrong = all_implausible(saved, readings, fit_as_firmware(saved, readings));
  throw Unreachable(fmt::format("the geometry of the file cannot reach every reading: {}",
                                wrong.empty() ? "check that both are of the same printer" : wrong.front()));
}

}  // namespace

bool PrinterCalibration::is_advised() const {
  return advice == PrinterAdvice::accept_new || advice == PrinterAdvice::take_firmware ||
         advice == PrinterAdvice::accept_shift;
}

const DeltaGeometry& PrinterCalibration::advised() const {
  switch (advice) {
    case PrinterAdvice::accept_new:
      return written.geometry;
    case PrinterAdvice::take_firmware:
      return by_firmware.geometry;
    default:
      return saved.geometry;
  }
}

namespace {

/// What all heights share, gross readings left out, unless steps of another size would explain it better than the shift
/// does.
CommonShift find_shift(const DeltaGeometry& saved, const DeltaReadings& readings) {
  const auto fit = detail::fit_printer(saved, readings, {});
  if (!fit || !fit->firmware.ok()) return {.endstop = saved.endstop};
  const DeltaReadings good = without_gross(readings, fit->calibration);
  CommonShift shift = common_shift(saved, good, height_noise(fit_as_firmware(saved, good), good));
  shift.is_stated = shift.is_stated && !has_wrong_steps(saved, good, without_shift(good, shift.value));
  return shift;
}

/// What was found in the readings before they are fitted.
struct Looked {
  CommonShift shift;
  TriggerError trigger;
  std::optional<std::string> wrong = {};  ///< what forbids advice
};

/// With the readings as they are.
PrinterCalibration calibrate_as_read(const DeltaGeometry& saved, const DeltaReadings& readings,
                                     const PrinterCalibrationOptions& options, const Looked& looked) {
  const double radius = options.print_radius > 0.0 ? options.print_radius : covered_radius(saved, readings);
  const detail::ReadingTrial trial = detail::try_readings(saved, readings, radius);
  const detail::PrinterFitOptions sought{.seeks_bias = trial.bias_is_there, .bow_radius = trial.bow_radius()};
  detail::PrinterFitOptions stated = sought;
  stated.print_radius = radius;
  stated.states_use = true;
  auto fit = detail::fit_printer(saved, readings, stated);
  if (!fit) refuse(saved, readings);
  const DeltaReadings good = without_gross(readings, fit->calibration);
  const DeltaFit checked = fit_as_firmware(saved, good);
  const PrintSize size = size_of(trial, good);
  KnownPrinter known = above_plane(known_printer(fit->printer, fit->calibration, fit->bow_radius));
  const KnownPrinter judge = trial.known.value_or(known);
  // What is not known of bow and bias counts in U, whichever of them the fit sought.
  if (judge.parameters.size() == known.parameters.size()) known.covariance = above_plane(judge).covariance;
  const DeltaFit judged = judge_as_firmware(saved, good);
  const bool saved_is_fit = judged.ok() && judged.cost <= 1.01 * checked.cost + 1e-9;
  std::vector<std::string> wrong = all_implausible(saved, good, checked);
  if (looked.wrong) wrong.insert(wrong.begin(), *looked.wrong);
  // Of a wrong file or wrong readings nothing is advised, whatever these many fits would say.
  std::optional<HeldOut> held_out;
  std::vector<std::string> uncheckable;
  if (wrong.empty()) {
    held_out = hold_out(saved, good, sought.seeks_bias, sought.bow_radius, saved_is_fit);
    if (options.tries_gross) uncheckable = unnoticed(saved, readings, fit->calibration, sought);
  }
  const DeltaProjection projection = fit->written();
  PrinterCalibration result{
      .saved = judge_as_firmware(saved, readings),
      .firmware = fit->firmware,
      .measurements = std::move(fit->measurements),
      .calibration = above_bed(std::move(fit->calibration), known, unseen_motion(known, saved)),
      .known = known,
      .projection = projection,
      .written = candidate(projection.geometry, saved, good, judge, held_out, &HeldOutReading::written),
      .by_firmware = candidate(checked.geometry, saved, good, judge, held_out, &HeldOutReading::firmware),
      .held_out = held_out ? held_out->errors(&HeldOutReading::saved) : PredictionErrors{},
      .groups = held_out ? held_out->groups : 0,
      .expected_shape = expected_shape(judge, saved),
      .saved_is_fit = saved_is_fit,
      .accuracy_before = accuracy_of(known, saved),
      .size = size,
      .bed = trial.bed,
      .shift = looked.shift,
      .trigger = looked.trigger,
      .uncheckable = std::move(uncheckable),
      .findings = {}};
  detail::advise(readings, wrong, result);
  if (!wrong.empty()) reject(wrong, result.calibration);
  return result;
}

}  // namespace

PrinterCalibration calibrate_printer(const DeltaGeometry& saved, const DeltaReadings& read,
                                     const PrinterCalibrationOptions& options) {
  require_places(saved, read);
  Looked looked{.shift = {.endstop = saved.endstop}, .trigger = trigger_error(saved, read)};
  const DeltaReadings readings = by_paper(read, looked.trigger);
  const std::optional<std::string> sign = wrong_sign(saved, read);
  CommonShift& shift = looked.shift;
  shift = find_shift(saved, readings);
  shift.has_wrong_sign = sign.has_value();
  if (!shift.is_stated) looked.wrong = sign;  // the endstops follow the wrong sign
  if (!shift.is_stated) return calibrate_as_read(saved, readings, options, looked);
  if (options.accepts_shift && !sign) {
    shift.is_accepted = true;
    PrinterCalibration found = calibrate_as_read(with_bed_higher(saved, shift.value), readings, options, looked);
    if (found.advice != PrinterAdvice::check_input) return found;
    shift.is_accepted = false;  // nothing is built on a wrong file
  }
  return calibrate_as_read(saved, without_shift(readings, shift.value), options, looked);
}

}  // namespace paracal
