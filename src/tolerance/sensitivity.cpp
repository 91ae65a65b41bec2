#include "paracal/tolerance/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "paracal/interruption.hpp"

namespace paracal {

PerSource squared_sensitivities(const Robot& robot, const SourceRows& rows) {
  PerSource sum = PerSource::Zero();
  for (Eigen::Index k = 0; k < rows.cols(); ++k) {
    sum(place(robot.parameters()[static_cast<std::size_t>(k)].source)) += rows.col(k).squaredNorm();
  }
  return sum;
}

PerSource half_widths(const Tolerances& tolerances) {
  return Eigen::Map<const PerSource>(tolerances.half_width.values.data());
}

PerSource variances(const Tolerances& tolerances) {
  PerSource variances;
  for (const Source source : all_sources()) variances(place(source)) = std::pow(tolerances.std(source), 2);
  return variances;
}

double sigma_of(const PerSource& squared_sensitivities, const PerSource& variances) {
  return std::sqrt((squared_sensitivities * variances).sum());
}

GlobalSensitivity mean_sensitivity(const Robot& robot, Characteristic characteristic,
                                   const std::vector<WeightedPose>& points) {
  const LinearModel model(robot);
  GlobalSensitivity global{
      .mean = PerSource::Zero(), .error = PerSource::Zero(), .largest = PerSource::Zero(), .poses = points.size()};
  for (const WeightedPose& point : points) {
    let_interrupt();
    const PerSource local = squared_sensitivities(robot, model.rows(point.pose, characteristic)).sqrt();
    global.mean += point.weight * local;
    global.largest = global.largest.max(local);
  }
  return global;
}

GlobalSensitivity global_sensitivity(const Robot& robot, Characteristic characteristic,
                                     const GlobalSensitivityOptions& options) {
  GlobalSensitivity coarse = mean_sensitivity(robot, characteristic, volume_rule(robot, 0, options.all_rotations));
  for (int level = 1;; ++level) {
    GlobalSensitivity fine = mean_sensitivity(robot, characteristic, volume_rule(robot, level, options.all_rotations));
    fine.error = (fine.mean - coarse.mean).abs();
    fine.largest = fine.largest.max(coarse.largest);
    if ((fine.error <= options.relative_error * fine.mean).all() || level >= options.max_level) return fine;
    coarse = fine;
  }
}

PerSource paper_units(const Robot& robot) {
  PerSource factor = PerSource::Ones();
  for (const Source source : sources_of(robot.limbs())) {
    if (tilts_plate(source)) factor(place(source)) = 1.0 / paper_scale(robot, source);
  }
  return factor;
}

std::vector<Contributor> contributors(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances) {
  const PerSource parts = squared_sensitivities(robot, rows) * variances(tolerances);
  const double whole = parts.sum();
  std::vector<Contributor> list;
  if (!(whole > 0.0)) return list;
  for (const Source source : sources_of(robot.limbs())) list.push_back({source, parts(place(source)) / whole});
  std::ranges::stable_sort(list, std::ranges::greater(), &Contributor::share);
  return list;
}

std::vector<ValueAtPose> sigma_map(const Robot& robot, Characteristic characteristic, const Tolerances& tolerances,
                                   const PolarGrid& grid, bool all_rotations) {
  const LinearModel model(robot);
  const PerSource variance = variances(tolerances);
  std::vector<ValueAtPose> map;
  for (const Pose& pose : polar_grid(robot, grid, all_rotations)) {
    map.push_back({pose, sigma_of(squared_sensitivities(robot, model.rows(pose, characteristic)), variance)});
  }
  return map;
}

}  // namespace paracal
