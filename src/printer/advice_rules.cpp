#include "advice_rules.hpp"

namespace paracal::detail {
namespace {

bool no_kind_worse(const PredictionErrors& errors, const PredictionErrors& than) {
  return errors.height <= than.height && errors.distance <= than.distance;
}

/// On no kind of readings more than a twentieth worse.
bool as_good_as_firmware(const PrinterCalibration& found) {
  constexpr double kAsGood = 1.05;
  const PredictionErrors theirs = found.by_firmware.held_out;
  return no_kind_worse(found.written.held_out, {kAsGood * theirs.height, kAsGood * theirs.distance});
}

}  // namespace

bool is_enough_of_heights(const PrinterCandidate& values, const PrinterCalibration& found) {
  constexpr double kMuch = 5.0 / 6.0;
  return !found.measurements.distances.empty() || values.gain.value >= kMuch;
}

bool better(const PrinterCandidate& values, const PrinterCalibration& found) {
  constexpr double kLikely = 0.8;
  if (scratches_bed(values)) return false;
  if (!found.tested() || values.some_kind_worse || !is_enough_of_heights(values, found)) return false;
  const double likely = found.measurements.distances.empty() || found.bed.is_bowed ? kCertain : kLikely;
  return (values.least_chance() >= kCertain && values.gain.value > 0.0) ||
         (values.least_chance() >= likely && values.gain.low > 0.0);
}

namespace {

/// Seven heights cannot test a fit of six numbers: there the whole calibration, which its priors hold, must predict
/// what it has not seen better than the saved values do.
bool better_of_few(const PrinterCalibration& found) {
  if (!found.tested() || scratches_bed(found.by_firmware)) return false;
  return found.by_firmware.least_chance() >= kCertain && found.written.gain.low > 0.0;
}

}  // namespace

PrinterAdvice advice_of(bool few, const PrinterCalibration& found) {
  if (few) return better_of_few(found) ? PrinterAdvice::take_firmware : PrinterAdvice::keep_saved;
  const bool ours =
      found.projection.ok() && found.calibration.verdict != Verdict::not_converged && better(found.written, found);
  const bool theirs = found.firmware.ok() && better(found.by_firmware, found);
  if (ours && as_good_as_firmware(found)) return PrinterAdvice::accept_new;
  return theirs ? PrinterAdvice::take_firmware : PrinterAdvice::keep_saved;
}

}  // namespace paracal::detail
