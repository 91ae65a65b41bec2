#include "singularity.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "numerics/dense.hpp"
#include "numerics/small.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/closure_limb.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// Below this share of the largest singular value rods do not hold a plate, turns counted at its radius. A drive must
/// move the end of its rod along the rod by more than this share of its motion.
constexpr double kHeld = 1e-3;

/// A row a rod, or a limb that is a parallelogram, a column a motion of the plate that is free.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 2 * kMaxLimbs, 6>;
/// A vector a limb.
using Vectors = std::array<Eigen::Vector3d, kMaxLimbs>;

using Plate = closure::TurnedPlate<double>;

Plate plate_of(const Pose& pose) { return closure::commanded_plate(closure_pose(pose)); }

/// Joints of the plate in {O}.
Vectors joints_at(const Machine& machine, const Pose& pose, const Plate& plate) {
  Vectors joints;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    joints[i] = pose.position + as_eigen(plate.turned(closure::plate_joint<double>(machine.limbs[i], pose.rotation)));
  }
  return joints;
}

/// Square of the motion of the elbow along the rod per motion of the elbow. Unlike the joint it goes on beyond reach,
/// where it is negative. A strut is moved by its drive everywhere.
double reach_of(const Limb& limb, const Eigen::Vector3d& joint) {
  if (limb.is_strut()) return 1.0;
  const Eigen::Vector3d d = limb.frame().transpose() * (joint - as_eigen(limb.base));
  const double rod = limb.mean_rod(), arm = limb.arm;
  if (runs_on_rail(limb.actuator)) return 1.0 - (std::pow(d.x() + arm, 2) + d.z() * d.z()) / (rod * rod);
  const double K = d.squaredNorm() + arm * arm - rod * rod;  // as of ArmDrive::close()
  return (4.0 * arm * arm * d.head<2>().squaredNorm() - K * K) / std::pow(2.0 * arm * rod, 2);
}

/// Of the two positions of an arm that reach a joint the nearer to where it points at zero is meant: it passes from one
/// to the other in a jump where this changes sign.
double side_of(const Limb& limb, const Eigen::Vector3d& joint) {
  return swings_arm(limb.actuator)
             ? (joint - as_eigen(limb.base)).dot(as_eigen(limb.normal)) / (limb.arm + limb.mean_rod())
             : 1.0;
}

/// Unit vectors along the rods, towards the plate.
Vectors rods_towards(const Machine& machine, const Vectors& joints) {
  Vectors rods;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const auto elbow = ends_at<1>(limb, joint_to(limb, joints[i])).elbow;
    rods[i] = (joints[i] - as_eigen(elbow.centre)).normalized();
  }
  return rods;
}

/// How the limbs hold position and slide of a level plate: n, mu n.shat.
Rows hold_level(const Machine& machine, const Vectors& rods) {
  const auto limbs = static_cast<Eigen::Index>(machine.limb_count);
  Rows rows(limbs, limbs);
  for (Eigen::Index i = 0; i < limbs; ++i) {
    const Eigen::Vector3d& n = rods[static_cast<std::size_t>(i)];
    rows.row(i).head<3>() = n;
    if (machine.has_slide())
      rows(i, 3) = machine.limbs[static_cast<std::size_t>(i)].slide_sign * n.dot(machine.slide_axis);
  }
  return rows;
}

/// How rods along n hold what guides leave free to any other plate: n, axes^T (R a x n) / radius of the plate.
Rows hold(const Machine& machine, const Plate& plate, const Vectors& rods, double radius) {
  if (machine.is_level) return hold_level(machine, rods);
  std::vector<Eigen::Matrix<double, 1, 6>> all;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const auto ends = closure::lower_ends<2, double>(limb, 0.0);
    for (std::size_t j = 0; j < limb.actuator.rods; ++j) {
      const ClosureVector<double> lever = plate.turned(ends[j]);
      const Eigen::RowVector3d moment = as_eigen(lever).cross(rods[i]) / radius;
      all.emplace_back();
      all.back() << rods[i].transpose(), moment * as_eigen(plate.axes[0]), moment * as_eigen(plate.axes[1]),
          moment * as_eigen(plate.axes[2]);
    }
  }
  const auto is_free = [&](std::size_t k) { return !machine.has_guides || machine.freedoms.free[k]; };
  Rows rows(static_cast<Eigen::Index>(all.size()), 0);
  for (std::size_t k = 0; k < 6; ++k) {
    if (!is_free(k)) continue;
    rows.conservativeResize(Eigen::NoChange, rows.cols() + 1);
    for (std::size_t i = 0; i < all.size(); ++i) {
      rows(static_cast<Eigen::Index>(i), rows.cols() - 1) = all[i](static_cast<Eigen::Index>(k));
    }
  }
  return rows;
}

