#include "options.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>

#include "paracal/calibration/source_selection.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/units.hpp"

namespace paracal::python {

double checked(const char* name, double number, const plausible::Range& range) {
  if (range.contains(number)) return number;
  throw InvalidArgument(fmt::format("{}: expected {:g} to {:g}, got {:g}", name, range.least, range.most, number));
}

std::uint64_t checked(const char* name, std::int64_t number, const option_limits::Whole& range) {
  const auto whole = static_cast<std::uint64_t>(number);
  if (number >= 0 && whole >= range.least && whole <= range.most) return whole;
  throw InvalidArgument(fmt::format("{}: expected {} to {}, got {}", name, range.least, range.most, number));
}

namespace {

TrackerModel tracker_of(const Keywords& given) {
  const auto um = given.get<std::array<double, 4>>("tracker_um", "four numbers");
  const TrackerModel tracker{um[0] * 1e-3, um[1] * 1e-3, um[2] * 1e-3, um[3] * 1e-3};
  const auto believable = [](double at_one_metre) { return plausible::kNoise.contains(at_one_metre); };
  const bool positive = std::ranges::all_of(um, [](double one) { return one >= 0.0; });
  if (positive && believable(tracker.transverse + tracker.transverse_per_m) &&
      believable(tracker.radial + tracker.radial_per_m)) {
    return tracker;
  }
  throw InvalidArgument(fmt::format("tracker_um: expected four numbers of at least 0 that give {:g} to {:g} mm at 1 m",
                                    plausible::kNoise.least, plausible::kNoise.most));
}

void take_limits(const Keywords& given, AcceptanceLimits& limits) {
  given.take_number("limit_mm", plausible::kLimit, limits.distance);
  given.take_number("limit_aligned_mm", plausible::kLimit, limits.volumetric);
  given.take_number("limit_rad", plausible::kLimitRad, limits.rotation);
}

void take_mount(const Keywords& given, ReflectorMount& mount) {
  given.choose("reflectors",
               {{name(ReflectorMount::plate), ReflectorMount::plate},
                {name(ReflectorMount::end_effector), ReflectorMount::end_effector},
                {name(ReflectorMount::end_effector_reversed), ReflectorMount::end_effector_reversed}},
               mount);
}

/// What calibration and validation have in common.
template <typename Options>
void take_common(const Keywords& given, Options& options) {
  options.noise = noise_of(given);
  given.take("sigma_known", "True or False", options.noise_is_known);
  given.choose("frame", {{"unknown", Frame::unknown}, {"robot", Frame::robot}}, options.frame);
  given.choose("body", {{"unknown", BodyPlace::unknown}, {"plate", BodyPlace::plate}}, options.body);
  given.choose("rotation", {{"relative", RotationZero::unknown}, {"absolute", RotationZero::known}},
               options.rotation_zero);
  take_mount(given, options.reflectors);
  given.take_number("scale_ppm", option_limits::kScalePpm, options.scale_std, 1e-6);
  take_limits(given, options.limits);
}

}  // namespace

NoiseModel noise_of(const Keywords& given) {
  const plausible::Range dial_angle{0.0, to_radians(option_limits::kDialAngleDeg.most), "rad"};
  NoiseModel noise;
  given.take_number("sigma_mm", plausible::kNoise, noise.distance);
  given.take_number("sigma_mm", plausible::kNoise, noise.point);
  given.take_number("sigma_mm", plausible::kNoise, noise.body);
  given.take_number("height_sigma_mm", plausible::kNoise, noise.height);
  given.take_number("sigma_rad", plausible::kNoise, noise.rotation);
  given.take_number("distance_bias_mm", option_limits::kStd, noise.distance_bias);
  given.take_number("dial_angle_rad", dial_angle, noise.dial_angle);
  given.take_number("joint_sigma", option_limits::kStd, noise.joint);
  if (given.has("tracker_um")) noise.tracker = tracker_of(given);
  return noise;
}

CalibrationOptions calibration_options(const Robot& robot, const Keywords& given) {
  CalibrationOptions options;
  take_common(given, options);
  given.choose("method", {{"best", Method::best}, {"paper", Method::paper}}, options.method);
  given.choose("stage", {{"auto", Stage::automatic}, {"rough", Stage::rough}, {"fine", Stage::fine}}, options.stage);
  if (given.has("tolerances")) options.tolerances = given.get<Tolerances>("tolerances", "Tolerances");
  const auto selected = [&](const char* key) {
    return given.has(key) ? source_selectors(given.get<std::vector<std::string>>(key, "names of source errors"),
                                             robot.joint_space())
                          : std::vector<SourceSelector>();
  };
  options.fixed = selected("fixed");
  options.free = selected("free");
  check_selection(options, robot.joint_space());
  bool keeps_outliers = false;
  given.take("keep_outliers", "True or False", keeps_outliers);
  options.exclude_outliers = !keeps_outliers;
  return options;
}

ValidationOptions validation_options(const Keywords& given) {
  ValidationOptions options;
  take_common(given, options);
  options.rotation_noise_is_known = given.has("sigma_rad");
  return options;
}

PlannedReadings planned_readings(const Keywords& given) {
  PlannedReadings readings;
  const auto wanted = given.has("measure") ? given.get<std::string>("measure", "a text") : "coordinates";
  const auto kind = std::ranges::find(length_kinds(), wanted, &LengthWords::name);
  if (kind != length_kinds().end()) {
    readings.measurand = Measurand::lengths;
    readings.length = kind->kind;
  } else {
    given.choose("measure",
                 {{"coordinates", Measurand::coordinates},
                  {"pose", Measurand::poses},
                  {"distance", Measurand::distances},
                  {"home-distance", Measurand::home_distances},
                  {words(LengthKind::height).name, Measurand::lengths},
                  {words(LengthKind::ball_bar).name, Measurand::lengths},
                  {words(LengthKind::dial).name, Measurand::lengths}},
                 readings.measurand);
  }
  given.take("read_rotation", "True or False", readings.rotation);
  given.take("second", "True or False", readings.second);
  take_mount(given, readings.mount);
  if (given.has("at")) {
    const auto at = given.get<std::array<double, 3>>("at", "x, y, z in mm");
    readings.at = Eigen::Vector3d(at[0], at[1], at[2]);
  }
  return readings;
}

}  // namespace paracal::python
