#include "paracal/printer/projection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/numerics/rigid_fit.hpp"

namespace paracal {
namespace {

/// Where the machine stands above its bed when the joints are so far below their endstops.
struct Place {
  JointDrops drops{};
  Eigen::Vector3d above_bed;
  Eigen::Vector3d by_robot;  ///< the same in the robot's frame
};

/// A point of the robot's frame in the bed's: turned by the bed's small slopes, z from the bed.
Eigen::Vector3d above(const FoundPlane& bed, const Eigen::Vector3d& p) {
  const double height = p.z() - bed.height - bed.slope_x * p.x() - bed.slope_y * p.y();
  return {p.x() + bed.slope_x * height, p.y() + bed.slope_y * height, height};
}

/// What a controller can be told: endstops, angles, radius (and height of the shoulders) always.
DeltaBasis told(Actuator actuator, ControllerRods rods) {
  DeltaBasis basis = DeltaBasis::Zero(DeltaNumber::count, DeltaNumber::count);
  Eigen::Index held = DeltaNumber::rod;
  basis.topLeftCorner(held, held).setIdentity();
  const auto tell_lengths = [&](Eigen::Index first) {
    if (rods == ControllerRods::alike) basis.col(held++).segment<3>(first).setOnes();
    if (rods != ControllerRods::each) return;
    basis.block<3, 3>(first, held).setIdentity();
    held += 3;
  };
  tell_lengths(DeltaNumber::rod);
  if (actuator == Actuator::revolute) {
    basis(DeltaNumber::shoulder, held++) = 1.0;
    tell_lengths(DeltaNumber::arm);
  }
  return basis.leftCols(held);
}

constexpr int kHeights = 3;

/// Rings of the workspace, at so many of several heights above the bed.
std::vector<Place> places_of(const KnownPrinter& known, const DeltaGeometry& geometry, int heights = kHeights) {
  constexpr int kRings = 4, kAround = 12;
  const Workspace& workspace = known.printer.robot.workspace();
  const Machine machine = build(known.printer.robot, known.errors);
  std::vector<Place> places;
  for (int level = 0; level < heights; ++level) {
    const double z = 0.5 * workspace.height * level / (kHeights - 1);
    for (int ring = 0; ring <= kRings; ++ring) {
      for (int k = 0; k < (ring == 0 ? 1 : kAround); ++k) {
        const double radius = workspace.radius * ring / kRings;
        const auto drops = drops_to(geometry, Workspace::on_circle(radius, 2.0 * std::numbers::pi * k / kAround, z));
        if (!drops) continue;
        const ForwardResult taken = forward(machine, known.printer.joints_at(*drops));
        if (!taken.ok()) continue;
        places.push_back({*drops, above(known.bed, taken.plate.position), taken.plate.position});
      }
    }
  }
  return places;
}

/// Places with both beliefs, stacked x, y, z.
struct Grid {
  Eigen::VectorXd machine, geometry, than;
  Eigen::MatrixXd by_errors;  ///< d machine / d (bed, parameters), as in KnownPrinter::covariance
  Eigen::MatrixXd motions;    ///< shifts along x and y, turn about z