/// How parallelograms keep the plate level: w_0 x n, the moment of their two rods.
Rows level_hold(const Machine& machine, const Vectors& rods) {
  Rows rows(static_cast<Eigen::Index>(machine.limb_count), 3);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const auto limb = static_cast<std::size_t>(i);
    rows.row(i) = as_eigen(machine.limbs[limb].axis).cross(rods[limb]);
  }
  return rows;
}

/// Volume that the rows span over that of rows as long at right angles: 1 at best, 0 where they do not hold; with a
/// sign where they are as many as columns.
double volume(const Rows& rows) {
  const auto n = static_cast<double>(rows.cols());
  const double best = std::pow(rows.squaredNorm() / n, 0.5 * n);
  if (rows.rows() == rows.cols()) return small_determinant(rows) / best;
  const Rows products = rows.transpose().lazyProduct(rows);
  return std::sqrt(std::max(small_determinant(products), 0.0)) / best;
}

double smallest_share(const Rows& rows) {
  const Eigen::VectorXd values = singular_values(rows).values;
  return values(values.size() - 1) / values(0);
}

/// "with an arm of 375 mm it needs a rod of 400.0 to 1100.0 mm there": what would reach from the base joint along d.
std::string rod_needed(const Limb& limb, const Eigen::Vector3d& d) {
  const Eigen::Vector3d local = limb.frame().transpose() * d;
  if (runs_on_rail(limb.actuator)) {
    return fmt::format("its rail needs a rod of at least {:.1f} mm there", std::hypot(local.x() + limb.arm, local.z()));
  }
  const double in_plane = std::hypot(local.x(), local.y());
  return fmt::format("with an arm of {:g} mm it needs a rod of {:.1f} to {:.1f} mm there", limb.arm,
                     std::hypot(in_plane - limb.arm, local.z()), std::hypot(in_plane + limb.arm, local.z()));
}

/// "(1, 2, 3)", to hundredths.
std::string hundredths(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d tidy = (vector * 100.0).array().round() / 100.0 + 0.0;
  return fmt::format("({:g}, {:g}, {:g})", tidy.x(), tidy.y(), tidy.z());
}

/// "(1, 2, 3) mm tilted by (0, 4, 0) deg", or "(1, 2, 3) mm at 90 deg": as far as the plate can.
std::string standing(const Machine& machine, const Pose& pose) {
  std::string place = hundredths(pose.position) + " mm";
  if (machine.commands_tilt()) place += fmt::format(" tilted by {} deg", hundredths(pose.tilt.unaryExpr(&to_degrees)));
  if (machine.has_slide()) place += fmt::format(" at {:.0f} deg", to_degrees(pose.rotation));
  return place;
}

/// How far a pose is from each way to be refused, without units: the reach and the side of its arms, how rods hold the
/// plate, and how they keep it level.
using Margins = std::array<double, 4>;

class Closures {
 public:
  Closures(const Machine& machine, double radius, const Pose& centre) : machine_(machine), radius_(radius) {
    const Plate plate = plate_of(centre);
    const Vectors joints = joints_at(machine, centre, plate);
    for (std::size_t i = 0; i < machine.limb_count; ++i) require_reach(centre, i, joints[i]);
    const Vectors rods = rods_towards(machine, joints);
    for (std::size_t i = 0; i < machine.limb_count; ++i) sides_[i] = side_of(machine.limbs[i], joints[i]);
    hold_ = volume(hold(machine, plate, rods, radius));
    if (machine.is_level) level_ = volume(level_hold(machine, rods));
  }

