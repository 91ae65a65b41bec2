#include <fmt/format.h>

#include "io/tables/names.hpp"
#include "paracal/io/json.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

namespace paracal::io {
namespace {

Json limb_json(const CompensatorLimb<double>& limb) {
  const bool on_rail = limb.on_rail != 0.0;
  const Unit unit = joint_unit(on_rail ? Actuator::linear : Actuator::revolute);
  Json slide = Json::array();
  for (const double mm_per_rad : limb.slide) slide.push_back(to_radians(mm_per_rad));
  Json json{{"base_mm", limb.base},
            {"radial", limb.radial},
            {"normal", limb.normal},
            {"axis", limb.axis},
            {"plate_mm", limb.plate},
            {"slide_mm_per_deg", slide},
            {"elbow_half_mm", limb.elbow_half},
            {"plate_half_mm", limb.plate_half},
            {"rod_mm", limb.rod},
            {"arm_mm", limb.arm},
            {"on_rail", on_rail},
            {fmt::format("joint_offset_{}", file_unit(unit)), to_file_unit(unit, limb.joint_offset)}};
  if (on_rail) json["joint_per_mm"] = limb.joint_per_mm;
  return json;
}

}  // namespace

Json to_json(const Robot& robot, const ExportOrigin& origin) {
  return {{"program", fmt::format("paracal {}", version())},
          {"robot", robot.name()},
          {"calibration", origin.calibration},
          {"calibration_sha256", origin.sha256},
          {"date", origin.date}};
}

Json to_json(const CompensatorParameters<double>& parameters) {
  Json json{{"tilts_plate", parameters.tilts_plate != 0},
            {"identified", Json::array()},
            {"nominal", Json::array()},
            {"position_errors_mm", Json::array()},
            {"tilt_errors_rad", Json::array()}};
  for (std::size_t i = 0; i < parameters.limb_count; ++i) {
    json["identified"].push_back(limb_json(parameters.identified[i]));
    json["nominal"].push_back(limb_json(parameters.nominal[i]));
    json["position_errors_mm"].push_back(parameters.position_errors[i]);
    json["tilt_errors_rad"].push_back(parameters.tilt_errors[i]);
  }
  return json;
}

Json to_json(const Pose& pose, bool tilts) {
  Json json{{"x_mm", pose.position.x()},
            {"y_mm", pose.position.y()},
            {"z_mm", pose.position.z()},
            {"phi_deg", to_degrees(pose.rotation)}};
  if (!tilts) return json;
  json["tilt_x_deg"] = to_degrees(pose.tilt.x());
  json["tilt_y_deg"] = to_degrees(pose.tilt.y());
  json["tilt_z_deg"] = to_degrees(pose.tilt.z());
  return json;
}

Json to_json(const SelfTestCase& wanted, Actuator actuator) {
  const Unit unit = joint_unit(actuator);
  Json joints = Json::array();
  for (const double joint : wanted.joints) joints.push_back(to_file_unit(unit, joint));
  return {{"pose", to_json(wanted.pose)}, {fmt::format("joints_{}", file_unit(unit)), joints}};
}

}  // namespace paracal::io
