#include "task.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"

namespace paracal::benchmark {
namespace {

using Random = std::mt19937_64;
constexpr Random::result_type kSeed = 20160101;

/// Sigma of a source error. Position group: the size of the identified errors of [huang2016, Table 4]. Tilt group: a
/// third of the tolerances of huang2016.
double typical_size(Source source) {
  static const Tolerances tolerances = catalogue::huang2016().tolerances().value();
  if (tilts_plate(source)) return tolerances[source] / 3.0;
  return unit(source, Actuator::revolute) == Unit::mm ? 0.3 : 1e-3;
}

SourceErrors draw_errors(std::size_t limb_count, Random& random) {
  std::normal_distribution<double> normal;
  SourceErrors errors;
  for (std::size_t limb = 0; limb < limb_count; ++limb) {
    for (const Source source : sources_of(Actuator::revolute))
      errors(limb, source) = typical_size(source) * normal(random);
  }
  return errors;
}

Pose draw_pose(const Workspace& workspace, Random& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const double outward = std::sqrt(share(random));
  const double azimuth = 2.0 * std::numbers::pi * share(random);
  const double depth = share(random);
  const double rotation = std::lerp(workspace.min_rotation, workspace.max_rotation, share(random));
  return {workspace.at(outward, azimuth, depth), rotation};
}

}  // namespace

Task make_task(const Robot& robot, std::size_t pose_count) {
  Random random(kSeed);
  const SourceErrors errors = draw_errors(robot.limb_count(), random);
  Task task{.robot = robot, .errors = errors, .machine = build(robot, errors), .poses = {}, .joints = {}, .plates = {}};
  while (task.poses.size() < pose_count) {
    const Pose pose = draw_pose(robot.workspace(), random);
    const InverseResult nominal = inverse(robot.nominal(), pose);
    if (!nominal.ok() || !inverse(task.machine, pose).ok()) continue;
    const ForwardResult actual = forward(task.machine, nominal.joints);
    if (!actual.ok()) continue;
    task.poses.push_back(pose);
    task.joints.push_back(nominal.joints);
    task.plates.push_back(actual.plate);
  }
  return task;
}

}  // namespace paracal::benchmark
