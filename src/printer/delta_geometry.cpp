#include "paracal/printer/delta_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "numerics/small.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/machine_impl.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

/// Of the closure of one tower, (|end - elbow|^2 - rod^2) / 2 = 0, the end kept.
struct TowerDerivative {
  Eigen::Vector3d rod;  ///< from the elbow to the end: the derivative by the end
  DeltaNumbers numbers = DeltaNumbers::Zero();
  double joint = 0.0;
};

TowerDerivative tower_derivative(const Limb& limb, Eigen::Index tower, double joint, const Eigen::Vector3d& end) {
  const closure::ClosedElbow<double> elbow = ends_at<1>(limb, joint).elbow;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), rod = end - as_eigen(elbow.centre);
  TowerDerivative by{.rod = rod, .joint = closure::rod_by_joint<double>(limb, closure_vector<double>(rod), elbow.v1)};
  by.numbers(DeltaNumber::radius) = -rod.dot(as_eigen(limb.radial));
  if (tower < 2) by.numbers(DeltaNumber::angle + tower) = -rod.dot(up.cross(as_eigen(elbow.centre)));
  by.numbers(DeltaNumber::rod + tower) = -limb.rod[0];
  if (runs_on_rail(limb.actuator)) return by;
  by.numbers(DeltaNumber::shoulder) = -rod.z();
  by.numbers(DeltaNumber::arm + tower) = -rod.dot(as_eigen(elbow.u1));
  return by;
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

Machine machine_of(const DeltaGeometry& geometry) {
  const bool linear = geometry.actuator == Actuator::linear;
  Machine machine{};
  machine.limb_count = 3;
  machine.freedoms = kLevelPlate;
  machine.has_guides = true;
  for (std::size_t i = 0; i < 3; ++i) {
    Limb& limb = machine.limbs[i];
    limb.set_kind(linear ? Actuator::carriage : Actuator::crank);
    const Eigen::Matrix3d frame = detail::nominal_frame(geometry.tower_angle[i]);
    limb.radial = closure_vector<double>(frame.col(0));
    limb.normal = closure_vector<double>(frame.col(1));
    limb.axis = closure_vector<double>(frame.col(2));
    limb.base = closure::scaled(limb.radial, geometry.radius);
    limb.rod.fill(geometry.rod[i]);
    if (!linear) {
      limb.base[2] = geometry.shoulder[i];
      limb.arm = geometry.arm[i];
    }
    limb.joint_offset = joint_to(limb, {0.0, 0.0, geometry.endstop[i]});
  }
  return machine;
}

std::array<double, 3> homed_joints(const DeltaGeometry& geometry) {
  const Machine machine = machine_of(geometry);
  return {machine.limbs[0].joint_offset, machine.limbs[1].joint_offset, machine.limbs[2].joint_offset};
}

std::optional<JointDrops> drops_to(const DeltaGeometry& geometry, const Eigen::Vector3d& place) {
  const InverseResult reached = inverse(machine_of(geometry), {place});
  if (!reached.ok()) return std::nullopt;
  return JointDrops{-reached.joints(0), -reached.joints(1), -reached.joints(2)};
}

double endstop_of(const DeltaGeometry& geometry, std::size_t tower, double homed) {
  Limb limb = machine_of(geometry).limbs[tower];
  limb.joint_offset = homed;
  const auto ends = ends_at<1>(limb, 0.0);
  const auto from = as_eigen(ends.elbow.centre);
  return from.z() - std::sqrt(limb.rod[0] * limb.rod[0] - from.head<2>().squaredNorm());
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

NozzleJacobian nozzle_jacobian(const DeltaGeometry& geometry, const JointDrops& drops, const Eigen::Vector3d& place) {
  const Machine machine = machine_of(geometry);
  Eigen::Matrix3d rods;
  NozzleJacobian right;
  for (std::size_t i = 0; i < 3; ++i) {
    const Limb& limb = machine.limbs[i];
    const auto row = static_cast<Eigen::Index>(i);
    const TowerDerivative at = tower_derivative(limb, row, -drops[i], place);
    TowerDerivative homed = tower_derivative(limb, row, 0.0, {0.0, 0.0, geometry.endstop[i]});
    homed.numbers(DeltaNumber::endstop + row) = homed.rod.z();
    rods.row(row) = at.rod;
    right.row(row) = at.joint / homed.joint * homed.numbers - at.numbers;  // whatever moves, it stays closed when homed
  }
  return rods.inverse() * right;
}

std::optional<Eigen::Vector3d> nozzle(const DeltaGeometry& geometry, const JointDrops& drops) {
  constexpr double kFlat = 1e-9;  // volume between unit vectors along the rods: towers in one place hold nothing
  const Machine machine = machine_of(geometry);
  const Joints joints = -Eigen::Vector3d::Map(drops.data());
  const ForwardResult found = forward(machine, joints, {.step_tolerance = 1e-6, .max_residual = 1e-6});
  const Eigen::Vector3d& p = found.plate.position;
  Eigen::Matrix3d rods;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto ends = ends_at<1>(machine.limbs[static_cast<std::size_t>(i)], joints(i));
    rods.col(i) = (p - as_eigen(ends.elbow.centre)).normalized();
  }
  return found.ok() && std::abs(rods.determinant()) > kFlat ? std::optional(p) : std::nullopt;
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
