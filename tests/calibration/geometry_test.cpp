#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calibration/fit/distance_geometry.hpp"
#include "paracal/calibration/noise.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/numerics/rigid_fit.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::geometry_test {
namespace {

using test::Random;

RigidMotion some_motion() {
  return {Eigen::AngleAxisd(2.5, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix(), {100, -2000, 30}};
}

std::vector<Eigen::Vector3d> some_points(Random& random, int count) {
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < count; ++k) points.push_back(random.within(500.0));
  return points;
}

TEST(RigidFit, FindsTheMotion) {
  Random random;
  const std::vector<Eigen::Vector3d> from = some_points(random, 6);
  std::vector<Eigen::Vector3d> to;
  for (const Eigen::Vector3d& point : from) to.push_back(some_motion()(point));
  const RigidMotion motion = rigid_fit(from, to);
  EXPECT_LT((motion.rotation - some_motion().rotation).norm(), 1e-12);
  EXPECT_LT((motion.translation - some_motion().translation).norm(), 1e-9);
  EXPECT_LT((motion.inverse()(motion(from[0])) - from[0]).norm(), 1e-9);
}

TEST(RigidFit, PointsInAPlaneAreNotMirrored) {
  std::vector<Eigen::Vector3d> from{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 0}}, to;
  for (const Eigen::Vector3d& point : from) to.push_back(some_motion()(point));
  EXPECT_NEAR(rigid_fit(from, to).rotation.determinant(), 1.0, 1e-12);
}

TEST(RigidFit, RobustOneShrugsOffGrossErrors) {
  Random random;
  const std::vector<Eigen::Vector3d> from = some_points(random, 12);
  std::vector<Eigen::Vector3d> to;
  for (const Eigen::Vector3d& point : from) to.push_back(some_motion()(point));
  std::swap(to[2], to[7]);
  to[9] += Eigen::Vector3d(0, 0, 300);
  const RigidMotion motion = robust_rigid_fit(from, to);
  EXPECT_LT((motion(from[0]) - to[0]).norm(), 0.01);
  EXPECT_GT((rigid_fit(from, to)(from[0]) - to[0]).norm(), 1.0);
}

TEST(Whitening, InvertsTheTrackersCovariance) {
  const TrackerModel tracker;
  const Eigen::Vector3d point(1000, 2000, -2000);  // 3 m away
  const Eigen::Matrix3d w = whitening(tracker, point);
  const Eigen::Matrix3d covariance = (w.transpose() * w).inverse();
  const Eigen::Vector3d beam = point.normalized(), across = beam.unitOrthogonal();
  EXPECT_NEAR(std::sqrt(beam.dot(covariance * beam)), 0.010 + 3 * 0.0003, 1e-12);
  EXPECT_NEAR(std::sqrt(across.dot(covariance * across)), 0.015 + 3 * 0.006, 1e-12);
}

TEST(DistanceGeometry, RecoversPointsAndTheirHand) {
  const Robot robot = catalogue::huang2016();
  const Measurements measured = test::measured_machine(robot, fine_stations(robot, 9), 1, {.noise = 0.02}).measurements;
  Measurements pairs{.stations = measured.stations, .distances = all_distances(measured.series[0])};
  const auto again = detail::as_points(pairs);
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->distances.empty());
  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t k = 0; k < measured.stations.size(); ++k) {
    from.push_back(again->series[0].readings[k].point);
    to.push_back(measured.series[0].readings[k].point);
  }
  const RigidMotion motion = rigid_fit(from, to);
  for (std::size_t k = 0; k < from.size(); ++k) EXPECT_LT((motion(from[k]) - to[k]).norm(), 1e-6);
}

TEST(DistanceGeometry, LeavesDistancesAloneThatAreSomethingElse) {
  const Robot robot = catalogue::huang2016();
  const auto pairs_of = [&](const std::vector<Station>& stations) {
    const Measurements measured = test::measured_machine(robot, stations, 1, {.noise = 0.02}).measurements;
    return Measurements{.stations = measured.stations, .distances = all_distances(measured.series[0])};
  };
  Measurements incomplete = pairs_of(fine_stations(robot, 9));
  incomplete.distances.pop_back();
  EXPECT_FALSE(detail::as_points(incomplete));
  Measurements stated = pairs_of(fine_stations(robot, 9));
  stated.distances[3].distance_sigma = 0.01;
  EXPECT_FALSE(detail::as_points(stated));
  Measurements independent = pairs_of(fine_stations(robot, 9));
  Random random;
  for (DistanceReading& reading : independent.distances) reading.distance += random.normal(0.05);
  EXPECT_FALSE(detail::as_points(independent));
  EXPECT_FALSE(detail::as_points(pairs_of(rough_stations(robot, 6)))) << "points in a plane";
}

}  // namespace
}  // namespace paracal::geometry_test
