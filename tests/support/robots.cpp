#include "support/robots.hpp"

#include <cmath>
#include <numbers>

#include "paracal/kinematics/error_model.hpp"

namespace paracal::test {

Pose Random::pose(const Robot& robot) {
  const Workspace& workspace = robot.workspace();
  const double radius = workspace.radius * std::sqrt(uniform(0.0, 1.0));
  const double azimuth = uniform(0.0, 2.0 * std::numbers::pi);
  const double z = uniform(workspace.top_z - workspace.height, workspace.top_z);
  return {Workspace::on_circle(radius, azimuth, z), uniform(workspace.min_rotation, workspace.max_rotation)};
}

SourceErrors Random::errors(const Robot& robot, double mm, double rad) {
  SourceErrors errors;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
      const double size = unit(source, robot.actuator()) == Unit::mm ? mm : rad;
      errors(limb, source) = uniform(-size, size);
    }
  }
  return errors;
}

SourceErrors Random::realistic_errors(const Robot& robot) {
  SourceErrors errors;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
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
