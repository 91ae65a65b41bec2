#include "paracal/printer/delta_geometry.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "paracal/error.hpp"
#include "paracal/mechanism/limb.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

bool is_linear(const DeltaGeometry& g) { return g.actuator == Actuator::linear; }

Eigen::Vector3d towards(double angle) { return {std::cos(angle), std::sin(angle), 0.0}; }

Eigen::Vector3d elbow(const DeltaGeometry& g, std::size_t i, double joint) {
  const Eigen::Vector3d u = towards(g.tower_angle[i]), up = Eigen::Vector3d::UnitZ();
  if (is_linear(g)) return g.radius * u + joint * up;
  return (g.radius + g.arm[i] * std::cos(joint)) * u + (g.shoulder[i] + g.arm[i] * std::sin(joint)) * up;
}

/// d elbow / d joint
Eigen::Vector3d elbow_by_joint(const DeltaGeometry& g, std::size_t i, double joint) {
  if (is_linear(g)) return Eigen::Vector3d::UnitZ();
  return g.arm[i] * (std::cos(joint) * Eigen::Vector3d::UnitZ() - std::sin(joint) * towards(g.tower_angle[i]));
}

/// d elbow / d numbers, the joint kept.
NozzleJacobian elbow_by_numbers(const DeltaGeometry& g, std::size_t i, double joint) {
  const auto tower = static_cast<Eigen::Index>(i);
  const Eigen::Vector3d u = towards(g.tower_angle[i]), up = Eigen::Vector3d::UnitZ();
  NozzleJacobian by = NozzleJacobian::Zero();
  by.col(DeltaNumber::radius) = u;
  if (i < 2) by.col(DeltaNumber::angle + tower) = up.cross(elbow(g, i, joint));
  if (is_linear(g)) return by;
  by.col(DeltaNumber::shoulder) = up;
  by.col(DeltaNumber::arm + tower) = std::cos(joint) * u + std::sin(joint) * up;
  return by;
}

/// Joint of one tower that holds the end of its rod at a point.
double joint_to(const DeltaGeometry& g, std::size_t i, const Eigen::Vector3d& place) {
  const Eigen::Vector3d u = towards(g.tower_angle[i]);
  const double out = place.dot(u) - g.radius, across = u.x() * place.y() - u.y() * place.x();
  const double rod = g.rod[i] * g.rod[i] - across * across;  // squared, seen from the side
  if (is_linear(g)) return place.z() + std::sqrt(rod - out * out);
  const double up = place.z() - g.shoulder[i], diameter = 2.0 * g.arm[i];
  const double reach = out * out + up * up + g.arm[i] * g.arm[i] - rod;
  const ArmDirection<double> direction = outward_direction(diameter * out, diameter * up, reach);
  return std::atan2(direction.sine, direction.cosine);
}

double height_weight(const DeltaReadings& readings) {
  constexpr double kMeasureWeight = 0.5;  // the firmware's
  if (readings.distances.empty() || readings.heights.empty()) return 1.0;
  const auto by_hand = std::ranges::count_if(readings.heights, &BedReading::by_hand);
  const auto probed = static_cast<double>(readings.heights.size()) - static_cast<double>(by_hand);
  return static_cast<double>(readings.distances.size()) / (kMeasureWeight * std::max(probed, 1.0));
}

/// Residuals of the heights, then of the distances, mm, unweighted; false where a geometry does not close.
template <typename Height, typename Distance>
bool for_residuals(const DeltaGeometry& g, const DeltaReadings& readings, Height&& height, Distance&& distance) {
  const auto add_height = [&](const BedReading& reading) {
    const auto p = nozzle(g, reading.drops);
    if (p) height(reading, *p, p->z() - reading.height);
    return p.has_value();
  };
  const auto add_distance = [&](const PrintedDistance& reading) {
    const auto from = nozzle(g, reading.from), to = nozzle(g, reading.to);
    if (!from || !to) return false;
    distance(reading, *from, *to, (*to - *from).norm() - reading.distance);
    return true;
  };
  return std::ranges::all_of(readings.heights, add_height) && std::ranges::all_of(readings.distances, add_distance);
}

