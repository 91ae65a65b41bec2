#include "io/tables/names.hpp"
#include "json_parts.hpp"
#include "paracal/io/json.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

Json common_json(const CommonError& error) { return {{"text", error.text}, {"std_mm", error.std}}; }

Json selectors_json(const std::vector<SourceSelector>& selectors) {
  return json_array(selectors, [](const SourceSelector& one) {
    return std::string(name(one.source)) + (one.limb ? std::to_string(*one.limb + 1) : "");
  });
}

}  // namespace

Json to_json(const TrackerModel& tracker) {
  return {{"transverse_mm", tracker.transverse},
          {"transverse_mm_per_m", tracker.transverse_per_m},
          {"radial_mm", tracker.radial},
          {"radial_mm_per_m", tracker.radial_per_m}};
}

Json to_json(const CalibrationOptions& options, const Geometry& geometry) {
  Json json{{"method", options.method == Method::paper ? "paper" : "best"},
            {"stage", options.stage == Stage::rough  ? "rough"
                      : options.stage == Stage::fine ? "fine"
                                                     : "auto"},
            {"frame", options.frame == Frame::unknown ? "unknown" : "robot"},
            {"body", options.body == BodyPlace::unknown ? "unknown" : "plate"},
            {"rotation", options.rotation_zero == RotationZero::unknown ? "relative" : "absolute"},
            {"reflectors", name(options.reflectors)},
            {"distance_sigma_mm", options.noise.distance},
            {"point_sigma_mm", options.noise.point},
            {"body_sigma_mm", options.noise.body},
            {"rotation_sigma_deg", tidy_degrees(options.noise.rotation)},
            {"height_sigma_mm", options.noise.height},
            {"distance_bias_sigma_mm", options.noise.distance_bias},
            {"dial_angle_sigma_deg", optional_degrees(options.noise.dial_angle)},
            {"plane_slope_sigma_rad", optional(options.plane_slope)},
            {"plane_curvature_sigma_per_mm", optional(options.plane_curvature)},
            {"common", json_array(options.common, common_json)},
            {"noise_is_known", options.noise_is_known},
            {"fixed", selectors_json(options.fixed)},
            {"free", selectors_json(options.free)},
            {"exclude_outliers", options.exclude_outliers},
            {"scale_sigma_ppm", 1e6 * options.scale_std},
            {"limit_distance_mm", optional(options.limits.distance)},
            {"limit_aligned_mm", optional(options.limits.volumetric)},
            {"limit_rotation_deg", optional_degrees(options.limits.rotation)},
            {"outlier_chance", options.outlier_chance},
            {"largest_chance", options.largest_chance}};
  if (options.noise.joint > 0.0) {
    const Unit joint = joint_unit(geometry.actuator);
    json["joint_sigma"] = tidy(to_file_unit(joint, options.noise.joint));
  }
  if (options.noise.tracker) json["tracker"] = to_json(*options.noise.tracker);
  if (options.tolerances) json["tolerances"] = to_json(*options.tolerances, geometry);
  return json;
}

}  // namespace paracal::io
