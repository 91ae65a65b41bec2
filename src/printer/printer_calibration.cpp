#include "paracal/printer/printer_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "advice.hpp"
#include "paracal/error.hpp"
#include "paracal/printer/plausibility.hpp"

namespace paracal {
namespace {

/// Radius of the place where heights were read, mm.
double covered_radius(const DeltaGeometry& geometry, const DeltaReadings& readings) {
  double radius = 0.0;
  for (const BedReading& reading : readings.heights) {
    if (const auto place = nozzle(geometry, reading.drops)) radius = std::max(radius, place->head<2>().norm());
  }
  return radius;
}

std::vector<std::string> all_implausible(const DeltaGeometry& saved, const DeltaReadings& readings,
                                         const DeltaFit& fit) {
  std::vector<std::string> wrong = implausible(saved);
  const std::vector<std::string> more = implausible(saved, readings, fit);
  wrong.insert(wrong.end(), more.begin(), more.end());
  return wrong;
}

/// What rests on a wrong file or on wrong readings corrects no program.
Calibration rejected(Calibration calibration, const std::vector<std::string>& wrong) {
  if (calibration.accepted()) calibration.verdict = Verdict::rejected;
  calibration.reasons.insert(calibration.reasons.begin(), wrong.begin(), wrong.end());
  calibration.use.reset();
  return calibration;
}

/// Where no machine closes: with what is likely to be wrong.
[[noreturn]] void refuse(const DeltaGeometry& saved, const DeltaReadings& readings) {
  const std::vector<std::string> wrong = all_implausible(saved, readings, fit_as_firmware(saved, readings));
  throw Unreachable(fmt::format("the geometry of the file cannot reach every reading: {}",
                                wrong.empty() ? "check that both are of the same printer" : wrong.front()));
}

/// One owner's readings, with what was found in them before they are judged.
class Owner {
 public:
  Owner(const DeltaGeometry& saved, const DeltaReadings& readings, const PrinterCalibrationOptions& options)
      : saved_(saved),
        read_(by_paper(readings, trigger_error(saved, readings))),
        options_(options),
        trigger_(trigger_error(saved, readings)),
        sign_(wrong_sign(saved, readings)) {}

  PrinterCalibration calibrate() {
    const Ladder first = ladder_of(saved_, read_);
    CommonShift shift = shift_of(first);
    if (!shift.is_stated) return judged(saved_, read_, first, shift);
    if (options_.accepts_shift && !sign_) {
      shift.is_accepted = true;
      const DeltaGeometry moved = with_bed_higher(saved_, shift.value);
      PrinterCalibration found = judged(moved, read_, ladder_of(moved, read_), shift);
      if (found.advice != PrinterAdvice::check_input) return found;
      shift.is_accepted = false;  // nothing is built on a wrong file
    }
    const DeltaReadings rest = without_shift(read_, shift.value);
    return judged(saved_, rest, ladder_of(saved_, rest), shift);
  }

 private:
  /// Over the bed, if the printer reaches all of it; else where it was read.
  Ladder ladder_of(const DeltaGeometry& saved, const DeltaReadings& readings) {
    const double covered = covered_radius(saved, readings);
    for (const double radius : {options_.print_radius, covered}) {
      if (!(radius > 0.0)) continue;
      print_radius_ = radius;
      const auto found =
          ladder(saved, readings, {.priors = options_.priors, .rules = options_.rules, .print_radius = radius});
      if (found) return *found;
    }
    refuse(saved, readings);
  }

  /// What all heights share, gross readings left out, unless steps of another size would explain it better than the
  /// shift does.
  CommonShift shift_of(const Ladder& first) const {
    const DeltaReadings good = without(read_, first.gross);
    CommonShift shift = common_shift(saved_, good, first.noise_height);
    shift.is_stated = shift.is_stated && !has_wrong_steps(saved_, good, without_shift(good, shift.value));
    shift.has_wrong_sign = sign_.has_value();
    return shift;
  }

  PrinterCalibration judged(const DeltaGeometry& saved, const DeltaReadings& readings, Ladder found,
                            const CommonShift& shift) const {
    const DeltaReadings good = without(readings, found.gross);
    const DeltaFit firmware = fit_as_firmware(saved, good);
    // Where few readings are left to check the fit, one that was excluded may be as good as the others.
    constexpr std::size_t kSpare = 3;
    const bool are_few =
        good.heights.size() + good.distances.size() < static_cast<std::size_t>(firmware.parameters) + kSpare;
    std::vector<std::string> wrong = are_few ? all_implausible(saved, readings, fit_as_firmware(saved, readings))
                                             : all_implausible(saved, good, firmware);
    if (sign_ && !shift.is_stated) wrong.insert(wrong.begin(), *sign_);  // the endstops follow the wrong sign
    const bool usable = firmware.ok() && implausible(firmware.geometry).empty();
    const DeltaGeometry& nominal = usable ? firmware.geometry : saved;
    auto programs =
        calibrate_for_programs(implausible(saved).empty() ? saved : nominal, nominal, readings, print_radius_);
    if (!programs) refuse(saved, readings);
    PrinterCalibration result{.saved = judge_as_firmware(saved, readings),
                              .firmware = fit_as_firmware(saved, readings),
                              .ladder = std::move(found),
                              .programs = std::move(*programs),
                              .shift = shift,
                              .trigger = trigger_,
                              .print_radius = print_radius_};
    detail::advise(good, wrong, result);
    if (!wrong.empty()) result.programs.calibration = rejected(std::move(result.programs.calibration), wrong);
    return result;
  }

  const DeltaGeometry& saved_;
  DeltaReadings read_;
  const PrinterCalibrationOptions& options_;
  TriggerError trigger_;
  std::optional<std::string> sign_;
  double print_radius_ = 0.0;
};

}  // namespace

PrinterCalibration calibrate_printer(const DeltaGeometry& saved, const DeltaReadings& readings,
                                     const PrinterCalibrationOptions& options) {
  require_places(saved, readings);
  if (readings.heights.empty()) throw InvalidArgument("printer: expected heights of the bed, got none");
  return Owner(saved, readings, options).calibrate();
}

}  // namespace paracal
