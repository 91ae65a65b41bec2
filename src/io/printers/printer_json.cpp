#include <algorithm>
#include <string>

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

Json fit_json(const DeltaFit& fit) {
  return {{"cost_mm2", fit.cost},
          {"rms_height_mm", fit.rms_height},
          {"rms_distance_mm", fit.rms_distance},
          {"parameters", fit.parameters},
          {"geometry", geometry_json(fit.geometry)}};
}

Json figure_json(const LadderFigure& figure, double scale) {
  return {{"value", scale * figure.value}, {"low", scale * figure.low}, {"high", scale * figure.high}};
}

Json rung_json(const RungValues& one) {
  constexpr double kPercent = 100.0;
  return {{"rung", name(one.rung)},
          {"geometry", geometry_json(one.geometry)},
          {"first_layer_mm", figure_json(one.first_layer, 1.0)},
          {"size_percent", figure_json(one.size, kPercent)},
          {"chance_better", one.chance},
          {"chance_size_worse", one.chance_size},
          {"depth_mm", one.depth},
          {"holds_radius", one.holds_radius},
          {"is_allowed", one.is_allowed}};
}

Json shift_json(const CommonShift& shift) {
  return {{"is_stated", shift.is_stated},
          {"is_accepted", shift.is_accepted},
          {"likely_causes", shift.likely_causes()},
          {"position_endstop_mm", shift.endstop}};
}

/// "height3", "distance0": as in a printer.cfg.
Json names_of(const ReadingNumbers& numbers) {
  Json names = Json::array();
  for (const std::size_t k : numbers.heights) names.push_back("height" + std::to_string(k));
  for (const std::size_t k : numbers.distances) names.push_back("distance" + std::to_string(k));
  return names;
}

/// The nozzle above the bed over the printable disk, with the saved and with the advised values.
Json bed_json(const PrinterCalibration& found) {
  Json points = Json::array();
  const std::vector<Eigen::Vector3d> places = printable_disk(found.print_radius);
  const bool is_new = found.advice == PrinterAdvice::accept_new;
  const RungValues &before = found.ladder.saved(), &after = is_new ? found.ladder.best() : before;
  for (std::size_t k = 0; k < std::min(before.heights.size(), after.heights.size()); ++k) {
    points.push_back({{"x_mm", places[k].x()},
                      {"y_mm", places[k].y()},
                      {"saved_mm", before.heights[k]},
                      {"new_mm", after.heights[k]}});
  }
  return points;
}

}  // namespace

Json to_json(const PrinterCalibration& found) {
  Json rungs = Json::array();
  for (const RungValues& one : found.ladder.rungs) rungs.push_back(rung_json(one));
  const bool is_new = found.advice == PrinterAdvice::accept_new;
  return {{"advice", name(found.advice)},
          {"rung", name(is_new ? found.ladder.best().rung : Rung::saved)},
          {"findings", found.findings},
          {"details", found.details},
          {"ladder", rungs},
          {"saved", fit_json(found.saved)},
          {"firmware", fit_json(found.firmware)},
          {"new", geometry_json(found.advised())},
          {"bed", bed_json(found)},
          {"print_radius_mm", found.print_radius},
          {"noise_mm", {{"height", found.ladder.noise_height}, {"distance", found.ladder.noise_distance}}},
          {"excluded", names_of(found.ladder.gross)},
          {"uncheckable", names_of(found.ladder.unchecked)},
          {"common_shift_mm", found.shift.value},
          {"common_shift", shift_json(found.shift)}};
}

}  // namespace paracal::io
