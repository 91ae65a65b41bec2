#include "support/robots.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "paracal/kinematics/error_model.hpp"
#include "paracal/units.hpp"
#include "support/places.hpp"

namespace paracal::test {

namespace {

RobotDescription unlike_limbs() {
  RobotDescription robot = catalogue::rotary_delta().description();
  robot.name = "unlike_limbs";
  robot.workspace = {.radius = 400.0, .height = 250.0, .top_z = -800.0};
  redimension(robot, [](SharedDimensions& shared) {
    for (std::size_t limb = 0; limb < 3; ++limb) {
      const double k = static_cast<double>(limb) - 1.0;
      shared.differences(limb, "arm_length") = 20.0 * k;
      shared.differences(limb, "rod_mean") = -35.0 * k + 5.0;
      shared.differences(limb, "e_x") = 4.0 * k;
      shared.differences(limb, "e_z") = 30.0 * k;
      shared.differences(limb, "theta_offset") = to_radians(10.0 * k);
      shared.differences(limb, "alpha0") = to_radians(6.0 * k);
    }
  });
  robot.controller_origin = {3.0, -2.0, -1100.0};
  robot.joint_limits = {to_radians(200.0), to_radians(4000.0)};
  return robot;
}

RobotDescription inclined_rails() {
  RobotDescription robot = catalogue::linear_delta().description();
  robot.name = "inclined_rails";
  redimension(robot, [](SharedDimensions& shared) {
    shared.base_radius = 280.0;
    shared.rod = 380.0;
    for (std::size_t limb = 0; limb < 3; ++limb) {
      shared.differences(limb, "beta0") = -to_radians(20.0 + 5.0 * static_cast<double>(limb));
    }
  });
  robot.workspace = {.radius = 100.0, .height = 150.0, .top_z = -300.0};
  return robot;
}

RobotDescription boxed() {
  RobotDescription robot = catalogue::rotary_delta().description();
  robot.name = "boxed";
  robot.workspace = Workspace::of_box({.x = {-150.0, 350.5}, .y = {-250.0, 200.0}, .z = {-1050.0, -800.0}});
  return robot;
}

/// Its joints at the plate do not stand before their limbs.
RobotDescription levelled() {
  RobotDescription robot = catalogue::rotary_delta().description();
  robot.name = "levelled";
  for (LimbDescription& limb : robot.limbs) {
    limb.plate = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()) * limb.plate;
  }
  robot.workspace = Workspace::of_levels({{-800.0, 300.0}, {-900.0, 480.0}, {-1050.0, 350.0}});
  return robot;
}

std::vector<std::string> templates_where(bool (*holds)(const Robot&)) {
  std::vector<std::string> kinds = io::robot_templates();
  std::erase_if(kinds, [&](const std::string& kind) { return !holds(robot_named(kind)); });
  return kinds;
}

}  // namespace

Robot robot_named(std::string_view name) {
  if (name == "unlike_limbs") return Robot(unlike_limbs());
  if (name == "inclined_rails") return Robot(inclined_rails());
  if (name == "boxed") return Robot(boxed());
  if (name == "levelled") return Robot(levelled());
  if (name == "mixed_limbs" || name == "seven_struts") {
    return io::read_robot(io::read_file(source_folder() / fmt::format("samples/{}.toml", name)));
  }
  const std::vector<std::string> templates = io::robot_templates();
  if (std::ranges::find(templates, name) != templates.end()) return io::read_robot(io::robot_template(name));
  return catalogue::find(name);
}

const std::vector<std::string_view>& template_names() {
  static const std::vector<std::string> kinds = templates_where([](const Robot& r) { return !r.is_level(); });
  static const std::vector<std::string_view> names(kinds.begin(), kinds.end());
  return names;
}

const std::vector<std::string_view>& hexapod_names() {
  static const std::vector<std::string> kinds =
      templates_where([](const Robot& r) { return !r.is_level() && r.freedoms().are_all(); });
  static const std::vector<std::string_view> names(kinds.begin(), kinds.end());
  return names;
}

const std::vector<std::string_view>& guided_names() {
  static const std::vector<std::string> kinds = templates_where([](const Robot& r) { return r.nominal().has_guides; });
  static const std::vector<std::string_view> names(kinds.begin(), kinds.end());
  return names;
}

const std::vector<std::string_view>& level_template_names() {
  static const std::vector<std::string> kinds = templates_where([](const Robot& r) { return r.is_level(); });
  static const std::vector<std::string_view> names(kinds.begin(), kinds.end());
  return names;
}

Pose Random::pose(const Robot& robot) {
  const Workspace& workspace = robot.workspace();
  const double share = std::sqrt(uniform(0.0, 1.0));
  const double azimuth = uniform(0.0, 2.0 * std::numbers::pi);
  const double depth = 1.0 - uniform(0.0, 1.0);
  Pose pose{workspace.at(share, azimuth, depth), uniform(workspace.min_rotation, workspace.max_rotation)};
  for (int axis = 0; axis < 3; ++axis) {
    const double largest = workspace.tilt_about(axis);
    if (largest > 0.0) pose.tilt(axis) = uniform(-largest, largest);
  }
  return pose;
}

SourceErrors Random::errors(const Robot& robot, double mm, double rad) {
  SourceErrors errors;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : sources_of(robot.actuator())) {
      const double size = unit(source, robot.actuator()) == Unit::rad ? rad : mm;
      errors(limb, source) = uniform(-size, size);
    }
  }
  return errors;
}

SourceErrors Random::realistic_errors(const Robot& robot) {
  SourceErrors errors;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : sources_of(robot.actuator())) {
      const double position_group = 0.7 / paper_scale(robot, source);
      const double size = tilts_plate(source) ? (*robot.tolerances())[source] : position_group;
      errors(limb, source) = uniform(-size, size);
    }
  }
  return errors;
}

Eigen::Vector3d Random::within(double radius) {
  const Eigen::Vector3d direction(normal(1.0), normal(1.0), normal(1.0));
  return radius * std::cbrt(uniform(0.0, 1.0)) * direction.normalized();
}

}  // namespace paracal::test
