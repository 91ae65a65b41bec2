#include "printer_fit.hpp"

#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/printer/plausibility.hpp"

namespace paracal::detail {

DeltaProjection PrinterFit::written() const {
  const KnownPrinter known{printer, calibration.errors(), found_bed(calibration)};
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
  Calibration calibration = calibrate(printer.robot, measurements, how);
  if (calibration.set_ups.empty()) return std::nullopt;
  return PrinterFit{firmware, nominal, std::move(printer), std::move(measurements), std::move(calibration)};
}

BiasTrial try_bias(const DeltaGeometry& start, const DeltaReadings& readings) {
  constexpr double kCertain = 2.5;
  if (readings.distances.empty()) return {};
  const auto fit = fit_printer(start, readings, {.seeks_bias = true});
  if (!fit || !fit->calibration.distance_bias || !fit->calibration.distance_bias_std) return {};
  BiasTrial trial{.value = *fit->calibration.distance_bias, .std = *fit->calibration.distance_bias_std};
  trial.can_be_told = trial.std < 0.5 * kDistanceBias;
  trial.is_there = trial.can_be_told && std::abs(trial.value) > kCertain * trial.std;
  return trial;
}

KnownPrinter known_printer(const PrinterFit& fit, const DeltaReadings& readings, double bias_std) {
  KnownPrinter known = known_printer(fit.printer, fit.calibration);
  const bool sought = fit.calibration.options.noise.distance_bias > 0.0;
  if (readings.distances.empty() || sought || known.covariance.size() == 0) return known;
  // What one standard deviation of the bias does to the answer: the same fit of shorter distances.
  DeltaReadings shorter = readings;
  for (PrintedDistance& one : shorter.distances) one.distance -= bias_std;
  CalibrationOptions options = fit.calibration.options;
  options.states_use = false;
  const Calibration moved =
      calibrate(fit.printer.robot, printer_measurements(fit.printer, fit.nominal, shorter), options);
  if (moved.set_ups.empty()) return known;
  const KnownPrinter other = known_printer(fit.printer, moved);
  Eigen::VectorXd change(known.covariance.rows());
  change.head<3>() << other.bed.height - known.bed.height, other.bed.slope_x - known.bed.slope_x,
      other.bed.slope_y - known.bed.slope_y;
  for (std::size_t k = 0; k < known.parameters.size(); ++k) {
    const SoughtSource& one = known.parameters[k];
    change(3 + static_cast<Eigen::Index>(k)) = other.errors(one.limb, one.source) - known.errors(one.limb, one.source);
  }
  known.covariance += change * change.transpose();
  return known;
}

}  // namespace paracal::detail
