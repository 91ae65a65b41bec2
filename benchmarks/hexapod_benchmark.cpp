// Time and heap allocations of a hexapod's kinematics at a pose: the inverse compared with a lower bound, and the
// forward kinematics along a path, from the previous pose, compared with LinuxCNC's genhexkins.
//
// Candidates run in turn in many short rounds, for the reasons in kinematics_benchmark.cpp. It only reports: the exit
// status is always 0.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "comparison.hpp"
#include "host.hpp"
#include "interleaved_timing.hpp"
#include "linuxcnc_hal.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/allocation_count.hpp"
#include "task.hpp"

namespace {

using namespace paracal;
using namespace paracal::benchmark;

constexpr std::size_t kPoses = 1000;
constexpr int kRounds = 200;

/// Once around the workspace, rising and tilting: 1000 cycles of a controller, half a millimetre each.
std::vector<Pose> path_in(const Workspace& workspace) {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < kPoses; ++k) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(k) / kPoses;
    poses.push_back({workspace.at(0.9, turn, 0.5 - 0.4 * std::sin(2.0 * turn)), 0.0,
                     0.9 * workspace.max_tilt * Eigen::Vector3d(std::sin(turn), std::cos(turn), std::sin(3.0 * turn))});
  }
  return poses;
}

/// What the closed-form inverse cannot avoid: sine and cosine of three angles, the matrix, its products with six joints
/// of the plate, and six square roots; in scalars, in the order of the formula.
double floor_of(const Machine& machine, const Pose& pose) {
  const double ca = std::cos(pose.tilt.x()), sa = std::sin(pose.tilt.x()), cb = std::cos(pose.tilt.y()),
               sb = std::sin(pose.tilt.y()), cg = std::cos(pose.tilt.z()), sg = std::sin(pose.tilt.z());
  const double x0 = cb * cg, x1 = ca * sg + sa * sb * cg, x2 = sa * sg - ca * sb * cg;
  const double y0 = -cb * sg, y1 = ca * cg - sa * sb * sg, y2 = sa * cg + ca * sb * sg;
  const double z1 = -sa * cb, z2 = ca * cb;
  double sum = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    const Limb& limb = machine.limbs[i];
    const double ax = limb.plate.x(), ay = limb.plate.y(), az = limb.plate.z();
    const double dx = pose.position.x() - limb.base.x() + x0 * ax + y0 * ay + sb * az;
    const double dy = pose.position.y() - limb.base.y() + x1 * ax + y1 * ay + z1 * az;
    const double dz = pose.position.z() - limb.base.z() + x2 * ax + y2 * ay + z2 * az;
    sum += std::sqrt(dx * dx + dy * dy + dz * dz);
  }
  return sum;
}

/// The nominal machine in the numbers of genhexkins, whose joints are whole lengths and whose turns are Rot(z, C)
/// Rot(y, B) Rot(x, A).
class Genhexkins {
 public:
  Genhexkins(const Machine& machine, const LinuxcncBuild& build)
      : module_(KinematicsModule::load(build, "genhexkins")) {
    if (!module_.loaded()) return;
    for (std::size_t i = 0; i < 6; ++i) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        set(fmt::format("genhexkins.base.{}.{}", i, "xyz"[axis]), machine.limbs[i].base(axis));
        set(fmt::format("genhexkins.platform.{}.{}", i, "xyz"[axis]), machine.limbs[i].plate(axis));
      }
    }
    set("genhexkins.convergence-criterion", 1e-9);
    set("genhexkins.max-error", 500.0);
    complete_ = KinematicsModule::set("genhexkins.limit-iterations", 120U) && complete_;
    EmcPose first;
    const std::array<double, 16> joints{1, 1, 1, 1, 1, 1};
    (void)forward(joints, first);  // the first call forgets its start
  }

  bool loaded() const { return module_.loaded() && complete_; }

  int forward(const std::array<double, 16>& joints, EmcPose& pose) const {
    unsigned long flags = 0;
    return module_.forward(joints.data(), &pose, &flags, &flags);
  }

  void inverse(const EmcPose& pose, std::array<double, 16>& joints) const {
    unsigned long flags = 0;
    module_.inverse(&pose, joints.data(), &flags, &flags);
  }

  static EmcPose pose_of(const Pose& pose) {
    const auto turn = [&](int axis) { return Eigen::AngleAxisd(pose.tilt(axis), Eigen::Vector3d::Unit(axis)); };
    const Eigen::Matrix3d R = (turn(0) * turn(1) * turn(2)).toRotationMatrix();
    return {.x = pose.position.x(),
            .y = pose.position.y(),
            .z = pose.position.z(),
            .a = to_degrees(std::atan2(R(2, 1), R(2, 2))),
            .b = to_degrees(std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)))),
            .c = to_degrees(std::atan2(R(1, 0), R(0, 0)))};
  }

 private:
  void set(const std::string& pin, double value) { complete_ = KinematicsModule::set(pin, value) && complete_; }

  KinematicsModule module_;
  bool complete_ = true;
};

