#include "paracal/tolerance/analysis.hpp"

#include <algorithm>
#include <cmath>

#include "paracal/mechanism/random.hpp"

namespace paracal {
namespace {

Eigen::VectorXd flat(const SourceErrors& errors, std::size_t limbs) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(limbs * kSourceCount));
  for (std::size_t limb = 0; limb < limbs; ++limb) {
    for (const Source source : all_sources()) {
      values(static_cast<Eigen::Index>(limb * kSourceCount + index(source))) = errors(limb, source);
    }
  }
  return values;
}

SourceErrors scaled(const SourceErrors& errors, std::size_t limbs, double factor) {
  SourceErrors result;
  for (std::size_t limb = 0; limb < limbs; ++limb) {
    for (const Source source : all_sources()) result(limb, source) = factor * errors(limb, source);
  }
  return result;
}

}  // namespace

std::vector<RequirementAnalysis> analyze(const Robot& robot, const Tolerances& tolerances,
                                         const std::vector<Requirement>& requirements) {
  std::vector<RequirementAnalysis> list;
  const LinearModel model(robot);
  for (const Requirement& requirement : requirements) {
    const Characteristic what = requirement.characteristic;
    RequirementAnalysis one{.requirement = requirement,
                            .worst_case = worst_spread(robot, what, tolerances, Spread::worst_case),
                            .three_sigma = worst_spread(robot, what, tolerances, Spread::statistical),
                            .contributors = {}};
    one.contributors = contributors(model.rows(one.three_sigma.pose, what), tolerances, robot.actuator());
    list.push_back(std::move(one));
  }
  return list;
}

std::vector<Pose> judged_poses(const Robot& robot, const Tolerances& tolerances,
                               const std::vector<RequirementAnalysis>& analyses) {
  constexpr double kCounts = 0.8;
  const LinearModel model(robot);
  std::vector<Pose> poses;
  poses.reserve(analyses.size());
  for (const RequirementAnalysis& one : analyses) poses.push_back(one.three_sigma.pose);
  for (const Pose& pose : surface_poses(robot)) {
    const bool counts = std::ranges::any_of(analyses, [&](const RequirementAnalysis& one) {
      const SourceRows rows = model.rows(pose, one.requirement.characteristic);
      return spread_at(rows, tolerances, Spread::statistical) >= kCounts * one.three_sigma.value;
    });
    if (counts) poses.push_back(pose);
  }
  return poses;
}

std::vector<LinearityPoint> linearity(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic,
                                      const std::vector<Pose>& poses, const std::vector<double>& factors, int machines,
                                      std::uint64_t seed) {
  const Response response(robot, {characteristic}, poses);
  const std::size_t limbs = robot.limb_count();
  std::vector<LinearityPoint> points;
  for (const double factor : factors) {
    LinearityPoint point{.factor = factor};
    double off = 0.0, all = 0.0;
    for (int m = 0; m < machines; ++m) {
      RandomStream random(seed, static_cast<std::uint64_t>(m));
      const SourceErrors errors = scaled(draw_errors(tolerances, limbs, random), limbs, factor);
      Eigen::VectorXd exact(response.rows());
      if (!response.exact(errors, exact)) {
        ++point.not_closed;
        continue;
      }
      const Eigen::VectorXd linear = response.linear() * flat(errors, limbs);
      off += (exact - linear).squaredNorm();
      all += linear.squaredNorm();
    }
    point.difference = all > 0.0 ? std::sqrt(off / all) : 0.0;
    points.push_back(point);
  }
  return points;
}

}  // namespace paracal
