#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "calibration/fit/as_given.hpp"
#include "paracal/calibration/diagnosis.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/error.hpp"

namespace paracal {
namespace {

/// Standard deviation that was expected of the readings that Calibration::noise is about, mm.
double expected_noise(const Measurements& measurements, const NoiseModel& noise) {
  if (std::ranges::any_of(measurements.series, &PointSeries::is_of_body)) return noise.body;
  if (!measurements.series.empty()) return noise.point;
  return measurements.distances.empty() ? noise.height : noise.distance;
}

/// Readings scatter far more than they should, or nobody can tell whether they do.
bool scatters(const Calibration& calibration, const Measurements& measurements) {
  constexpr double kFarMore = 2.0;
  if (!calibration.unit_weight_std) return true;
  const bool known = calibration.fit_probability.has_value();
  if (calibration.orientation_noise > kFarMore * calibration.options.noise.rotation) return true;
  return known ? *calibration.unit_weight_std > kFarMore
               : calibration.noise > kFarMore * expected_noise(measurements, calibration.options.noise);
}

/// One reading in ten.
bool left_many_out(const Calibration& calibration) {
  return 10 * static_cast<std::size_t>(std::ranges::count(calibration.suspects, true, &Suspect::excluded)) >
         calibration.readings;
}

/// Of the machine with its drives where it has them: what a rigid one makes of uneven drives is no error of a part.
bool is_far_from_nominal(const ParameterEstimate& parameter, double far) {
  const double value = parameter.with_drives.value_or(parameter.value);
  return parameter.prior_std && std::abs(value - parameter.expected) > far * *parameter.prior_std;
}

/// The machine with its drives predicts poses that were omitted, about as well as the noise allows: what moves its
/// joints is known, and no reading is another than it says.
bool predicts_omitted_poses(const Calibration& calibration) {
  constexpr double kFarMore = 2.0;
  return calibration.drive_sizes.size() > 0 && calibration.omitted_poses &&
         calibration.omitted_poses->with_drives <= kFarMore * calibration.noise;
}

bool has_told(const Calibration& calibration, Cause cause) {
  return std::ranges::any_of(calibration.components,
                             [&](const Component& one) { return one.told && one.cause == cause; });
}

/// Readings show something that noise, tolerances and model do not explain; the fit takes it for a fault of the
/// machine. Visits that do not repeat are none of what was written wrong, and what else was is known and counted.
bool is_strange(const Calibration& calibration) {
  return has_told(calibration, Cause::parts) ||
         (has_told(calibration, Cause::motion) && !predicts_omitted_poses(calibration));
}

bool is_doubtful(const Calibration& calibration, const Measurements& measurements) {
  return calibration.verdict == Verdict::not_converged || scatters(calibration, measurements) ||
         left_many_out(calibration) || is_strange(calibration) ||
         std::ranges::any_of(calibration.parameters, [&](const ParameterEstimate& one) {
           return is_far_from_nominal(one, calibration.options.causes.error);
         });
}

/// The machine that was found explains what the readings show, if with parts out of their tolerances.
bool is_explained(const Calibration& calibration, const Diagnosis& diagnosis) {
  const bool moves = has_told(calibration, Cause::motion) && !predicts_omitted_poses(calibration);
  return calibration.accepted() && !moves && calibration.noise <= diagnosis.largest_noise;
}

/// What the fit found suspicious in readings and parts was the mistake's doing: only what the import noted remains.
/// Parameters and U stay, rejected: they say how far off such readings are.
Calibration doubted(Calibration calibration, const Diagnosis& diagnosis, const Measurements& measurements) {
  if (diagnosis.causes.empty() && is_explained(calibration, diagnosis)) return calibration;
  if (calibration.accepted()) calibration.verdict = Verdict::rejected;
  if (diagnosis.causes.empty()) {
    calibration.reasons.push_back(diagnosis.text);
    return calibration;
  }
  calibration.reasons.insert(calibration.reasons.begin(), diagnosis.text);
  calibration.notes = measurements.notes;
  calibration.components.clear();
  calibration.suspects.clear();
  return calibration;
}

/// The place of a reflector that the fit had to seek is no mistake any more.
CalibrationOptions with_found_reflector(CalibrationOptions options, const CalibrationOptions& of_fit) {
  options.reflector_is_at_centre = of_fit.reflector_is_at_centre;
  options.reflectors = of_fit.reflectors;
  return options;
}

/// @throws InvalidArgument where no joints can disagree, or some are not stated.
void check_joint_readings(const Robot& robot, const std::vector<Station>& stations) {
  if (robot.nominal().gap_count() == 0) {
    throw InvalidArgument(fmt::format(
        "joint sigma: expected a robot with more limbs than degrees of freedom and one rod on each, got {}: "
        "its joints agree with every dimension",
        robot.name()));
  }
  for (const Station& station : stations) {
    if (station.believed) continue;
    throw InvalidArgument(named(station) + ": joint sigma: expected the joints at every pose, got none here");
  }
}

}  // namespace

Calibration calibrate(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options) {
  if (options.noise.joint > 0.0) check_joint_readings(robot, measurements.stations);
  if (!options.diagnose || options.expected) return detail::calibrate_as_given(robot, measurements, options);
  try {
    Calibration calibration = detail::calibrate_as_given(robot, measurements, options);
    if (!is_doubtful(calibration, measurements)) return calibration;
    const auto diagnosis = diagnose(robot, measurements, with_found_reflector(options, calibration.options));
    return diagnosis ? doubted(std::move(calibration), *diagnosis, measurements) : calibration;
  } catch (const Unreachable& complaint) {
    const auto diagnosis = diagnose(robot, measurements, options);
    if (!diagnosis || diagnosis->causes.empty()) throw;
    throw Unreachable(fmt::format("{}; {}", complaint.what(), diagnosis->text));
  }
}

}  // namespace paracal
