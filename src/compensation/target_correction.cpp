#include "paracal/compensation/target_correction.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cassert>

#include "paracal/compensation/parameters.hpp"

namespace paracal {

TargetCorrection::TargetCorrection(const Robot& robot, const SourceErrors& errors)
    : robot_(robot), compensator_(compensator_parameters(robot, errors)) {}

std::optional<Pose> TargetCorrection::target(const Pose& wanted) const {
  CompensatorJoints<double> joints{};
  if (compensator_.compensate(compensator_pose(wanted), joints) != CompensationStatus::ok) return std::nullopt;
  return corrected_target(robot_, compensated_joints(robot_, joints), wanted);
}

void TargetCorrection::targets(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets,
                               unsigned threads) const {
  assert(wanted.size() == targets.size());
  const auto cores = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t workers = threads == 0 ? cores : std::min<std::size_t>(threads, cores);
  const auto part = [&](std::size_t worker) {
    const std::size_t end = (worker + 1) * wanted.size() / workers;
    for (std::size_t k = worker * wanted.size() / workers; k < end; ++k) targets[k] = target(wanted[k]);
  };
  tbb::parallel_for(std::size_t{0}, workers, part, tbb::simple_partitioner());
}

}  // namespace paracal
