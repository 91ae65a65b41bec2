#include "paracal/io/json.hpp"

#include "io/robots/limb_tables.hpp"
#include "io/robots/robot_tables.hpp"
#include "io/tables/names.hpp"
#include "paracal/tolerance/drawing_statement.hpp"

namespace paracal::io {

Json rows_json(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  return json_array(matrix.rowwise(), [](const auto& row) { return json_array(row); });
}

Json values_json(const std::vector<KeyValues>& values) {
  Json json = Json::object();
  for (const auto& [key, numbers] : values) {
    json[key] = numbers.size() == 1 ? Json(numbers.front()) : json_array(numbers);
  }
  return json;
}

Json to_json(const Tolerances& tolerances, const Limbs& limbs) {
  Json json;
  const std::vector<Source> listed = listed_tolerances(tolerances, limbs);
  for (const Source source : listed) {
    json[file_key(source, actuator_of(limbs))] =
        tidy(to_file_unit(unit(source, actuator_of(limbs)), tolerances[source]));
  }
  if (listed.size() < leading_sources(limbs).size()) json["others"] = "exact";
  const std::vector<std::string> generous = generous_keys(tolerances, limbs);
  if (!generous.empty()) json["generous"] = generous;
  json["distribution"] = distribution_name(tolerances.distribution);
  for (const Source source : leading_sources(limbs)) {
    for (const double value : tolerances.measured[source]) {
      json["measured"][file_key(source, actuator_of(limbs))].push_back(
          tidy(to_file_unit(unit(source, actuator_of(limbs)), value)));
    }
  }
  return json;
}

Json drawing_json(const Tolerances& tolerances, const Robot& robot) {
  Json json = Json::object();
  for (const Source source : listed_tolerances(tolerances, robot.limbs())) {
    const std::optional<DrawingStatement> said = on_a_drawing(tolerances, source, robot);
    if (!said) continue;
    json[file_key(source, robot.actuator())] = {{"statement", said->statement.empty() ? Json() : Json(said->statement)},
                                                {"grade", said->grade ? Json(name(*said->grade)) : Json()},
                                                {"text", said->text}};
  }
  return json;
}

Json to_json(const Robot& robot) {
  const std::optional<SharedDimensions> shared = shared_dimensions(robot.limbs());
  Json json{{"name", robot.name()}};
  if (shared) {
    json["geometry"] = {{"base_radius_mm", shared->base_radius},
                        {"plate_radius_mm", shared->plate_radius},
                        {"arm_mm", shared->arm},
                        {"rod_mm", shared->rod},
                        {"parallelogram_width_mm", shared->parallelogram_width},
                        {"limb_azimuth_deg", json_array(shared->limb_azimuth, tidy_degrees)},
                        {"actuator", actuator_name(shared->actuator)}};
    add_pitch(shared->actuator, shared->pitch, json["geometry"]);
  } else {
    if (!robot.freedoms().are_all()) json["plate"] = {{"freedoms", freedoms_json(robot.freedoms())}};
    json["limb"] = limbs_json(robot.limbs());
  }
  if (const std::optional<Slide>& slide = robot.slide()) {
    json["plate"] = {{"slide_axis", json_array(slide->axis)},
                     {"slide_sign", json_array(slide->sign)},
                     {"pinion_radius_mm", slide->pinion_radius}};
  }
  json["workspace"] = values_json(workspace_values(robot.workspace()));
  if (!robot.controller_origin().isZero(0.0)) {
    json["controller"] = {{"origin_mm", json_array(robot.controller_origin())}};
  }
  if (const auto& limits = robot.joint_limits()) {
    for (const auto& [key, value] : joint_limits_in_file(*limits, robot.actuator())) json["joints"][key] = value;
  }
  for (const auto& limb : differences(robot)) json["limb"].push_back(values_json(limb));
  if (robot.tolerances()) json["tolerances"] = to_json(*robot.tolerances(), robot.limbs());
  return json;
}

}  // namespace paracal::io
