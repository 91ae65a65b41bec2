#include "struts.hpp"

#include <numbers>

#include "named_constants.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal::compensation_detail {
namespace {

using Values = std::vector<Expression>;

struct StrutMotion {
  Expression joint;
  Values by_pose;  ///< its derivative, x, y, z, tilt_x, tilt_y, tilt_z
};

/// dR p = axis x R p d(tilt), about the axes that the angles turn; as plate_rotation() has it.
std::array<Vector<Expression>, 3> tilt_axes(const ArmDirection<Expression>& a, const PlateColumns<Expression>& plate) {
  const Expression zero(0.0);
  return {Vector<Expression>{Expression(1.0), zero, zero}, {zero, a.cosine, a.sine}, plate.z};
}

std::vector<StrutMotion> motions(const std::array<StrutConstants, kStruts>& struts) {
  const auto turn = [](std::size_t axis) {
    const Expression angle = input("pose", 3 + axis);
    return ArmDirection<Expression>{cos(angle), sin(angle)};
  };
  const ArmDirection<Expression> about_x = turn(0);
  const PlateFrame<Expression> plate{plate_columns(about_x, turn(1), turn(2))};
  const Vector<Expression> position{input("pose", 0), input("pose", 1), input("pose", 2)};
  const std::array<Vector<Expression>, 3> axes = tilt_axes(about_x, plate);
  std::vector<StrutMotion> all;
  for (std::size_t i = 0; i < kStruts; ++i) {
    const NamedConstants constants(i);
    const Vector<Expression> lever = plate.turned(constants.named("plate", struts[i].plate));
    const Vector<Expression> rod = sum(sum(position, lever), constants.named("base", struts[i].base), Expression(-1.0));
    const Expression length = sqrt(dot(rod, rod)), growth = constants.named("growth", struts[i].growth);
    StrutMotion motion{(length - constants.named("length", struts[i].length)) / growth, {}};
    const Vector<Expression> along = scaled(rod, Expression(1.0) / (length * growth));
    motion.by_pose.assign(along.begin(), along.end());
    const Vector<Expression> moment = cross(lever, along);
    for (const Vector<Expression>& axis : axes) motion.by_pose.push_back(dot(axis, moment));
    all.push_back(std::move(motion));
  }
  return all;
}

}  // namespace

std::array<StrutConstants, kStruts> strut_constants(const Machine& machine) {
  std::array<StrutConstants, kStruts> constants;
  for (std::size_t i = 0; i < kStruts; ++i) {
    const Limb& limb = machine.limbs[i];
    constants[i] = {.base = {limb.base.x(), limb.base.y(), limb.base.z()},
                    .plate = {limb.plate.x(), limb.plate.y(), limb.plate.z()},
                    .length = rods_at(limb, 0.0)[0],
                    .growth = limb.gain};
  }
  return constants;
}

RecordedStruts record(const std::array<StrutConstants, kStruts>& struts) {
  Values joints, rows;
  for (const StrutMotion& motion : motions(struts)) {
    joints.push_back(motion.joint);
    rows.insert(rows.end(), motion.by_pose.begin(), motion.by_pose.end());
  }
  return {.joints = Procedure({{"joints", joints}}), .rows = Procedure({{"joints", joints}, {"rows", rows}})};
}

std::vector<SelfTestCase> strut_self_test(const Robot& robot, const Machine& machine) {
  const Workspace& workspace = robot.workspace();
  const std::vector<Eigen::Vector3d> tilts = workspace.tilts();
  std::vector<Pose> poses{{workspace.centre()}};
  for (std::size_t k = 0; k < tilts.size(); ++k) {
    const double azimuth = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(tilts.size());
    const double z = workspace.top_z - (k % 2 == 0 ? 0.0 : workspace.height);
    poses.push_back({Workspace::on_circle(workspace.radius, azimuth, z), 0.0, tilts[k]});
  }
  std::vector<SelfTestCase> cases;
  for (const Pose& pose : poses) {
    const InverseResult found = inverse(machine, pose);
    if (!found.ok()) throw Unreachable("the calibrated machine does not reach all of its workspace");
    cases.push_back({pose, found.joints});
  }
  return cases;
}

}  // namespace paracal::compensation_detail