enum : std::size_t { kFloor, kInverse, kInverseWithErrors, kForward };

struct Candidate {
  std::string name;
  Pass pass;
  std::size_t baseline = 0;
};

double allocations_per_pose(const Candidate& candidate) {
  const std::size_t before = test::allocation_count();
  candidate.pass();
  return static_cast<double>(test::allocation_count() - before) / static_cast<double>(kPoses);
}

std::vector<std::vector<double>> print(const std::vector<Candidate>& candidates) {
  std::vector<Pass> passes;
  for (const Candidate& candidate : candidates) passes.push_back(candidate.pass);
  const std::vector<std::vector<double>> seconds = interleave(passes, kRounds);
  const double to_ns = 1e9 / static_cast<double>(kPoses);
  fmt::print("{:<38}{:>8}{:>8}{:>8}  {:>6}\n", "", "median", "p99", "heap", "ratio");
  fmt::print("{:<38}{:>8}{:>8}{:>8}\n", "", "ns", "ns", "blocks");
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const auto& [name, pass, baseline] = candidates[k];
    const Spread time = spread_of(seconds[k]);
    const std::string ratio = baseline == k ? ""
                                            : fmt::format("{:6.2f} {}", median_ratio(seconds[k], seconds[baseline]),
                                                          candidates[baseline].name);
    fmt::print("{:<38}{:>8.0f}{:>8.0f}{:>8g}  {}\n", name, time.median * to_ns, time.p99 * to_ns,
               allocations_per_pose(candidates[k]), ratio);
  }
  return seconds;
}

/// Largest difference of two ways along the path, mm; the opponent's turns are of another convention.
double difference(const Genhexkins& opponent, const std::vector<EmcPose>& poses,
                  const std::vector<std::array<double, 16>>& lengths) {
  double largest = 0.0;
  EmcPose at = poses.back();
  for (std::size_t k = 0; k < kPoses; ++k) {
    if (opponent.forward(lengths[k], at) != 0) return std::nan("");
    largest = std::max({largest, std::abs(at.x - poses[k].x), std::abs(at.y - poses[k].y), std::abs(at.z - poses[k].z),
                        std::abs(at.a - poses[k].a), std::abs(at.b - poses[k].b), std::abs(at.c - poses[k].c)});
  }
  return largest;
}

