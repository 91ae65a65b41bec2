#include "calibration/plan/tolerated_reach.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::detail {
namespace {

SourceErrors wide_errors(const Robot& robot, const Tolerances& tolerances, std::uint64_t number) {
  constexpr std::uint64_t kSeed = 20;
  constexpr double kWider = 3.0;
  RandomStream random(kSeed, number);
  SourceErrors errors = draw_errors(robot, tolerances, random);
  for (const Parameter& one : robot.parameters()) {
    errors(one.limb, one.source) *= tilts_plate(one.source) ? 0.0 : kWider;
  }
  return errors;
}

}  // namespace

ToleratedReach::ToleratedReach(const Robot& robot) : nominal_(robot.nominal()) {
  constexpr std::uint64_t kMachines = 32;
  const Tolerances tolerances = tolerances_of(robot);
  for (std::uint64_t k = 0; k < kMachines; ++k) machines_.push_back(build(robot, wide_errors(robot, tolerances, k)));
  if (!(*this)({robot.workspace().centre()})) machines_.clear();
}

bool ToleratedReach::operator()(const Pose& pose) const {
  const InverseResult commanded = inverse(nominal_, pose);
  const ForwardOptions from{.start = plate_at(nominal_, pose)};
  return commanded.ok() && std::ranges::all_of(machines_, [&](const Machine& machine) {
           return inverse(machine, pose).ok() && forward(machine, commanded.joints, from).ok();
         });
}

namespace {

/// Level poses on the edges of the workspace shrunk towards its centre, at all extremes of rotation.
std::vector<Pose> shrunk_rim(const Workspace& workspace, double share) {
  constexpr int kAround = 24;
  const double low = workspace.min_rotation, high = workspace.max_rotation;
  std::vector<Pose> poses;
  for (const double depth : workspace.edge_depths()) {
    for (int k = 0; k < kAround; ++k) {
      const double azimuth = 2.0 * std::numbers::pi * k / kAround;
      const Eigen::Vector3d place = workspace.at(share, azimuth, 0.5 + share * (depth - 0.5));
      for (const double rotation : {low, 0.5 * (low + high), high}) poses.push_back({place, rotation});
    }
  }
  return poses;
}

}  // namespace

double tolerated_share(const Robot& robot) {
  constexpr int kSteps = 50;
  const ToleratedReach reaches(robot);
  for (int step = kSteps; step > 0; --step) {
    const double share = static_cast<double>(step) / kSteps;
    if (std::ranges::all_of(shrunk_rim(robot.workspace(), share), reaches)) return share;
  }
  return 1.0;
}

}  // namespace paracal::detail