  /// @throws InvalidArgument at a pose that is to be refused.
  Margins checked(const Pose& pose) const {
    Margins margins{1.0, 1.0, 1.0, 1.0};
    const Plate plate = plate_of(pose);
    const Vectors joints = joints_at(machine_, pose, plate);
    for (std::size_t i = 0; i < machine_.limb_count; ++i) {
      margins[0] = std::min(margins[0], require_reach(pose, i, joints[i]));
      margins[1] = std::min(margins[1], require_side(pose, i, joints[i]));
    }
    const Vectors rods = rods_towards(machine_, joints);
    margins[2] = require_hold(pose, hold(machine_, plate, rods, radius_), hold_, "move");
    if (machine_.is_level) margins[3] = require_hold(pose, level_hold(machine_, rods), level_, "tilt");
    return margins;
  }

 private:
  double require_reach(const Pose& pose, std::size_t i, const Eigen::Vector3d& joint) const {
    const Limb& limb = machine_.limbs[i];
    const double reach = reach_of(limb, joint);
    if (reach > kHeld * kHeld) return reach;
    if (reach > 0.0) {
      throw InvalidArgument(
          fmt::format("workspace: singular at {}: the rod of limb {} is {}, so that its drive could not move the plate",
                      standing(machine_, pose), i + 1,
                      runs_on_rail(limb.actuator) ? "square to its rail" : "in line with its arm"));
    }
    throw InvalidArgument(fmt::format("workspace: limb {} cannot reach {}: {}, its rod_mm is {:g}", i + 1,
                                      standing(machine_, pose), rod_needed(limb, joint - as_eigen(limb.base)),
                                      limb.mean_rod()));
  }

  double require_side(const Pose& pose, std::size_t i, const Eigen::Vector3d& joint) const {
    const Limb& limb = machine_.limbs[i];
    const double side = std::copysign(1.0, sides_[i]) * side_of(limb, joint);
    if (side > 0.0) return side;
    throw InvalidArgument(fmt::format(
        "{} limb {} that selects one of the two arm positions everywhere; between the centre of the workspace and {} "
        "both are equally near to it, and the arm would jump",
        limb.has_one_rod() ? "limb: expected an arm_at_zero of" : "workspace: expected a base joint of", i + 1,
        standing(machine_, pose)));
  }

  double require_hold(const Pose& pose, const Rows& rows, double at_centre, std::string_view could) const {
    const double held = std::copysign(1.0, at_centre) * volume(rows);  // no sign where rods are more than motions
    // Where the smallest singular value is a share s of the largest, the volume is at most 1.2 s.
    const bool near = std::abs(held) <= 1.2 * kHeld;
    if (const double share = near ? smallest_share(rows) : 1.0; !(share > kHeld)) {
      throw InvalidArgument(
          fmt::format("workspace: singular at {}: the plate could {} although no rod changes its length (smallest "
                      "singular value {:.1g} of the largest)",
                      standing(machine_, pose), could, share));
    }
    if (held > 0.0) return held;
    throw InvalidArgument(fmt::format(
        "workspace: singular between its centre and {}: there the plate could {} although no rod changes its length",
        standing(machine_, pose), could));
  }

  const Machine& machine_;
  double radius_;
  std::array<double, kMaxLimbs> sides_{};
  double hold_ = 1.0, level_ = 1.0;
};

/// x and y over the radius, z, rotation and the three tilts over half their ranges.
using Place = std::array<double, 7>;

