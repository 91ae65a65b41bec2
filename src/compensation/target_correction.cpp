#include "paracal/compensation/target_correction.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "paracal/compensation/parameters.hpp"
#include "paracal/compensation/path.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {

namespace {

/// Of a plate that stays level: the machine's parameters with the controller's robot as the nominal one.
std::optional<CompensatorParameters<double>> level_parameters(const Robot& robot, const SourceErrors& errors,
                                                              const Robot& controller, const DriveCurves& drives) {
  if (!robot.is_level()) return std::nullopt;
  CompensatorParameters<double> parameters = compensator_parameters(robot, errors, drives);
  parameters.nominal = compensator_parameters(controller, {}).nominal;
  return parameters;
}

}  // namespace

TargetCorrection::TargetCorrection(const Robot& robot, const SourceErrors& errors)
    : TargetCorrection(robot, errors, robot) {}

TargetCorrection::TargetCorrection(const Robot& robot, const SourceErrors& errors, const Robot& controller,
                                   DriveCurves drives)
    : robot_(robot),
      controller_(controller),
      machine_(build(robot, errors)),
      drives_(std::move(drives)),
      level_(level_parameters(robot, errors, controller, drives_)) {}

std::optional<Joints> TargetCorrection::joints(const Pose& wanted) const {
  const InverseResult found = inverse(machine_, wanted);
  return found.ok() ? std::optional(drives_.commanded(found.joints)) : std::nullopt;
}

std::optional<Pose> TargetCorrection::target(const Pose& wanted) const {
  std::optional<Pose> target;
  correct({&wanted, 1}, {&target, 1});
  return target;
}

void TargetCorrection::correct(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets) const {
  if (!level_) {
    std::ranges::transform(wanted, targets.begin(), [this](const Pose& one) { return by_itself(one); });
    return;
  }
  std::vector<CompensatorPose<double>> poses(wanted.size());
  std::ranges::transform(wanted, poses.begin(), closure_pose<double>);
  std::vector<std::optional<CompensatorPose<double>>> found(wanted.size());
  nominal_targets(*level_, poses, found);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (found[k]) {
      targets[k] = Pose{{found[k]->x, found[k]->y, found[k]->z}, found[k]->phi};
    } else {
      targets[k] = by_itself(wanted[k]);
    }
  }
}

std::optional<Pose> TargetCorrection::by_itself(const Pose& wanted) const {
  const std::optional<Joints> found = joints(wanted);
  return found ? corrected_target(controller_, *found, wanted) : std::nullopt;
}

void TargetCorrection::targets(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets,
                               unsigned threads) const {
  assert(wanted.size() == targets.size());
  const auto cores = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t workers = threads == 0 ? cores : std::min<std::size_t>(threads, cores);
  const auto part = [&](std::size_t worker) {
    const std::size_t first = worker * wanted.size() / workers, count = (worker + 1) * wanted.size() / workers - first;
    correct(wanted.subspan(first, count), targets.subspan(first, count));
  };
  tbb::parallel_for(std::size_t{0}, workers, part, tbb::simple_partitioner());
}

}  // namespace paracal
