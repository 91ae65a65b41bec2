#include "paracal/io/json.hpp"
#include "paracal/printer/printer_calibration.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

Json geometry_json(const DeltaGeometry& geometry) {
  Json json{{"tower_angle_deg", json_array(geometry.tower_angle, to_degrees)},
            {"position_endstop_mm", geometry.endstop}};
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

Json candidate_json(const PrinterCandidate& one) {
  return {{"geometry", geometry_json(one.geometry)},
          {"gain", {{"value", one.gain.value}, {"low", one.gain.low}, {"high", one.gain.high}}},
          {"chance_better", one.chance_better},
          {"chance_above_bed", one.chance_above_bed},
          {"expected_shape_mm", one.expected_shape}};
}

Json size_json(const PrintSize& size) {
  return {{"bias_can_be_told", size.bias_can_be_told},
          {"bias_is_there", size.bias_is_there},
          {"bias_mm", size.bias},
          {"bias_std_mm", size.bias_std},
          {"open_share", size.open}};
}

Json bed_json(const BedFlatness& bed) {
  return {{"is_bowed", bed.is_bowed},    {"is_told", bed.is_told},  {"edge_mm", bed.edge},
          {"edge_std_mm", bed.edge_std}, {"radius_mm", bed.radius}, {"or_bias_mm", bed.or_bias}};
}

Json shift_json(const CommonShift& shift) {
  return {{"is_stated", shift.is_stated},
          {"is_accepted", shift.is_accepted},
          {"likely_causes", shift.likely_causes()},
          {"position_endstop_mm", shift.endstop}};
}

}  // namespace

Json to_json(const PrinterCalibration& found) {
  const auto held_out = [&](const PredictionErrors& errors) { return found.tested() ? errors_json(errors) : Json(); };
  return {{"advice", name(found.advice)},
          {"findings", found.findings},
          {"saved", fit_json(found.saved)},
          {"firmware", fit_json(found.firmware)},
          {"new", geometry_json(found.projection.geometry)},
          {"accuracy_saved", accuracy_json(found.accuracy_before)},
          {"accuracy_new", accuracy_json(found.projection.accuracy)},
          {"left_out", held_out(found.written.held_out)},
          {"left_out_firmware", held_out(found.by_firmware.held_out)},
          {"left_out_saved", held_out(found.held_out)},
          {"groups", found.groups},
          {"judged_new", candidate_json(found.written)},
          {"judged_firmware", candidate_json(found.by_firmware)},
          {"expected_shape_saved_mm", found.expected_shape},
          {"size", size_json(found.size)},
          {"bed", bed_json(found.bed)},
          {"common_shift_mm", found.shift.value},
          {"common_shift", shift_json(found.shift)},
          {"uncheckable", found.uncheckable}};
}

}  // namespace paracal::io
