// An independent mechanism program: a free plate and six rods of the lengths that the motors hold, closed by Simbody's
// assembler.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "simbody_assembly.hpp"
#include "support/robots.hpp"

namespace paracal {
namespace {

constexpr double kMetre = 1000.0;  // mm: Simbody's tolerances are those of metres

std::array<double, 3> in_metres(const Eigen::Vector3d& mm) {
  return {mm.x() / kMetre, mm.y() / kMetre, mm.z() / kMetre};
}

/// @param near  where the assembler begins.
Eigen::Isometry3d assembled(const Machine& machine, const Joints& joints, const Eigen::Isometry3d& near) {
  std::array<test::AssembledRod, 6> rods{};
  for (std::size_t i = 0; i < rods.size(); ++i) {
    const Limb& limb = machine.limbs[i];
    const double length = limb.rod[0] + limb.joint_offset + limb.gain * joints(static_cast<Eigen::Index>(i));
    rods[i] = {in_metres(limb.base), in_metres(limb.plate), length / kMetre};
  }
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  test::AssembledPlate start{.rotation = {}, .position = in_metres(near.translation())};
  Eigen::Map<Rows>(start.rotation.data()) = near.linear();
  const test::AssembledPlate found = test::assemble(rods, start);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Map<const Rows>(found.rotation.data());
  pose.translation() = kMetre * Eigen::Map<const Eigen::Vector3d>(found.position.data());
  return pose;
}

class SimbodyLaw : public test::EveryRobot {};
PARACAL_ON_ROBOT_TEMPLATES(SimbodyLaw);

/// 200 machines with errors of millimetres, each at a pose of its own: 1e-9 mm and 1e-11 rad, the issue's.
TEST_P(SimbodyLaw, AssemblesThePlateWhereWeSayThatItStands) {
  test::Random random;
  double worst_mm = 0.0, worst_rad = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Machine machine = build(robot, random.errors(robot, 3.0, 0.0));
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    const ForwardResult ours = forward(machine, joints);
    ASSERT_TRUE(ours.ok());
    Eigen::Isometry3d near = Eigen::Isometry3d::Identity();
    near.linear() =
        plate_rotation(ours.plate.tilt).matrix * Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized());
    near.translation() = ours.plate.position + random.within(5.0);
    const Eigen::Isometry3d theirs = assembled(machine, joints, near);
    const Eigen::Matrix3d turn = plate_rotation(ours.plate.tilt).matrix.transpose() * theirs.linear();
    worst_mm = std::max(worst_mm, (theirs.translation() - ours.plate.position).norm());
    worst_rad = std::max(worst_rad, Eigen::Vector3d(turn(2, 1), turn(0, 2), turn(1, 0)).norm());
  }
  RecordProperty("worst", fmt::format("{:.2g} mm, {:.2g} rad", worst_mm, worst_rad));
  EXPECT_LT(worst_mm, 1e-9);
  EXPECT_LT(worst_rad, 1e-11);
}

}  // namespace
}  // namespace paracal