void report(const Robot& robot) {
  const Machine& nominal = robot.nominal();
  const Machine machine = make_task(robot, 10).machine;
  const std::vector<Pose> poses = path_in(robot.workspace());
  std::vector<Joints> joints, with_errors;
  std::vector<std::array<double, 16>> lengths(kPoses);
  std::vector<EmcPose> emc;
  for (std::size_t k = 0; k < kPoses; ++k) {
    joints.push_back(inverse(nominal, poses[k]).joints);
    with_errors.push_back(inverse(machine, poses[k]).joints);
    emc.push_back(Genhexkins::pose_of(poses[k]));
    for (std::size_t i = 0; i < 6; ++i) {
      lengths[k].at(i) = rods_at(nominal.limbs[i], joints[k](static_cast<Eigen::Index>(i)))[0];
    }
  }
  const auto along = [&](const Machine& of, const std::vector<Joints>& told) {
    return [&] {
      PlateState at = plate_at(of, poses.back());
      for (const Joints& one : told) {
        at = forward(of, one, {.start = at}).plate;
        keep(at);
      }
    };
  };
  double largest = 0.0;
  int iterations = 0;
  PlateState at = plate_at(nominal, poses.back());
  for (std::size_t k = 0; k < kPoses; ++k) {
    const ForwardResult found = forward(nominal, joints[k], {.start = at});
    at = found.plate;
    iterations += found.iterations;
    largest = std::max({largest, (at.position - poses[k].position).norm(), (at.tilt - poses[k].tilt).norm()});
  }
  std::vector<Candidate> candidates{
      {"floor",
       [&] {
         for (const Pose& pose : poses) keep(floor_of(nominal, pose));
       },
       kFloor},
      {"inverse, nominal",
       [&] {
         for (const Pose& pose : poses) keep(inverse(nominal, pose));
       },
       0},
      {"inverse, 8 errors per strut",
       [&] {
         for (const Pose& pose : poses) keep(inverse(machine, pose));
       },
       0},
      {"forward from the last pose, nominal", along(nominal, joints), kForward},
      {"forward from the last pose, 8 errors", along(machine, with_errors), kForward},
  };
  fmt::print("\n{}: a path of {} poses, {} rounds; {:.2f} iterations per pose, largest difference {:.1g} mm and rad\n",
             robot.name(), kPoses, kRounds, iterations / static_cast<double>(kPoses), largest);
  std::vector<std::pair<std::string, Genhexkins>> opponents;
  for (const LinuxcncBuild& build : linuxcnc_builds()) {
    const std::string title = "LinuxCNC genhexkins " + build.title;
    const Genhexkins opponent(nominal, build);
    if (opponent.loaded()) {
      opponents.emplace_back(title, opponent);
      fmt::print("{}: largest difference {:.1g} mm and deg\n", title, difference(opponent, emc, lengths));
    } else {
      fmt::print("{} is not installed\n", title);
      not_installed("kinematics of a hexapod", title, "linuxcnc-uspace-dev");
    }
  }
  const std::size_t first = candidates.size();
  for (const auto& [title, opponent] : opponents) {
    candidates.push_back({title + ", forward",
                          [&] {
                            EmcPose last = emc.back();
                            for (const auto& one : lengths) keep(opponent.forward(one, last));
                          },
                          kForward});
    candidates.push_back({title + ", inverse",
                          [&] {
                            std::array<double, 16> found{};
                            for (const EmcPose& pose : emc) {
                              opponent.inverse(pose, found);
                              keep(found);
                            }
                          },
                          kInverse});
  }
  const std::vector<std::vector<double>> seconds = print(candidates);
  for (std::size_t k = 0; k < opponents.size(); ++k) {
    const auto against = [&](const char* task, std::size_t ours, std::size_t theirs, const char* note) {
      compare({.task = task, .opponent = opponents[k].first, .unit = "ns per pose", .note = note},
              {seconds[ours], kPoses}, {seconds[theirs], kPoses});
    };
    against("forward kinematics of a hexapod along a path", kForward, first + 2 * k,
            "genhexkins needs one more iteration for its display pins");
    against("inverse kinematics of a hexapod", kInverse, first + 2 * k + 1, "");
  }
}

}  // namespace

int main() {
  fmt::print("{}", host_description());
  report(io::read_robot(io::robot_template("hexapod")));
  fmt::print("genhexkins: a forward call needs one more iteration for its display pins\n");
}
