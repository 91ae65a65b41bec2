#include "paracal/mechanism/machine.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"

namespace paracal::machine_test {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

Matrix3d turn(const Vector3d& axis, double angle) { return Eigen::AngleAxisd(angle, axis).matrix(); }

TEST(Machine, NominalFramesAreRadialVerticalAndAcross) {
  const Robot robot = catalogue::huang2016();
  for (std::size_t i = 0; i < 4; ++i) {
    const double g = *robot.limbs()[i].azimuth;
    const Limb& limb = robot.nominal().limbs[i];
    EXPECT_TRUE(limb.frame().col(0).isApprox(Vector3d(std::cos(g), std::sin(g), 0)));
    EXPECT_TRUE(limb.frame().col(1).isApprox(Vector3d(0, 0, 1)));
    EXPECT_TRUE(limb.frame().col(2).isApprox(Vector3d(std::sin(g), -std::cos(g), 0)));
    EXPECT_TRUE(as_eigen(limb.base).isApprox(200.0 * limb.frame().col(0)));
    EXPECT_TRUE(as_eigen(limb.plate).isApprox(75.0 * limb.frame().col(0)));
  }
}

/// The rotations of [huang2016, Eq. (1)], written down once more with Eigen's axis-angle type.
TEST(Machine, ErrorsEnterAsInEquation1) {
  const Robot robot = catalogue::huang2016();
  test::Random random;
  const SourceErrors errors = random.errors(robot, 2.0, 0.1);
  const Machine machine = build(robot, errors);
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto e = [&](Source source) { return errors(i, source); };
    const double g = *robot.limbs()[i].azimuth, quarter = std::numbers::pi / 2;
    const Limb& limb = machine.limbs[i];
    const Matrix3d base = turn(z, g) * turn(x, quarter + e("alpha0")) * turn(y, e("beta0"));
    const Matrix3d elbow = turn(x, e("alpha2")) * turn(y, e("beta2"));
    const Matrix3d plate =
        turn(z, g) * turn(x, quarter + e("alpha0") - e("alpha03")) * turn(y, e("beta0") - e("beta03"));
    const double width = robot.limbs()[i].width;
    EXPECT_TRUE(limb.frame().isApprox(base, 1e-14));
    EXPECT_TRUE(as_eigen(limb.elbow_half).isApprox(0.5 * (width + e("width_difference")) * elbow.col(2), 1e-14));
    EXPECT_TRUE(as_eigen(limb.plate_half).isApprox(0.5 * width * plate.col(2), 1e-14));
    EXPECT_NEAR(limb.rod[0] - limb.rod[1], e("rod_difference"), 1e-12);
    EXPECT_NEAR(limb.mean_rod(), 950.0 + e("rod_mean"), 1e-12);
    EXPECT_EQ(limb.joint_offset, e("theta_offset"));
    EXPECT_EQ(limb.arm, 375.0 + e("arm_length"));
  }
}

/// Of a rail alpha0 and beta0 are where it leans to; the bars stay level and parallel with beta0, and lean alike with
/// alpha0.
TEST(Machine, RailsLeanByTheirAngles) {
  const Robot robot = catalogue::linear_delta();
  test::Random random;
  SourceErrors errors = random.errors(robot, 2.0, 0.1);
  const Machine machine = build(robot, errors);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto e = [&](Source source) { return errors(i, source); };
    const Limb& limb = machine.limbs[i];
    const Limb& nominal = robot.nominal().limbs[i];
    const Vector3d u0 = as_eigen(nominal.radial), v0 = as_eigen(nominal.normal), w0 = as_eigen(nominal.axis);
    EXPECT_TRUE(
        limb.frame().isApprox(turn(u0, e("alpha0")) * nominal.frame() * turn(Vector3d::UnitZ(), e("beta0")), 1e-14));
    EXPECT_TRUE(as_eigen(limb.plate_half)
                    .normalized()
                    .isApprox(turn(u0, e("alpha0") - e("alpha03")) * turn(v0, -e("beta03")) * w0, 1e-14));
    EXPECT_EQ(limb.joint_offset, e("theta_offset"));
    EXPECT_EQ(limb.arm, 20.0);
    EXPECT_DOUBLE_EQ(limb.gain(), 1.0 + e("gain") / 1000.0);
  }
}

TEST(Machine, KnowsWhetherSomethingTiltsThePlate) {
  const Robot robot = catalogue::huang2016();
  SourceErrors errors;
  errors(2, "alpha0") = 1e-3;
  EXPECT_FALSE(build(robot, errors).tilts_plate);
  errors(2, "beta03") = 1e-9;
  EXPECT_TRUE(build(robot, errors).tilts_plate);
}

}  // namespace
}  // namespace paracal::machine_test
