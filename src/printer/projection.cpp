#include "paracal/printer/projection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "paracal/kinematics/forward.hpp"

namespace paracal {
namespace {

/// Where the machine stands above its bed when the joints are so far below their endstops.
struct Place {
  JointDrops drops{};
  Eigen::Vector3d above_bed;
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

/// Rings of the workspace at several heights above the bed.
std::vector<Place> places_of(const KnownPrinter& known, const DeltaGeometry& geometry) {
  constexpr int kHeights = 3, kRings = 4, kAround = 12;
  const Workspace& workspace = known.printer.robot.workspace();
  const Machine machine = build(known.printer.robot, known.errors);
  std::vector<Place> places;
  for (int level = 0; level < kHeights; ++level) {
    const double z = 0.5 * workspace.height * level / (kHeights - 1);
    for (int ring = 0; ring <= kRings; ++ring) {
      for (int k = 0; k < (ring == 0 ? 1 : kAround); ++k) {
        const double radius = workspace.radius * ring / kRings;
        const auto drops = drops_to(geometry, Workspace::on_circle(radius, 2.0 * std::numbers::pi * k / kAround, z));
        if (!drops) continue;
        const ForwardResult taken = forward(machine, known.printer.joints_at(*drops));
        if (!taken.ok()) continue;
        places.push_back({*drops, above(known.bed, taken.plate.position)});
      }
    }
  }
  return places;
}

DeltaAccuracy accuracy_at(const std::vector<Place>& places, const DeltaGeometry& geometry) {
  std::vector<Eigen::Vector3d> believed, actual;
  for (const Place& place : places) {
    const auto p = nozzle(geometry, place.drops);
    if (!p) continue;
    believed.push_back(*p);
    actual.push_back(place.above_bed);
  }
  DeltaAccuracy accuracy;
  const auto count = static_cast<double>(believed.size());
  if (believed.empty()) return accuracy;
  // Shift and turn in the plane: the turn that fits best, and the mean of what it leaves.
  double sine = 0.0, cosine = 0.0;
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < believed.size(); ++k) {
    from += believed[k] / count;
    to += actual[k] / count;
  }
  for (std::size_t k = 0; k < believed.size(); ++k) {
    const Eigen::Vector3d b = believed[k] - from, a = actual[k] - to;
    cosine += b.x() * a.x() + b.y() * a.y();
    sine += b.x() * a.y() - b.y() * a.x();
  }
  const Eigen::AngleAxisd turn(std::atan2(sine, cosine), Eigen::Vector3d::UnitZ());
  for (std::size_t k = 0; k < believed.size(); ++k) {
    Eigen::Vector3d left = turn * (believed[k] - from) - (actual[k] - to);
    left.z() = believed[k].z() - actual[k].z();
    const double absolute = (believed[k] - actual[k]).norm(), shape = left.norm();
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

std::optional<Eigen::Vector3d> deviation(const KnownPrinter& known, const DeltaGeometry& geometry,
                                         const JointDrops& drops) {
  const auto believed = nozzle(geometry, drops);
  const ForwardResult taken = forward(build(known.printer.robot, known.errors), known.printer.joints_at(drops));
  if (!believed || !taken.ok()) return std::nullopt;
  return above(known.bed, taken.plate.position) - *believed;
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