/// A workspace as a cube, and those of its coordinates that have a range.
class Cube {
 public:
  explicit Cube(const Workspace& workspace) : workspace_(workspace) {
    const std::array<double, 7> ranges{1.0,
                                       1.0,
                                       workspace.height,
                                       workspace.max_rotation - workspace.min_rotation,
                                       workspace.tilt_about(0),
                                       workspace.tilt_about(1),
                                       workspace.tilt_about(2)};
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      if (ranges[k] > 0.0) axes_.push_back(k);
    }
    const double power = 1.0 / (static_cast<double>(axes_.size()) + 1.0);
    for (int step = 0; step < 40; ++step) root_ = std::pow(1.0 + root_, power);
  }

  const std::vector<std::size_t>& axes() const { return axes_; }

  static Place clamped(Place place) {
    for (double& one : place) one = std::clamp(one, -1.0, 1.0);
    const double radius = std::max(std::hypot(place[0], place[1]), 1.0);
    place[0] /= radius;
    place[1] /= radius;
    return place;
  }

  Pose pose(const Place& place) const {
    const Workspace& all = workspace_;
    const auto between = [](double low, double high, double x) { return 0.5 * (low + high + x * (high - low)); };
    const double share = std::hypot(place[0], place[1]), azimuth = std::atan2(place[1], place[0]);
    return {all.at(share, azimuth, 0.5 * (1.0 - place[2])),
            between(all.min_rotation, all.max_rotation, place[3]),
            {all.tilt_about(0) * place[4], all.tilt_about(1) * place[5], all.tilt_about(2) * place[6]}};
  }

  /// Place number k of a sequence that fills the cube evenly: coordinate j is the fraction of k / root^j. It is
  /// stretched by a quarter and cut off, so that it also fills surface, edges and corners, where extremes mostly are.
  Place spread(std::size_t k) const {
    constexpr double kStretch = 1.25;
    Place share{}, place{};
    double factor = 1.0;
    for (const std::size_t axis : axes_) {
      factor /= root_;
      const double sum = 0.5 + factor * static_cast<double>(k + 1);
      share[axis] = sum - std::floor(sum);
      place[axis] = kStretch * (2.0 * share[axis] - 1.0);
    }
    const double azimuth = 2.0 * std::numbers::pi * share[1];
    place[0] = kStretch * std::sqrt(share[0]) * std::cos(azimuth);
    place[1] = kStretch * std::sqrt(share[0]) * std::sin(azimuth);
    return clamped(place);
  }

 private:
  const Workspace& workspace_;
  std::vector<std::size_t> axes_;
  double root_ = 2.0;  ///< of x^(d + 1) = x + 1 with d axes
};

struct Lowest {
  double margin = 2.0;   // more than any
  double largest = 0.0;  // beside it
  Place place{};
};

/// Goes down a margin, along one coordinate after the other, in steps that become shorter where they gain little.
void descend(const Cube& cube, const Closures& closures, std::size_t which, Lowest from) {
  constexpr int kPasses = 40;
  constexpr double kFirstStep = 0.1, kLastStep = 0.004, kGain = 0.99;
  double step = kFirstStep;
  for (int pass = 0; pass < kPasses && step > kLastStep; ++pass) {
    const double before = from.margin;
    for (const std::size_t axis : cube.axes()) {
      for (const double way : {step, -step}) {
        Place tried = from.place;
        tried[axis] += way;
        tried = Cube::clamped(tried);
        const double margin = closures.checked(cube.pose(tried))[which];
        if (margin < from.margin) from = {.margin = margin, .place = tried};
      }
    }
    if (!(from.margin < kGain * before)) step *= 0.5;
  }
}

}  // namespace

void check_closure(const Machine& machine, const RobotDescription& robot) {
  constexpr std::size_t kFew = 64, kBlock = 640, kBlocks = 3;
  constexpr double kSteady = 0.8;  // of its largest value: a margin that varies so little is far from 0 everywhere
  const Workspace& workspace = robot.workspace;
  const Pose centre{workspace.centre(), std::clamp(0.0, workspace.min_rotation, workspace.max_rotation)};
  const Closures closures(machine, 0.5 * sizes_of(robot.limbs).parallelogram_width, centre);
  (void)closures.checked(centre);
  for (const Pose& pose : workspace.rim(8)) (void)closures.checked(pose);  // round numbers for what is seen there
  const Cube cube(workspace);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    std::array<Lowest, std::tuple_size_v<Margins>> lowest;
    for (std::size_t k = block * kBlock; k < (block + 1) * kBlock; ++k) {
      const Place place = cube.spread(k);
      const Margins margins = closures.checked(cube.pose(place));
      for (std::size_t which = 0; which < margins.size(); ++which) {
        Lowest& one = lowest[which];
        one.largest = std::max(one.largest, margins[which]);
        if (margins[which] < one.margin) one = {margins[which], one.largest, place};
      }
      const auto is_steady = [](const Lowest& one) { return one.margin > kSteady * one.largest; };
      if (k + 1 == kFew && std::ranges::all_of(lowest, is_steady)) return;
    }
    for (std::size_t which = 0; which < lowest.size(); ++which) {
      if (lowest[which].margin < lowest[which].largest) descend(cube, closures, which, lowest[which]);
    }
  }
}

}  // namespace paracal::detail
