#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "io/tables/names.hpp"
#include "paracal/io/json.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

namespace paracal::io {
namespace {

Json limb_json(const ClosureLimb<double>& limb) {
  constexpr std::array kDrives{"arm", "rail", "strut"};
  const bool in_mm = closure::moves_in_mm(limb);
  const Unit unit = in_mm ? Unit::mm : Unit::rad;
  Json json{{"drive", kDrives.at(static_cast<std::size_t>(closure::drive_of(limb)))},
            {"rods", closure::rod_count(limb)},
            {"base_mm", limb.base},
            {"radial", limb.radial},
            {"normal", limb.normal},
            {"axis", limb.axis},
            {"plate_mm", limb.plate},
            {"slide_mm_per_deg", json_array(limb.slide, to_radians)},
            {"elbow_half_mm", limb.elbow_half},
            {"plate_half_mm", limb.plate_half},
            {"rod_mm", limb.rod},
            {"arm_mm", limb.arm},
            {"on_rail", closure::drive_of(limb) == Drive::rail},
            {"ahead", limb.ahead > 0.0},
            {fmt::format("joint_offset_{}", file_unit(unit)), to_file_unit(unit, limb.joint_offset)}};
  if (in_mm) json["joint_per_mm"] = limb.joint_per_mm;
  return json;
}

Json drive_json(const DriveCurve<double>& drive, Unit unit) {
  const auto in_unit = [&](double number) { return to_file_unit(unit, number); };
  Json json{{fmt::format("first_{}", file_unit(unit)), in_unit(drive.first)},
            {fmt::format("spacing_{}", file_unit(unit)), in_unit(drive.spacing)},
            {fmt::format("sizes_{}", file_unit(unit)), json_array(drive.sizes, in_unit)}};
  if (drive.turn.is_even()) return json;
  json[fmt::format("pitch_{}", file_unit(unit))] = in_unit(2.0 * std::numbers::pi / drive.turn.turning);
  json[fmt::format("turn_sine_{}", file_unit(unit))] = in_unit(drive.turn.sine);
  json[fmt::format("turn_cosine_{}", file_unit(unit))] = in_unit(drive.turn.cosine);
  return json;
}

/// Of each limb, where one is uneven.
void add_drives(const CompensatorParameters<double>& parameters, Json& json) {
  if (std::ranges::all_of(parameters.drives, [](const auto& one) { return one.is_even(); })) return;
  for (std::size_t i = 0; i < parameters.limb_count; ++i) {
    const Unit unit = closure::moves_in_mm(parameters.nominal.at(i)) ? Unit::mm : Unit::rad;
    json["drives"].push_back(drive_json(parameters.drives.at(i), unit));
  }
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
  const auto of_limbs = [&](const auto& values) { return std::span(values).first(parameters.limb_count); };
  Json json{{"tilts_plate", parameters.tilts_plate != 0},
            {"identified", json_array(of_limbs(parameters.identified), limb_json)},
            {"nominal", json_array(of_limbs(parameters.nominal), limb_json)}};
  add_drives(parameters, json);
  if (parameters.is_level == 0) return json;
  json["position_errors_mm"] = json_array(of_limbs(parameters.position_errors));
  json["tilt_errors_rad"] = json_array(of_limbs(parameters.tilt_errors));
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

Json to_json(const SelfTestCase& wanted, Actuator actuator, bool tilts) {
  const Unit unit = joint_unit(actuator);
  const auto in_unit = [&](double joint) { return to_file_unit(unit, joint); };
  return {{"pose", to_json(wanted.pose, tilts)},
          {fmt::format("joints_{}", file_unit(unit)), json_array(wanted.joints, in_unit)}};
}

}  // namespace paracal::io