  /// Without what such a motion explains.
  Eigen::VectorXd without_motion(const Eigen::VectorXd& stacked) const {
    return stacked - detail::product(motions, detail::least_squares(motions, stacked));
  }
};

/// d above() / d (height and slopes, its bow where that is sought, parameters): of the plane, which no bow moves.
Eigen::MatrixXd by_errors(const KnownPrinter& known, const Eigen::Vector3d& p, const Eigen::MatrixXd& by_parameters) {
  const FoundPlane& bed = known.bed;
  const double height = p.z() - bed.height - bed.slope_x * p.x() - bed.slope_y * p.y();
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(3, known.of_bed() + by_parameters.cols());
  by.rightCols(by_parameters.cols()) = by_parameters.topRows(3);
  by.row(2).rightCols(by_parameters.cols()) -= Eigen::RowVector2d(bed.slope_x, bed.slope_y) * by_parameters.topRows(2);
  by.row(2).head<3>() << -1.0, -p.x(), -p.y();
  by(0, 1) = by(1, 2) = height;
  by.row(0) += bed.slope_x * by.row(2);
  by.row(1) += bed.slope_y * by.row(2);
  return by;
}

Grid grid_of(const KnownPrinter& known, const DeltaGeometry& geometry, const DeltaGeometry& than,
             CountedFrom from = CountedFrom::plane) {
  const Machine machine = build(known.printer.robot, known.errors);
  const Eigen::Index n = std::ssize(known.parameters);
  const std::vector<Place> places = places_of(known, than);
  Grid grid;
  const Eigen::Index rows = 3 * std::ssize(places);
  grid.machine.resize(rows);
  grid.geometry.resize(rows);
  grid.than.resize(rows);
  grid.by_errors.resize(rows, known.of_bed() + n);
  grid.motions.resize(rows, 3);
  Eigen::Index at = 0;
  for (const Place& place : places) {
    const Joints joints = known.printer.joints_at(place.drops);
    const auto one = nozzle(geometry, place.drops), other = nozzle(than, place.drops);
    const Eigen::MatrixXd jacobian = pose_jacobian(machine, joints, known.parameters);
    if (!one || !other || jacobian.rows() == 0) continue;
    const auto here = Eigen::seqN(at, Eigen::fix<3>);
    grid.machine(here) = place.above_bed;
    grid.geometry(here) = *one;
    grid.than(here) = *other;
    grid.by_errors.middleRows<3>(at) = by_errors(known, place.by_robot, jacobian);
    if (from == CountedFrom::bed && known.bow.is_sought()) {
      grid.machine(at + 2) -= known.bow.edge * known.bow.share_at(place.by_robot);
      grid.by_errors(at + 2, 3) = -known.bow.share_at(place.by_robot);
    }
    grid.motions.middleRows<3>(at) << 1.0, 0.0, -other->y(), 0.0, 1.0, other->x(), 0.0, 0.0, 0.0;
    at += 3;
  }
  for (Eigen::VectorXd* one : {&grid.machine, &grid.geometry, &grid.than}) one->conservativeResize(at);
  grid.by_errors.conservativeResize(at, Eigen::NoChange);
  grid.motions.conservativeResize(at, Eigen::NoChange);
  return grid;
}

DeltaAccuracy accuracy_at(const std::vector<Place>& places, const DeltaGeometry& geometry) {
  std::vector<Eigen::Vector3d> believed, actual;  // along the bed
  std::vector<double> rise;
  for (const Place& place : places) {
    const auto p = nozzle(geometry, place.drops);
    if (!p) continue;
    believed.emplace_back(p->x(), p->y(), 0.0);
    actual.emplace_back(place.above_bed.x(), place.above_bed.y(), 0.0);
    rise.push_back(p->z() - place.above_bed.z());
  }
  DeltaAccuracy accuracy;
  const auto count = static_cast<double>(rise.size());
  const RigidMotion motion = rise.empty() ? RigidMotion{} : rigid_fit(believed, actual);
  for (std::size_t k = 0; k < rise.size(); ++k) {
    const double absolute = std::hypot((believed[k] - actual[k]).norm(), rise[k]);
    const double shape = std::hypot((motion(believed[k]) - actual[k]).norm(), rise[k]);
    accuracy.absolute_rms += absolute * absolute / count;
    accuracy.shape_rms += shape * shape / count;
    accuracy.absolute_max = std::max(accuracy.absolute_max, absolute);
    accuracy.shape_max = std::max(accuracy.shape_max, shape);
  }
  accuracy.absolute_rms = std::sqrt(accuracy.absolute_rms);
  accuracy.shape_rms = std::sqrt(accuracy.shape_rms);
  return accuracy;
}

}  // namespace

MotionOnBed unseen_motion(const KnownPrinter& known, const DeltaGeometry& geometry) {
  const Grid grid = grid_of(known, geometry, geometry);
  if (grid.machine.size() == 0) return {};
  const Eigen::Vector3d motion = detail::least_squares(grid.motions, grid.geometry - grid.machine);
  return {motion.x(), motion.y(), motion.z()};
}

double chance_better(const KnownPrinter& known, const DeltaGeometry& geometry, const DeltaGeometry& than,
                     CountedFrom above) {
  const Grid grid = grid_of(known, geometry, than, above);
  const Eigen::VectorXd change = grid.without_motion(grid.geometry - grid.than);
  constexpr double kNothing = 1e-4;  // mm, root mean square: no fit settles closer
  if (change.norm() < kNothing * std::sqrt(static_cast<double>(std::max<Eigen::Index>(change.size(), 3)) / 3.0))
    return 0.5;
  const double gain = change.dot(2.0 * grid.machine - grid.geometry - grid.than);
  const Eigen::VectorXd by_errors = detail::product(grid.by_errors.transpose(), change);
  const double variance =
      known.covariance.size() > 0 ? 4.0 * by_errors.dot(detail::product(known.covariance, by_errors).col(0)) : 0.0;
  if (!(variance > 0.0)) return gain > 0.0 ? 1.0 : gain < 0.0 ? 0.0 : 0.5;
  return detail::normal_probability(gain / std::sqrt(variance));
}

double expected_shape(const KnownPrinter& known, const DeltaGeometry& geometry) {
  const Grid grid = grid_of(known, geometry, geometry);
  const Eigen::Index places = grid.machine.size() / 3;
  if (places == 0) return 0.0;
  double square = grid.without_motion(grid.machine - grid.geometry).squaredNorm();
  if (known.covariance.size() > 0) {
    Eigen::MatrixXd shape = grid.by_errors;
    for (auto column : shape.colwise()) column = grid.without_motion(column);
    square += detail::product(shape, known.covariance).cwiseProduct(shape).sum();
  }
  return std::sqrt(square / static_cast<double>(places));
}

std::optional<Eigen::Vector3d> deviation(const KnownPrinter& known, const DeltaGeometry& geometry,
                                         const JointDrops& drops) {
  const auto believed = nozzle(geometry, drops);
  const ForwardResult taken = forward(build(known.printer.robot, known.errors), known.printer.joints_at(drops));
  if (!believed || !taken.ok()) return std::nullopt;
  return above(known.bed, taken.plate.position) - *believed;
}

double depth_at_zero(const KnownPrinter& known, const DeltaGeometry& geometry) {
  double depth = 0.0;
  for (const Place& place : places_of(known, geometry, 1)) {
    const double bow = known.bow.is_sought() ? known.bow.edge * known.bow.share_at(place.by_robot) : 0.0;
    depth = std::max(depth, bow - place.above_bed.z());
  }
  return depth;
}

DeltaAccuracy accuracy_of(const KnownPrinter& known, const DeltaGeometry& geometry) {
  return accuracy_at(places_of(known, geometry), geometry);
}

DeltaProjection project(const KnownPrinter& known, const DeltaGeometry& start, ControllerRods rods) {
  const std::vector<Place> places = places_of(known, start);
  DeltaGeometry first = start;
  if (rods == ControllerRods::alike) {
    first.rod.fill(mean_of(start.rod));
    first.arm.fill(mean_of(start.arm));
  }
  const DeltaBasis basis = told(start.actuator, rods);
  const Eigen::Index held = basis.cols();
  // Unknowns: what the controller is told, then shift x, y and turn.
  const DeltaNumbers numbers = numbers_of(first);
  const auto geometry_of = [&](const Eigen::VectorXd& unknowns) {
    return with_numbers(first, numbers + basis * unknowns.head(held));
  };
  const auto model = [&](const Eigen::VectorXd& unknowns, InformationRoot& root) {
    const DeltaGeometry geometry = geometry_of(unknowns);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(unknowns(held + 2), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, held + 4);
    for (const Place& place : places) {
      const auto p = nozzle(geometry, place.drops);
      if (!p) return false;
      const Eigen::Vector3d turned = turn * *p;
      rows.leftCols(held) = turn * nozzle_jacobian(geometry, place.drops, *p) * basis;
      rows.middleCols<2>(held) = Eigen::Matrix<double, 3, 2>::Identity();
      rows.col(held + 2) = Eigen::Vector3d::UnitZ().cross(turned);
      rows.col(held + 3) = turned + Eigen::Vector3d(unknowns(held), unknowns(held + 1), 0.0) - place.above_bed;
      root.add(rows);
    }
    return true;
  };
  const LeastSquaresResult found = solve_least_squares(model, Eigen::VectorXd::Zero(held + 3));
  const DeltaGeometry geometry = geometry_of(found.parameters);
  return {found.status, geometry, accuracy_at(places, geometry)};
}

}  // namespace paracal
