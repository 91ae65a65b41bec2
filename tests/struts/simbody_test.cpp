// An independent mechanism program: a free plate, its guides as constraints, and rods whose upper ends, or lengths,
// motors hold, closed by Simbody's assembler.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "simbody_assembly.hpp"
#include "support/robots.hpp"

namespace paracal::simbody_test {
namespace {

constexpr double kMetre = 1000.0;  // mm: Simbody's tolerances are those of metres

std::array<double, 3> in_metres(const Eigen::Vector3d& mm) {
  return {mm.x() / kMetre, mm.y() / kMetre, mm.z() / kMetre};
}

/// Of a matrix, row by row.
std::array<double, 9> rows_of(const Eigen::Matrix3d& matrix) {
  std::array<double, 9> rows{};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data()) = matrix;
  return rows;
}

test::AssembledLimb assembled_limb(const Limb& limb, double joint) {
  using Motor = test::AssembledLimb::Motor;
  const double place = limb.joint_offset + limb.gain() * joint;
  test::AssembledLimb made{.motor = Motor::none,
                           .frame = rows_of(Eigen::Matrix3d::Identity()),
                           .base = in_metres(as_eigen(limb.base)),
                           .coordinate = place,
                           .arm = limb.arm / kMetre,
                           .plate = in_metres(as_eigen(limb.plate)),
                           .length = limb.rod[0] / kMetre};
  const Eigen::Matrix3d frame = limb.frame();
  switch (limb.actuator.drive) {
    case Drive::arm:
      made.motor = Motor::turns;
      made.frame = rows_of(frame);
      break;
    case Drive::rail: {
      Eigen::Matrix3d along;
      along << frame.col(1), frame.col(2), frame.col(0);
      made.motor = Motor::pushes;
      made.frame = rows_of(along);
      made.coordinate = place / kMetre;
      break;
    }
    default:
      made.length = place / kMetre;
  }
  return made;
}

/// @param near  where the assembler begins.
Eigen::Isometry3d assembled(const Machine& machine, const Joints& joints, const Eigen::Isometry3d& near) {
  std::vector<test::AssembledLimb> limbs;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    limbs.push_back(assembled_limb(machine.limbs[i], joints(static_cast<Eigen::Index>(i))));
  }
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const test::AssembledPlate start{.rotation = rows_of(near.linear()), .position = in_metres(near.translation())};
  const test::AssembledPlate found = test::assemble(limbs, {machine.freedoms.free, machine.guided_z / kMetre}, start);
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
    const Machine machine = build(robot, random.errors(robot, 3.0, to_radians(0.5)));
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    const ForwardResult ours = forward(machine, joints);
    ASSERT_TRUE(ours.ok());
    Eigen::Isometry3d near = Eigen::Isometry3d::Identity();
    near.linear() =
        plate_rotation(ours.plate.tilt).matrix * Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 3).normalized());
    near.translation() = ours.plate.position + random.within(5.0);  // off, and turned, what guides hold, too
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
}  // namespace paracal::simbody_test
