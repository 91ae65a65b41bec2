#include "paracal/tolerance/analysis.hpp"

#include <algorithm>
#include <cmath>

#include "paracal/mechanism/random.hpp"

namespace paracal {
namespace {

/// In the order of the robot's parameters.
Eigen::VectorXd flat(const Robot& robot, const SourceErrors& errors) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(robot.parameters().size()));
  std::ranges::transform(robot.parameters(), values.begin(),
                         [&](const Parameter& one) { return errors(one.limb, one.source); });
  return values;
}

SourceErrors scaled(const Robot& robot, SourceErrors errors, double factor) {
  for (const Parameter& one : robot.parameters()) errors(one.limb, one.source) *= factor;
  return errors;
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
    one.contributors = contributors(robot, model.rows(one.three_sigma.pose, what), tolerances);
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
      return spread_at(robot, rows, tolerances, Spread::statistical) >= kCounts * one.three_sigma.value;
    });
    if (counts) poses.push_back(pose);
  }
  return poses;
}

std::vector<LinearityPoint> linearity(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic,
                                      const std::vector<Pose>& poses, const std::vector<double>& factors, int machines,
                                      std::uint64_t seed) {
  const Response response(robot, {characteristic}, poses);
  std::vector<LinearityPoint> points;
  for (const double factor : factors) {
    LinearityPoint point{.factor = factor};
    double off = 0.0, all = 0.0;
    for (int m = 0; m < machines; ++m) {
      RandomStream random(seed, static_cast<std::uint64_t>(m));
      const SourceErrors errors = scaled(robot, draw_errors(robot, tolerances, random), factor);
      Eigen::VectorXd exact(response.rows());
      if (!response.exact(errors, exact)) {
        ++point.not_closed;
        continue;
      }
      const Eigen::VectorXd linear = response.linear() * flat(robot, errors);
      off += (exact - linear).squaredNorm();
      all += linear.squaredNorm();
    }
    point.difference = all > 0.0 ? std::sqrt(off / all) : 0.0;
    points.push_back(point);
  }
  return points;
}

}  // namespace paracal
