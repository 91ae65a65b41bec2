#include "paracal/tolerance/requirement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "workspace_search.hpp"

namespace paracal {
namespace {

using Generators =
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, static_cast<int>(kMostSources) * kMaxLimbs>;

/// Columns g_k T_k that are not zero, filled up to three components with zeros.
Generators generators_of(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances) {
  Generators generators(3, rows.cols());
  Eigen::Index count = 0;
  for (Eigen::Index column = 0; column < rows.cols(); ++column) {
    const Source source = robot.parameters()[static_cast<std::size_t>(column)].source;
    const Eigen::VectorXd generator = rows.col(column) * tolerances.largest(source);
    if (generator.squaredNorm() == 0.0) continue;
    generators.col(count).setZero();
    generators.col(count++).head(rows.rows()) = generator;
  }
  return generators.leftCols(count);
}

/// The vertex of the zonotope farthest along a direction.
Eigen::Vector3d vertex(const Generators& generators, const Eigen::Vector3d& direction) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& generator : generators.colwise()) sum += std::copysign(1.0, direction.dot(generator)) * generator;
  return sum;
}

/// Climbs from a direction: the farthest vertex, seen from there again, until it stays. Each step is no shorter than
/// the one before, so this ends at a vertex that is the farthest along itself.
Eigen::Vector3d climb(const Generators& generators, const Eigen::Vector3d& start) {
  Eigen::Vector3d farthest = vertex(generators, start);
  for (int step = 0; step < 20; ++step) {
    const Eigen::Vector3d next = vertex(generators, farthest);
    if (next.squaredNorm() <= farthest.squaredNorm() * (1.0 + 1e-14)) break;
    farthest = next;
  }
  return farthest;
}

/// Every edge of a plane zonotope is a generator, so a vertex lies on either side of each generator's normal.
std::vector<Eigen::Vector3d> plane_starts(const Generators& generators) {
  std::vector<Eigen::Vector3d> starts;
  for (const auto& generator : generators.colwise()) {
    const Eigen::Vector3d normal = Eigen::Vector3d(-generator.y(), generator.x(), 0.0).normalized();
    const Eigen::Vector3d aside = 1e-9 * generator.normalized();
    starts.emplace_back(normal + aside);
    starts.emplace_back(normal - aside);
  }
  return starts;
}

std::vector<Eigen::Vector3d> starts_of(const Generators& generators, Eigen::Index components) {
  if (components == 2) return plane_starts(generators);
  std::vector<Eigen::Vector3d> starts{Eigen::Vector3d::UnitX()};
  if (components == 1) return starts;
  for (const auto& generator : generators.colwise()) starts.emplace_back(generator);
  for (int octant = 0; octant < 4; ++octant)
    starts.emplace_back(1.0, (octant & 1) != 0 ? -1.0 : 1.0, (octant & 2) != 0 ? -1.0 : 1.0);
  return starts;
}

}  // namespace

std::vector<Characteristic> characteristics_of(const std::vector<Requirement>& requirements) {
  std::vector<Characteristic> list;
  list.reserve(requirements.size());
  for (const Requirement& requirement : requirements) list.push_back(requirement.characteristic);
  return list;
}

std::string_view name(Spread criterion) {
  constexpr std::array<std::string_view, 3> kNames{"statistical", "worst-case", "yield"};
  return kNames[static_cast<std::size_t>(criterion)];
}

WorstCase worst_case(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances) {
  const Generators generators = generators_of(robot, rows, tolerances);
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& start : starts_of(generators, rows.rows())) {
    const Eigen::Vector3d end = climb(generators, start);
    if (end.squaredNorm() > farthest.squaredNorm()) farthest = end;
  }
  const double value = farthest.norm();
  return {value, value > 0.0 ? Eigen::Vector3d(farthest / value) : Eigen::Vector3d::UnitX()};
}

PerSource worst_case_weights(const Robot& robot, const SourceRows& rows, const Eigen::Vector3d& direction) {
  const Eigen::RowVectorXd along = (direction.head(rows.rows()).transpose() * rows).cwiseAbs();
  PerSource weights = PerSource::Zero();
  for (Eigen::Index column = 0; column < rows.cols(); ++column) {
    weights(place(robot.parameters()[static_cast<std::size_t>(column)].source)) += along(column);
  }
  return weights;
}

double spread_at(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances, Spread criterion) {
  if (criterion == Spread::worst_case) return worst_case(robot, rows, tolerances).value;
  return 3.0 * sigma_of(squared_sensitivities(robot, rows), variances(tolerances));
}

ValueAtPose worst_spread(const Robot& robot, Characteristic characteristic, const Tolerances& tolerances,
                         Spread criterion) {
  const LinearModel model(robot);
  return detail::largest_in_workspace(robot, [&](const Pose& pose) {
    return spread_at(robot, model.rows(pose, characteristic), tolerances, criterion);
  });
}

}  // namespace paracal