struct Columns {
  Eigen::Index first, count;
};

DeltaBasis basis_of(std::initializer_list<Columns> columns) {
  DeltaBasis basis = DeltaBasis::Zero(DeltaNumber::count, DeltaNumber::count);
  Eigen::Index held = 0;
  for (const auto& [first, count] : columns) {
    basis.block(first, held, count, count).setIdentity();
    held += count;
  }
  return basis.leftCols(held);
}

}  // namespace

double design_angle(double angle) {
  constexpr double kFirst = to_radians(30.0), kPitch = to_radians(60.0);
  return kFirst + kPitch * std::round((angle - kFirst) / kPitch);
}

double reach(const DeltaGeometry& geometry) {
  return geometry.radius + std::ranges::max(geometry.arm) + std::ranges::max(geometry.rod);
}

std::array<double, 3> homed_joints(const DeltaGeometry& geometry) {
  std::array<double, 3> homed{};
  for (std::size_t i = 0; i < 3; ++i) homed[i] = joint_to(geometry, i, {0.0, 0.0, geometry.endstop[i]});
  return homed;
}

std::optional<JointDrops> drops_to(const DeltaGeometry& geometry, const Eigen::Vector3d& place) {
  JointDrops drops = homed_joints(geometry);
  for (std::size_t i = 0; i < 3; ++i) drops[i] -= joint_to(geometry, i, place);
  const bool reached = std::ranges::all_of(drops, [](double drop) { return std::isfinite(drop); });
  return reached ? std::optional(drops) : std::nullopt;
}

double endstop_of(const DeltaGeometry& geometry, std::size_t tower, double homed) {
  const Eigen::Vector3d from = elbow(geometry, tower, homed);
  return from.z() - std::sqrt(geometry.rod[tower] * geometry.rod[tower] - from.head<2>().squaredNorm());
}

DeltaNumbers numbers_of(const DeltaGeometry& g) {
  DeltaNumbers numbers;
  numbers << g.endstop[0], g.endstop[1], g.endstop[2], g.tower_angle[0], g.tower_angle[1], g.radius, g.rod[0], g.rod[1],
      g.rod[2], mean_of(g.shoulder), g.arm[0], g.arm[1], g.arm[2];
  return numbers;
}

DeltaGeometry with_numbers(DeltaGeometry geometry, const DeltaNumbers& numbers) {
  const double lift = numbers(DeltaNumber::shoulder) - numbers_of(geometry)(DeltaNumber::shoulder);
  geometry.radius = numbers(DeltaNumber::radius);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto tower = static_cast<Eigen::Index>(i);
    if (i < 2) geometry.tower_angle[i] = numbers(DeltaNumber::angle + tower);
    geometry.endstop[i] = numbers(DeltaNumber::endstop + tower);
    geometry.rod[i] = numbers(DeltaNumber::rod + tower);
    geometry.arm[i] = numbers(DeltaNumber::arm + tower);
    geometry.shoulder[i] += lift;
  }
  return geometry;
}

NozzleJacobian nozzle_jacobian(const DeltaGeometry& g, const JointDrops& drops, const Eigen::Vector3d& place) {
  Eigen::Matrix3d directions;
  NozzleJacobian right;
  const std::array<double, 3> homed = homed_joints(g);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    // The homed joint holds the rod's end at (0, 0, endstop), whatever the numbers are.
    const Eigen::Vector3d end(0.0, 0.0, g.endstop[i]), rod = end - elbow(g, i, homed[i]);
    DeltaNumbers homed_by = -elbow_by_numbers(g, i, homed[i]).transpose() * rod;
    homed_by(DeltaNumber::endstop + row) += rod.z();
    homed_by(DeltaNumber::rod + row) -= g.rod[i];
    homed_by /= rod.dot(elbow_by_joint(g, i, homed[i]));
    const double joint = homed[i] - drops[i];
    const Eigen::Vector3d d = place - elbow(g, i, joint);
    directions.row(row) = d;
    right.row(row) = d.transpose() * elbow_by_numbers(g, i, joint);
    right.row(row) += d.dot(elbow_by_joint(g, i, joint)) * homed_by.transpose();
    right(row, DeltaNumber::rod + row) += g.rod[i];
  }
  return directions.inverse() * right;
}

