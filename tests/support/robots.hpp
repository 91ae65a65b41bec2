#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"

namespace paracal::test {

/// A robot of the catalogue, that of a template (io::robot_templates), or one that neither has:
///
///   unlike_limbs    the rotary Delta with arms, rods and shoulders of three sizes, and axes that are not level
///   inclined_rails  a linear Delta with rails that lean outward by 20, 25 and 30 deg
///   boxed           the rotary Delta in a box beside its axis
///   levelled        the rotary Delta in a body of revolution, widest in between
Robot robot_named(std::string_view name);

/// Laws that hold for every robot are tested on every robot of the catalogue.
class EveryRobot : public ::testing::TestWithParam<std::string_view> {
 protected:
  Robot robot = robot_named(GetParam());
};

/// Those of io::robot_templates() on limbs with one rod, for good.
const std::vector<std::string_view>& template_names();
/// Those of them whose plate has six freedoms.
const std::vector<std::string_view>& hexapod_names();
/// Those of them whose plate has fewer, and guides.
const std::vector<std::string_view>& guided_names();
/// Those whose plate stays level on parallelograms, of the kinds that the catalogue has.
const std::vector<std::string_view>& level_template_names();

/// As names of tests may be.
inline std::string robot_name(const ::testing::TestParamInfo<std::string_view>& info) {
  std::string name(info.param);
  std::ranges::replace(name, '-', '_');
  return name;
}

/// By how much more joint coordinates of a robot count than radians: mm of a carriage turn a rod by 1 / its length.
inline double joint_scale(const Robot& robot) {
  return joint_unit(robot.actuator()) == Unit::mm ? sizes_of(robot.limbs()).rod : 1.0;
}

/// Changes the short form of a robot whose limbs have one.
inline void redimension(RobotDescription& robot, const std::function<void(SharedDimensions&)>& change) {
  SharedDimensions shared = *shared_dimensions(robot.limbs);
  change(shared);
  robot.limbs = limbs_of(shared);
}

/// Instantiates a suite derived from EveryRobot.
#define PARACAL_ON_EVERY_ROBOT(suite)                                                          \
  INSTANTIATE_TEST_SUITE_P(Catalogue, suite, ::testing::ValuesIn(paracal::catalogue::names()), \
                           paracal::test::robot_name)

/// The same for robots that no catalogue has.
#define PARACAL_ON_UNUSUAL_ROBOTS(suite)                                                                               \
  INSTANTIATE_TEST_SUITE_P(Unusual, suite,                                                                             \
                           ::testing::Values(std::string_view("unlike_limbs"), "inclined_rails", "boxed", "levelled"), \
                           paracal::test::robot_name)

/// The same for robots on limbs with one rod, which are a file alone.
#define PARACAL_ON_ROBOT_TEMPLATES(suite)                                                         \
  INSTANTIATE_TEST_SUITE_P(Template, suite, ::testing::ValuesIn(paracal::test::template_names()), \
                           paracal::test::robot_name)

/// The same for those of them with six freedoms.
#define PARACAL_ON_HEXAPODS(suite)                                                               \
  INSTANTIATE_TEST_SUITE_P(Template, suite, ::testing::ValuesIn(paracal::test::hexapod_names()), \
                           paracal::test::robot_name)

/// The same for those of them with guides.
#define PARACAL_ON_GUIDED_PLATES(suite)                                                         \
  INSTANTIATE_TEST_SUITE_P(Template, suite, ::testing::ValuesIn(paracal::test::guided_names()), \
                           paracal::test::robot_name)

/// Reproducible random numbers: the same sequence in every run.
class Random {
 public:
  explicit Random(std::uint64_t seed = 1) : engine_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine_); }
  double normal(double sigma) { return std::normal_distribution<>(0.0, sigma)(engine_); }

  /// Anywhere in the workspace, any rotation, any tilt that it has.
  Pose pose(const Robot& robot);
  /// Every source error uniform within +-mm or +-rad, by unit.
  SourceErrors errors(const Robot& robot, double mm, double rad);
  /// Position group as large as in [huang2016, Table 4], tilt group within the robot's tolerances.
  SourceErrors realistic_errors(const Robot& robot);
  /// A point of the ball of that radius.
  Eigen::Vector3d within(double radius);

 private:
  std::mt19937_64 engine_;
};

}  // namespace paracal::test
