#include "paracal/printer/printer_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>

#include "paracal/calibration/identification.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"

namespace paracal {
namespace {

/// Both ways of knowing a printer, from the same readings.
struct Known {
  DeltaFit firmware;
  PrinterMachine printer;
  Measurements measurements;
  Calibration calibration;
};

std::optional<Known> known_from(const DeltaGeometry& start, const DeltaReadings& readings, double print_radius) {
  DeltaFit firmware = fit_as_firmware(start, readings);
  const DeltaGeometry& nominal = firmware.ok() ? firmware.geometry : start;
  PrinterMachine printer = printer_machine(nominal, print_radius);
  Measurements measurements = printer_measurements(printer, nominal, readings);
  Calibration calibration = calibrate(printer.robot, measurements, printer_options(printer.robot, readings));
  if (calibration.planes.empty()) return std::nullopt;
  return Known{firmware, std::move(printer), std::move(measurements), std::move(calibration)};
}

std::optional<Eigen::Vector3d> place_of(const Known& known, const Machine& machine, const JointDrops& drops) {
  const ForwardResult taken = forward(machine, known.printer.joints_at(drops));
  return taken.ok() ? std::optional(taken.plate.position) : std::nullopt;
}

/// Predicted minus measured, mm: by the firmware's fit, by ours; not finite where a machine does not close.
std::pair<double, double> errors_of(const Known& known, const BedReading& reading) {
  const auto theirs = nozzle(known.firmware.geometry, reading.drops);
  const auto ours = place_of(known, build(known.printer.robot, known.calibration.errors()), reading.drops);
  if (!theirs || !ours) return {NAN, NAN};
  const FoundPlane& bed = known.calibration.planes.front();
  return {theirs->z() - reading.height,
          ours->z() - bed.height - bed.slope_x * ours->x() - bed.slope_y * ours->y() - reading.height};
}

std::pair<double, double> errors_of(const Known& known, const PrintedDistance& reading) {
  const DeltaGeometry& g = known.firmware.geometry;
  const Machine machine = build(known.printer.robot, known.calibration.errors());
  const auto from = nozzle(g, reading.from), to = nozzle(g, reading.to);
  const auto our_from = place_of(known, machine, reading.from), our_to = place_of(known, machine, reading.to);
  if (!from || !to || !our_from || !our_to) return {NAN, NAN};
  return {(*to - *from).norm() - reading.distance,
          (*our_to - *our_from).norm() + known.calibration.distance_bias.value_or(0.0) - reading.distance};
}

/// Root mean squares of the errors of one kind of readings, each left out in turn: the firmware's, ours.
template <typename Reading>
std::pair<double, double> left_out(const DeltaGeometry& start, const DeltaReadings& all,
                                   std::vector<Reading> DeltaReadings::*kind) {
  double theirs = 0.0, ours = 0.0;
  const std::vector<Reading>& readings = all.*kind;
  if (readings.empty()) return {0.0, 0.0};
  for (std::size_t k = 0; k < readings.size(); ++k) {
    DeltaReadings rest = all;
    (rest.*kind).erase((rest.*kind).begin() + static_cast<std::ptrdiff_t>(k));
    const auto known = known_from(start, rest, 0.0);
    if (!known) return {NAN, NAN};
    const auto [their_error, our_error] = errors_of(*known, readings[k]);
    theirs += their_error * their_error;
    ours += our_error * our_error;
  }
  const auto count = static_cast<double>(readings.size());
  return {std::sqrt(theirs / count), std::sqrt(ours / count)};
}

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

/// Weighted with what readings of each kind are worth.
double summed(const PredictionErrors& errors) {
  const NoiseModel noise = CalibrationOptions{}.noise;
  return std::hypot(errors.height / noise.height, errors.distance / noise.distance);
}

void tell(const DeltaReadings& readings, PrinterCalibration& result) {
  const auto say = [&](std::string_view text) { result.findings.emplace_back(text); };
  constexpr double kBelongs = 1.01, kBetter = 0.98;  // of the optimum's cost; of what the firmware's fit predicts to
  const double floor = 1e-6 * static_cast<double>(readings.heights.size() + readings.distances.size());  // mm^2
  const bool has_distances = !readings.distances.empty();
  const bool belongs =
      !result.tested() || (result.saved.ok() && result.saved.cost <= kBelongs * result.firmware.cost + floor);
  if (!belongs) {
    say(fmt::format(
        "the saved values do not belong to these readings: they explain the heights to {:.3f} mm, where the "
        "firmware's own fit would to {:.3f} mm. Was something changed, or the calibration not saved?",
        result.saved.rms_height, result.firmware.rms_height));
  }
  for (const std::string& note : result.calibration.notes) say(note);
  say(fmt::format("the readings tell {} thing{} about the machine; the rest is taken to be as printers usually are",
                  result.calibration.rank, result.calibration.rank == 1 ? "" : "s"));
  say(has_distances
          ? "heights and distances do not show where along the bed the printer believes its centre, nor how it is "
            "turned about z"
          : "heights alone do not show the length of the rods, and so not the size of prints: measure printed "
            "distances; nor do they show the centre or the turn about z");
  const DeltaAccuracy &before = result.accuracy_before, &after = result.projection.accuracy;
  say(fmt::format(
      "shape of prints over the place of the readings, if this calibration is right: off by {:.0f} um (rms) with the "
      "saved values, {:.0f} um with the new ones, for which the controller has no parameter; absolute {:.0f} and "
      "{:.0f} um",
      1e3 * before.shape_rms, 1e3 * after.shape_rms, 1e3 * before.absolute_rms, 1e3 * after.absolute_rms));
  if (!result.tested()) {
    result.advice = PrinterAdvice::keep_saved;
    return say(
        fmt::format("warning: keep the saved values: {} readings are too few to check the {} numbers of the "
                    "firmware's own fit with; measure more",
                    readings.heights.size() + readings.distances.size(), result.firmware.parameters));
  }
  say(fmt::format("readings left out and predicted from the others: heights to {:.3f} mm (firmware's fit {:.3f} mm){}",
                  result.predicted.height, result.by_firmware.height,
                  has_distances ? fmt::format(", distances to {:.3f} mm ({:.3f} mm)", result.predicted.distance,
                                              result.by_firmware.distance)
                                : std::string()));
  const bool better = summed(result.predicted) <= kBetter * summed(result.by_firmware);
  if (result.projection.ok() && better && result.calibration.verdict != Verdict::not_converged) {
    result.advice = PrinterAdvice::accept_new;
    return say("accept the new values");
  }
  result.advice = belongs || !result.firmware.ok() ? PrinterAdvice::keep_saved : PrinterAdvice::take_firmware;
  say(result.advice == PrinterAdvice::keep_saved
          ? "warning: keep the saved values: the new ones do not predict readings better"
          : "warning: the new values do not predict readings better than the firmware's own fit: take that one's");
}

}  // namespace

const DeltaGeometry& PrinterCalibration::advised() const {
  switch (advice) {
    case PrinterAdvice::accept_new:
      return projection.geometry;
    case PrinterAdvice::take_firmware:
      return firmware.geometry;
    case PrinterAdvice::keep_saved:
      break;
  }
  return saved.geometry;
}

std::optional<std::pair<PredictionErrors, PredictionErrors>> leave_one_out(const DeltaGeometry& start,
                                                                           const DeltaReadings& readings) {
  const std::size_t count = readings.heights.size() + readings.distances.size();
  const auto parameters = firmware_basis(start.actuator, !readings.distances.empty()).cols();
  if (count <= static_cast<std::size_t>(parameters)) return std::nullopt;
  const auto [their_heights, our_heights] = left_out(start, readings, &DeltaReadings::heights);
  const auto [their_distances, our_distances] = left_out(start, readings, &DeltaReadings::distances);
  if (!std::isfinite(our_heights + our_distances + their_heights + their_distances)) return std::nullopt;
  return std::pair{PredictionErrors{their_heights, their_distances}, PredictionErrors{our_heights, our_distances}};
}

PrinterCalibration calibrate_printer(const DeltaGeometry& saved, const DeltaReadings& readings, double print_radius) {
  auto known = known_from(saved, readings, print_radius > 0.0 ? print_radius : covered_radius(saved, readings));
  if (!known) {
    throw Unreachable(
        "the printer's machine does not close at every reading: are step counts and geometry of one printer?");
  }
  const KnownPrinter machine{known->printer, known->calibration.errors(), known->calibration.planes.front()};
  PrinterCalibration result{
      .saved = judge_as_firmware(saved, readings),
      .firmware = known->firmware,
      .measurements = std::move(known->measurements),
      .calibration = std::move(known->calibration),
      .known = machine,
      .projection = project(machine, known->firmware.geometry,
                            readings.distances.empty() ? ControllerRods::kept : ControllerRods::each),
      .accuracy_before = accuracy_of(machine, saved),
      .predicted = {},
      .by_firmware = {},
      .findings = {}};
  if (const auto errors = leave_one_out(saved, readings)) {
    std::tie(result.by_firmware, result.predicted) = *errors;
  }
  tell(readings, result);
  return result;
}

}  // namespace paracal
