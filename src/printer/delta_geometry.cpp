#include "paracal/printer/delta_geometry.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "paracal/error.hpp"

namespace paracal {
namespace {

constexpr Eigen::Index kWithoutArms = 6, kWithArms = 9;

Eigen::Vector3d carriage(const DeltaGeometry& g, const CarriageDrops& drops, std::size_t i) {
  const double height = std::sqrt(g.arm[i] * g.arm[i] - g.radius * g.radius);
  return {g.radius * std::cos(g.tower_angle[i]), g.radius * std::sin(g.tower_angle[i]),
          g.endstop[i] + height - drops[i]};
}

double height_weight(const DeltaReadings& readings) {
  constexpr double kMeasureWeight = 0.5;  // the firmware's
  if (readings.distances.empty()) return 1.0;
  return static_cast<double>(readings.distances.size()) /
         (kMeasureWeight * static_cast<double>(readings.heights.size()));
}

/// Residuals of the heights, then of the distances, mm, unweighted; false where a geometry does not close.
template <typename Height, typename Distance>
bool for_residuals(const DeltaGeometry& g, const DeltaReadings& readings, Height&& height, Distance&& distance) {
  for (const BedReading& reading : readings.heights) {
    const auto p = nozzle(g, reading.drops);
    if (!p) return false;
    height(reading, *p, p->z() - reading.height);
  }
  for (const PrintedDistance& reading : readings.distances) {
    const auto from = nozzle(g, reading.from), to = nozzle(g, reading.to);
    if (!from || !to) return false;
    distance(reading, *from, *to, (*to - *from).norm() - reading.distance);
  }
  return true;
}

}  // namespace

Eigen::Matrix<double, 9, 1> numbers_of(const DeltaGeometry& g) {
  Eigen::Matrix<double, 9, 1> numbers;
  numbers << g.radius, g.tower_angle[0], g.tower_angle[1], g.endstop[0], g.endstop[1], g.endstop[2], g.arm[0], g.arm[1],
      g.arm[2];
  return numbers;
}

DeltaGeometry with_numbers(DeltaGeometry geometry, const Eigen::VectorXd& numbers) {
  geometry.radius = numbers(0);
  geometry.tower_angle[0] = numbers(1);
  geometry.tower_angle[1] = numbers(2);
  for (std::size_t i = 0; i < 3; ++i) {
    geometry.endstop[i] = numbers(static_cast<Eigen::Index>(3 + i));
    if (numbers.size() == kWithArms) geometry.arm[i] = numbers(static_cast<Eigen::Index>(6 + i));
  }
  return geometry;
}

NozzleJacobian nozzle_jacobian(const DeltaGeometry& g, const CarriageDrops& drops, const Eigen::Vector3d& place) {
  Eigen::Matrix3d directions;
  NozzleJacobian right = NozzleJacobian::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double c = std::cos(g.tower_angle[i]), s = std::sin(g.tower_angle[i]);
    const double height = std::sqrt(g.arm[i] * g.arm[i] - g.radius * g.radius);
    const Eigen::Vector3d d = place - carriage(g, drops, i);
    directions.row(row) = d;
    right(row, 0) = d.dot(Eigen::Vector3d(c, s, -g.radius / height));
    if (i < 2) right(row, 1 + row) = g.radius * (c * d.y() - s * d.x());
    right(row, 3 + row) = d.z();
    right(row, 6 + row) = d.z() * g.arm[i] / height + g.arm[i];
  }
  return directions.inverse() * right;
}

std::optional<Eigen::Vector3d> nozzle(const DeltaGeometry& geometry, const CarriageDrops& drops) {
  const Eigen::Vector3d a = carriage(geometry, drops, 0), b = carriage(geometry, drops, 1),
                        c = carriage(geometry, drops, 2);
  // In the plane of the carriages: ex towards b, ey in the plane, ez its normal.
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double base = ab.norm();
  const Eigen::Vector3d ex = ab / base;
  const double i = ex.dot(ac);
  const Eigen::Vector3d across = ac - i * ex;
  const double j = across.norm();
  const Eigen::Vector3d ey = across / j, ez = ex.cross(ey);
  const auto square = [&](std::size_t k) { return geometry.arm[k] * geometry.arm[k]; };
  const double x = (square(0) - square(1) + base * base) / (2.0 * base);
  const double y = (square(0) - square(2) + i * i + j * j - 2.0 * i * x) / (2.0 * j);
  const double z = std::sqrt(square(0) - x * x - y * y);
  const Eigen::Vector3d p = a + x * ex + y * ey + (ez.z() > 0.0 ? -z : z) * ez;
  return p.allFinite() ? std::optional(p) : std::nullopt;
}

DeltaFit judge_as_firmware(const DeltaGeometry& geometry, const DeltaReadings& readings) {
  DeltaFit fit{.geometry = geometry,
               .parameters = static_cast<int>(readings.distances.empty() ? kWithoutArms : kWithArms)};
  double heights = 0.0, distances = 0.0;
  const bool closes = for_residuals(
      geometry, readings,
      [&](const BedReading&, const Eigen::Vector3d&, double residual) { heights += residual * residual; },
      [&](const PrintedDistance&, const Eigen::Vector3d&, const Eigen::Vector3d&, double residual) {
        distances += residual * residual;
      });
  if (!closes) return fit;
  const auto rms = [](double sum, std::size_t count) {
    return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
  };
  fit.status = LeastSquaresStatus::converged;
  fit.rms_height = rms(heights, readings.heights.size());
  fit.rms_distance = rms(distances, readings.distances.size());
  fit.cost = height_weight(readings) * heights + distances;
  return fit;
}

DeltaFit fit_as_firmware(const DeltaGeometry& start, const DeltaReadings& readings) {
  if (readings.heights.empty()) throw InvalidArgument("delta fit: expected heights of the bed, got none");
  const Eigen::Index count = readings.distances.empty() ? kWithoutArms : kWithArms;
  const double weight = std::sqrt(height_weight(readings));
  const auto model = [&](const Eigen::VectorXd& unknowns, InformationRoot& root) {
    const DeltaGeometry g = with_numbers(start, unknowns);
    Eigen::RowVectorXd row(count + 1);
    const auto add = [&](const auto& derivative, double residual) {
      row << derivative, residual;
      root.add(row);
    };
    return for_residuals(
        g, readings,
        [&](const BedReading& reading, const Eigen::Vector3d& p, double residual) {
          add(weight * nozzle_jacobian(g, reading.drops, p).row(2).head(count), weight * residual);
        },
        [&](const PrintedDistance& reading, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double residual) {
          const NozzleJacobian motion = nozzle_jacobian(g, reading.to, to) - nozzle_jacobian(g, reading.from, from);
          add((to - from).normalized().transpose() * motion.leftCols(count), residual);
        });
  };
  LeastSquaresOptions options;
  options.step_tolerance = 1e-9;
  const LeastSquaresResult found = solve_least_squares(model, numbers_of(start).head(count), options);
  DeltaFit fit = judge_as_firmware(with_numbers(start, found.parameters), readings);
  fit.status = found.status;
  fit.iterations = found.iterations;
  return fit;
}

}  // namespace paracal
