#include "paracal/io/json.hpp"
#include "paracal/printer/printer_calibration.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

Json geometry_json(const DeltaGeometry& geometry) {
  Json angles = Json::array();
  for (const double angle : geometry.tower_angle) angles.push_back(to_degrees(angle));
  Json json{{"tower_angle_deg", angles}, {"position_endstop_mm", geometry.endstop}};
  if (geometry.actuator == Actuator::linear) {
    json["delta_radius_mm"] = geometry.radius;
    json["arm_length_mm"] = geometry.rod;  // the firmware's word for rods
    return json;
  }
  json["shoulder_radius_mm"] = geometry.radius;
  json["shoulder_height_mm"] = geometry.shoulder;
  json["upper_arm_length_mm"] = geometry.arm;
  json["lower_arm_length_mm"] = geometry.rod;
  return json;
}

Json accuracy_json(const DeltaAccuracy& accuracy) {
  return {{"absolute_rms_mm", accuracy.absolute_rms},
          {"absolute_max_mm", accuracy.absolute_max},
          {"shape_rms_mm", accuracy.shape_rms},
          {"shape_max_mm", accuracy.shape_max}};
}

Json fit_json(const DeltaFit& fit) {
  return {{"cost_mm2", fit.cost},
          {"rms_height_mm", fit.rms_height},
          {"rms_distance_mm", fit.rms_distance},
          {"parameters", fit.parameters},
          {"geometry", geometry_json(fit.geometry)}};
}

Json errors_json(const PredictionErrors& errors) {
  return {{"height_mm", errors.height}, {"distance_mm", errors.distance}};
}

const char* name(PrinterAdvice advice) {
  switch (advice) {
    case PrinterAdvice::accept_new:
      return "accept_new";
    case PrinterAdvice::take_firmware:
      return "take_firmware";
    case PrinterAdvice::keep_saved:
      break;
  }
  return "keep_saved";
}

}  // namespace

Json to_json(const PrinterCalibration& found) {
  return {{"advice", name(found.advice)},
          {"findings", found.findings},
          {"saved", fit_json(found.saved)},
          {"firmware", fit_json(found.firmware)},
          {"new", geometry_json(found.projection.geometry)},
          {"accuracy_saved", accuracy_json(found.accuracy_before)},
          {"accuracy_new", accuracy_json(found.projection.accuracy)},
          {"left_out", found.tested() ? errors_json(found.predicted) : Json()},
          {"left_out_firmware", found.tested() ? errors_json(found.by_firmware) : Json()}};
}

}  // namespace paracal::io
