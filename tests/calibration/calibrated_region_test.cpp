// Where the poses of a calibration are, and who leaves that region.

#include <gtest/gtest.h>

#include <cmath>

#include "paracal/calibration/calibrated_region.hpp"

namespace paracal::calibrated_region_test {
namespace {

/// The corners of a cube of 200 mm.
CalibratedRegion cube() {
  CalibratedRegion region;
  for (int k = 0; k < 8; ++k) region.add({200.0 * (k / 4) - 100.0, 200.0 * (k / 2 % 2) - 100.0, 200.0 * (k % 2)});
  return region;
}

/// Distances from a cube's faces, edges and corners, by hand.
TEST(CalibratedRegion, MeasuresTheWayOut) {
  const CalibratedRegion region = cube();
  ASSERT_EQ(region.low.size(), 13U);
  EXPECT_EQ(region.beyond({0.0, 50.0, 100.0}), 0.0);
  EXPECT_NEAR(region.beyond({130.0, 0.0, 100.0}), 30.0, 1e-12);
  EXPECT_NEAR(region.beyond({0.0, 0.0, -40.0}), 40.0, 1e-12);
  EXPECT_NEAR(region.beyond({130.0, -130.0, 100.0}), 30.0 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(region.beyond({-130.0, 130.0, 230.0}), 30.0 * std::sqrt(3.0), 1e-12);
}

/// A tenth of the width is allowed.
TEST(CalibratedRegion, IsLeftBeyondATenth) {
  const CalibratedRegion region = cube();
  EXPECT_FALSE(region.is_left_by({119.0, 0.0, 100.0}));
  EXPECT_TRUE(region.is_left_by({121.0, 0.0, 100.0}));
  EXPECT_TRUE(region.is_left_by({0.0, 0.0, -21.0}));
  EXPECT_FALSE(CalibratedRegion().is_left_by({1e6, 0.0, 0.0}));
}

/// Poses in a plane: a fiftieth of their width is allowed across it.
TEST(CalibratedRegion, OfAPlaneIsThin) {
  CalibratedRegion region;
  for (int k = 0; k < 4; ++k) region.add({200.0 * (k / 2), 200.0 * (k % 2), 0.0});
  EXPECT_FALSE(region.is_left_by({50.0, 50.0, 4.0}));
  EXPECT_TRUE(region.is_left_by({50.0, 50.0, 6.0}));
}

/// Poses on both sides of a plane that is inclined to all axes.
TEST(CalibratedRegion, SeesObliqueHalves) {
  CalibratedRegion half;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d corner(200.0 * (k / 4) - 100.0, 200.0 * (k / 2 % 2) - 100.0, 200.0 * (k % 2) - 100.0);
    if (corner.sum() < 0.0) half.add(corner);
  }
  EXPECT_TRUE(half.is_left_by({90.0, 90.0, 90.0}));
  EXPECT_FALSE(half.is_left_by({-60.0, -60.0, -60.0}));
}

}  // namespace
}  // namespace paracal::calibrated_region_test
