#include "printer_fit.hpp"

#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/printer/plausibility.hpp"

namespace paracal::detail {

DeltaProjection PrinterFit::written() const {
  const KnownPrinter known{printer, calibration.errors(), found_bed(calibration, bow_radius)};
  const bool told_rods = !measurements.distances.empty();
  return project(known, nominal, told_rods ? ControllerRods::each : ControllerRods::kept);
}

std::optional<PrinterFit> fit_printer(const DeltaGeometry& start, const DeltaReadings& readings,
                                      const PrinterFitOptions& options) {
  DeltaFit firmware = fit_as_firmware(start, readings);
  const bool usable = firmware.ok() && implausible(firmware.geometry).empty();
  const DeltaGeometry& nominal = usable ? firmware.geometry : start;
  const DeltaGeometry& held = implausible(start).empty() ? start : nominal;
  PrinterMachine printer = printer_machine(held, nominal, options.print_radius);
  Measurements measurements = printer_measurements(printer, nominal, readings);
  CalibrationOptions how = printer_options(printer, readings, options.seeks_bias);
  how.states_use = options.states_use;
  if (options.bow_radius > 0.0) how.plane_curvature = kBedBow / (options.bow_radius * options.bow_radius);
  Calibration calibration = calibrate(printer.robot, measurements, how);
  if (calibration.set_ups.empty()) return std::nullopt;
  return PrinterFit{firmware,          nominal, std::move(printer), std::move(measurements), std::move(calibration),
                    options.bow_radius};
}

namespace {

constexpr double kDetected = 2.5;  // standard deviations

/// Of a number that a fit sought: as far from zero as chance takes it once in 80 times.
bool is_there(double value, double std) { return std > 0.0 && std::abs(value) > kDetected * std; }

double edge_std(const KnownPrinter& known) {
  return known.covariance.size() > 0 ? std::sqrt(known.covariance(3, 3)) : kBedBow;
}

/// The bed by a fit that seeks its bow, and no bias but one that is there. What a flat bed would have the distances
/// read wrong by, where the bow is not told from that.
BedFlatness bed_of(const DeltaGeometry& start, const DeltaReadings& readings, const ReadingTrial& trial) {
  BedFlatness bed = trial.bed;
  const auto fit = fit_printer(start, readings, {.seeks_bias = trial.bias_is_there, .bow_radius = bed.radius});
  if (!fit) return bed;
  const KnownPrinter known = known_printer(fit->printer, fit->calibration, bed.radius);
  bed.edge = known.bow.edge;
  bed.edge_std = edge_std(known);
  bed.is_bowed = is_there(bed.edge, bed.edge_std);
  if (!bed.is_bowed || bed.is_told || readings.distances.empty()) return bed;
  const auto flat = fit_printer(start, readings, {.seeks_bias = true});
  if (flat) bed.or_bias = flat->calibration.distance_bias.value_or(0.0);
  return bed;
}

}  // namespace

ReadingTrial try_readings(const DeltaGeometry& start, const DeltaReadings& readings, double radius) {
  ReadingTrial trial{.bed = {.radius = radius}};
  const auto both = fit_printer(
      start, readings, {.seeks_bias = !readings.distances.empty(), .bow_radius = radius, .print_radius = radius});
  if (!both) return trial;
  trial.known = known_printer(both->printer, both->calibration, radius);
  const Calibration& found = both->calibration;
  if (found.distance_bias && found.distance_bias_std) {
    trial.bias = *found.distance_bias;
    trial.bias_std = *found.distance_bias_std;
    trial.bias_can_be_told = trial.bias_std < 0.5 * kDistanceBias;
    trial.bias_is_there = trial.bias_can_be_told && is_there(trial.bias, trial.bias_std);
  }
  trial.bed.is_told = is_there(trial.known->bow.edge, edge_std(*trial.known));
  trial.bed = bed_of(start, readings, trial);
  return trial;
}

}  // namespace paracal::detail
