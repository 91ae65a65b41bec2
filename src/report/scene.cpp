#include "paracal/report/scene.hpp"

#include <algorithm>
#include <map>

#include "figures.hpp"
#include "paracal/kinematics/drive.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"

namespace paracal::report {
namespace {

using detail::rounded;

constexpr std::size_t kMostPoses = 2000, kMostWithLimbs = 250;

struct Mean {
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = Eigen::Vector3d::Zero();
  int count = 0;
};

io::Json limbs_json(const Machine& machine, const Pose& pose, const Joints& joints) {
  io::Json limbs = io::Json::array();
  const Eigen::Matrix3d turn = plate_rotation(pose.tilt).matrix;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const auto upper = ends_at(limb, joints(static_cast<Eigen::Index>(i)));
    const auto lower = closure::lower_ends<2, double>(limb, pose.rotation);
    io::Json rods = io::Json::array();
    for (std::size_t j = 0; j < limb.actuator.rods; ++j) {
      const Eigen::Vector3d end = pose.position + turn * as_eigen(lower[j]);
      rods.push_back({rounded(as_eigen(upper.place[j])), rounded(end)});
    }
    const bool swings = swings_arm(limb.actuator);
    if (limb.has_one_rod() && !swings) {  // from the base, or from the carriage
      limbs.push_back({{"base_mm", rounded(as_eigen(upper.elbow.centre))}, {"rods_mm", std::move(rods)}});
      continue;
    }
    // A rail's arm begins where its carriage stands.
    const Eigen::Vector3d middle = as_eigen(upper.elbow.centre);
    const Eigen::Vector3d base =
        swings ? Eigen::Vector3d(as_eigen(limb.base)) : Eigen::Vector3d(middle + limb.arm * as_eigen(upper.elbow.u1));
    limbs.push_back({{"base_mm", rounded(base)}, {"elbow_mm", rounded(middle)}, {"rods_mm", std::move(rods)}});
  }
  return limbs;
}

io::Json pose_json(const Machine& machine, const ErrorArrow& arrow, const std::optional<PlateState>& plate) {
  io::Json json{{"pose", arrow.pose},
                {"position_mm", rounded(arrow.commanded.position)},
                {"rotation_deg", rounded(to_degrees(arrow.commanded.rotation))},
                {"before_mm", rounded(arrow.before)},
                {"after_mm", nullptr},
                {"tilt_rad", nullptr}};
  if (arrow.after) json["after_mm"] = rounded(*arrow.after);
  if (plate) {
    const Eigen::Vector3d turned = turned_away(machine, arrow.commanded, *plate);
    json["tilt_rad"] = {rounded(turned.x()), rounded(turned.y())};
  }
  if (machine.commands_tilt()) {
    json["tilt_deg"] = rounded(Eigen::Vector3d(arrow.commanded.tilt.unaryExpr(&to_degrees)));
    json["normal"] = rounded(Eigen::Vector3d(plate_rotation(arrow.commanded.tilt).matrix.col(2)));
  }
  return json;
}

}  // namespace

std::vector<ErrorArrow> measured_arrows(const Calibration& calibration, const Measurements& measurements) {
  std::map<std::string, Mean> means;
  for (const PointResidual& residual : calibration.points) {
    if (residual.excluded) continue;
    Mean& mean = means[residual.station];
    mean.before += residual.before;
    mean.after += residual.after;
    ++mean.count;
  }
  std::vector<ErrorArrow> arrows;
  for (const Station& station : measurements.stations) {
    const auto mean = means.find(station.name);
    if (mean == means.end()) continue;
    const auto& [before, after, count] = mean->second;
    arrows.push_back({station.name, station.commanded, before / count, Eigen::Vector3d(after / count)});
  }
  return arrows;
}

std::vector<ErrorArrow> measured_arrows(const Validation& validation) {
  std::vector<ErrorArrow> arrows;
  arrows.reserve(validation.poses.size());
  for (const ValidatedPose& one : validation.poses) {
    arrows.push_back({one.pose, one.before.meant, one.before.actual.position - one.before.meant.position,
                      Eigen::Vector3d(one.after.actual.position - one.after.meant.position)});
  }
  return arrows;
}

std::vector<ErrorArrow> predicted_arrows(const Robot& robot, const SourceErrors& errors,
                                         const std::vector<Station>& stations) {
  const Machine machine = build(robot, errors);
  std::vector<ErrorArrow> arrows;
  for (const Station& station : stations) {
    const std::optional<PlateState> plate = drive(machine, robot.nominal(), station.commanded);
    if (!plate) continue;
    arrows.push_back({station.name, station.commanded, plate->position - station.commanded.position});
  }
  return arrows;
}

io::Json scene(const Robot& robot, const std::vector<ErrorArrow>& arrows, const SourceErrors& errors) {
  const Machine machine = build(robot, errors);
  io::Json poses = io::Json::array();
  for (std::size_t k = 0; k < std::min(arrows.size(), kMostPoses); ++k) {
    const Pose& commanded = arrows[k].commanded;
    poses.push_back(pose_json(machine, arrows[k], drive(machine, robot.nominal(), commanded)));
    const InverseResult joints = inverse(robot.nominal(), commanded);
    if (k < kMostWithLimbs && joints.ok()) {
      poses.back()["limbs"] = limbs_json(robot.nominal(), commanded, joints.joints);
    }
  }
  const bool measured = std::ranges::any_of(arrows, [](const ErrorArrow& one) { return one.after.has_value(); });
  return {{"measured", measured}, {"poses", std::move(poses)}};
}

}  // namespace paracal::report