std::optional<Eigen::Vector3d> nozzle(const DeltaGeometry& geometry, const JointDrops& drops) {
  const std::array<double, 3> homed = homed_joints(geometry);
  const Eigen::Vector3d a = elbow(geometry, 0, homed[0] - drops[0]), b = elbow(geometry, 1, homed[1] - drops[1]),
                        c = elbow(geometry, 2, homed[2] - drops[2]);
  // In the plane of the elbows: ex towards b, ey in the plane, ez its normal.
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double base = ab.norm();
  const Eigen::Vector3d ex = ab / base;
  const double i = ex.dot(ac);
  const Eigen::Vector3d across = ac - i * ex;
  const double j = across.norm();
  const Eigen::Vector3d ey = across / j, ez = ex.cross(ey);
  const auto square = [&](std::size_t k) { return geometry.rod[k] * geometry.rod[k]; };
  const double x = (square(0) - square(1) + base * base) / (2.0 * base);
  const double y = (square(0) - square(2) + i * i + j * j - 2.0 * i * x) / (2.0 * j);
  const double z = std::sqrt(square(0) - x * x - y * y);
  const Eigen::Vector3d p = a + x * ex + y * ey + (ez.z() > 0.0 ? -z : z) * ez;
  return p.allFinite() ? std::optional(p) : std::nullopt;
}

DeltaBasis firmware_basis(Actuator actuator, bool with_distances) {
  constexpr Columns kEndstops{DeltaNumber::endstop, 3}, kAngles{DeltaNumber::angle, 2}, kRadius{DeltaNumber::radius, 1},
      kRods{DeltaNumber::rod, 3}, kShoulders{DeltaNumber::shoulder, 1};
  if (actuator == Actuator::linear) {
    return with_distances ? basis_of({kEndstops, kAngles, kRadius, kRods}) : basis_of({kEndstops, kAngles, kRadius});
  }
  return with_distances ? basis_of({kEndstops, kShoulders, kAngles, kRadius}) : basis_of({kEndstops, kShoulders});
}

DeltaFit judge_as_firmware(const DeltaGeometry& geometry, const DeltaReadings& readings) {
  DeltaFit fit{.geometry = geometry,
               .parameters = static_cast<int>(firmware_basis(geometry.actuator, !readings.distances.empty()).cols())};
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
  const DeltaBasis basis = firmware_basis(start.actuator, !readings.distances.empty());
  const double weight = std::sqrt(height_weight(readings));
  const DeltaNumbers first = numbers_of(start);
  const auto geometry_of = [&](const Eigen::VectorXd& unknowns) {
    return with_numbers(start, first + basis * unknowns);
  };
  const auto model = [&](const Eigen::VectorXd& unknowns, InformationRoot& root) {
    const DeltaGeometry g = geometry_of(unknowns);
    Eigen::RowVectorXd row(basis.cols() + 1);
    const auto add = [&](const auto& by_numbers, double residual) {
      row << by_numbers * basis, residual;
      root.add(row);
    };
    return for_residuals(
        g, readings,
        [&](const BedReading& reading, const Eigen::Vector3d& p, double residual) {
          add(weight * nozzle_jacobian(g, reading.drops, p).row(2), weight * residual);
        },
        [&](const PrintedDistance& reading, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double residual) {
          const NozzleJacobian motion = nozzle_jacobian(g, reading.to, to) - nozzle_jacobian(g, reading.from, from);
          add((to - from).normalized().transpose() * motion, residual);
        });
  };
  LeastSquaresOptions options;
  options.step_tolerance = 1e-9;
  const LeastSquaresResult found = solve_least_squares(model, Eigen::VectorXd::Zero(basis.cols()), options);
  DeltaFit fit = judge_as_firmware(geometry_of(found.parameters), readings);
  fit.status = found.status;
  return fit;
}

}  // namespace paracal
