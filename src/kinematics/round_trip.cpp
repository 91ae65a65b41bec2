#include "paracal/kinematics/round_trip.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

Pose random_pose(const Robot& robot, RandomStream& random) {
  const Workspace& workspace = robot.workspace();
  const auto between = [&](double low, double high) { return low + random.uniform() * (high - low); };
  const double share = std::sqrt(random.uniform()), azimuth = between(0.0, 2.0 * std::numbers::pi);
  Pose pose{workspace.at(share, azimuth, workspace.is_flat() ? 0.5 : random.uniform())};
  pose.rotation = between(workspace.min_rotation, workspace.max_rotation);
  for (int k = 0; k < 3; ++k) pose.tilt(k) = between(-workspace.tilt_about(k), workspace.tilt_about(k));
  return pose;
}

std::string in_words(const Robot& robot, const PlateState& plate) {
  const auto numbers = [](const Eigen::Vector3d& v, double factor) {
    const Eigen::Vector3d tidy = (v * factor * 100.0).array().round() / 100.0 + 0.0;
    return fmt::format("({:g}, {:g}, {:g})", tidy.x(), tidy.y(), tidy.z());
  };
  std::string text = numbers(plate.position, 1.0) + " mm";
  if (robot.commands_tilt()) text += fmt::format(" tilted by {} deg", numbers(plate.tilt, to_degrees(1.0)));
  if (robot.slide()) text += fmt::format(" at {:.1f} deg", to_degrees(robot.nominal().rotation_of(plate.slide)));
  return text;
}

/// mm between two plates, by what is commanded; turns count at the joints of the plate.
double apart(const Robot& robot, const PlateState& one, const PlateState& other) {
  const auto& free = robot.freedoms().free;
  const Eigen::Vector3d lever = sizes_of(robot.limbs()).plate_radius *
                                Eigen::Vector3d(free[3] ? 1.0 : 0.0, free[4] ? 1.0 : 0.0, free[5] ? 1.0 : 0.0);
  return std::max({(one.position - other.position).norm(), std::abs(one.slide - other.slide),
                   lever.cwiseProduct(one.tilt - other.tilt).norm()});
}

class RoundTrip {
 public:
  RoundTrip(const Robot& robot, const RoundTripOptions& options) : robot_(robot), options_(options) {}

  void check(const Machine& machine, const Pose& pose, bool is_nominal) const {
    const InverseResult there = inverse(machine, pose);
    if (!there.ok()) return;
    const PlateState wanted = plate_at(machine, pose);
    const ForwardResult back = forward(machine, there.joints);
    const auto is_back = [&](const PlateState& meant) {
      return back.usable() && apart(robot_, back.plate, meant) <= options_.tolerance;
    };
    const bool meets = !is_nominal || back.residual <= options_.tolerance;
    if (meets && (is_back(wanted) || is_back(nearest(machine, there.joints, wanted)))) return;
    refuse(wanted, back, is_nominal);
  }

 private:
  /// Where spare limbs cannot all have their joints, the pose of least squares.
  static PlateState nearest(const Machine& machine, const Joints& joints, const PlateState& wanted) {
    if (machine.spare_limbs() == 0) return wanted;
    return forward(machine, joints, {.start = wanted}).plate;
  }

  [[noreturn]] void refuse(const PlateState& wanted, const ForwardResult& back, bool is_nominal) const {
    const std::string whose =
        is_nominal ? "the nominal machine" : "a machine within the tolerances of this robot (state your [tolerances])";
    std::string instead = fmt::format("no plate was found (largest rod residual {:.3g} mm)", back.residual);
    if (back.usable()) instead = fmt::format("they lead to {}", in_words(robot_, back.plate));
    if (back.usable() && apart(robot_, back.plate, wanted) <= options_.tolerance) {
      instead = fmt::format("the rods miss by {:.3g} mm", back.residual);
    }
    throw InvalidArgument(
        fmt::format("workspace: expected that the joints of each pose lead back to it; for {} at {} {}. Reduce the "
                    "workspace, or correct the dimensions",
                    whose, in_words(robot_, wanted), instead));
  }

  const Robot& robot_;
  const RoundTripOptions& options_;
};

}  // namespace

void check_round_trip(const Robot& robot, const RoundTripOptions& options) {
  const RoundTrip trip(robot, options);
  const Tolerances tolerances = tolerances_of(robot);
  RandomStream places(options.seed, 0), machines(options.seed, 1);
  const double rotation = std::clamp(0.0, robot.workspace().min_rotation, robot.workspace().max_rotation);
  Machine actual = build(robot, draw_errors(robot, tolerances, machines));
  for (int k = 0; k <= options.poses; ++k) {
    const Pose pose = k == 0 ? Pose{robot.workspace().centre(), rotation} : random_pose(robot, places);
    if (k > 0 && k % options.poses_a_machine == 0) actual = build(robot, draw_errors(robot, tolerances, machines));
    trip.check(robot.nominal(), pose, true);
    trip.check(actual, pose, false);
  }
}

}  // namespace paracal
