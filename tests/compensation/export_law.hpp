#pragma once

// Laws of every export: it answers as the compensator that it is printed from.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <tuple>
#include <vector>

#include "paracal/compensation/export.hpp"
#include "paracal/compensation/parameters.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test {

#ifdef PARACAL_SANITIZED
inline constexpr int kPoses = 500;
#else
inline constexpr int kPoses = 10'000;
#endif
const ExportOrigin kOrigin{.calibration = "calibration.json", .sha256 = "0123", .date = "2026-01-01"};

/// What an export answers to a pose.
struct Answer {
  int status = -1;
  CompensatorJoints<double> joints{};
  CompensatorTilt<double> tilt{};
};

/// A robot with errors of both groups ("tilts"), of the position group alone ("level"), or with a single one, so that
/// many of its constants are 0 or 1 ("single").
class ExportLaw : public testing::TestWithParam<std::tuple<std::string_view, std::string_view>> {
 protected:
  ExportLaw() {
    if (std::get<1>(GetParam()) == "level") errors = without_tilt_group(errors);
    if (std::get<1>(GetParam()) != "single") return;
    errors = SourceErrors();
    errors(1, "rod_difference") = 0.3;
  }

  CompensatorParameters<double> parameters() const { return compensator_parameters(robot, errors); }

  Answer expected(const CompensatorPose<double>& pose) const {
    Answer answer;
    answer.status =
        static_cast<int>(compensate(parameters(), CompensationWay::exact, pose, answer.joints, &answer.tilt));
    return answer;
  }

  /// 1e-9 deg, mm on rails by as much as they turn the rods.
  double tolerance() const { return 1.7e-11 * joint_scale(robot); }

  /// Poses of the workspace.
  template <typename Task>
  void hold_to_the_library(Task&& answer_to) {
    double worst = 0.0, worst_tilt = 0.0;
    const auto library = parameters();
    for (int k = 0; k < kPoses; ++k) {
      const CompensatorPose<double> pose = compensator_pose(random.pose(robot));
      CompensatorJoints<double> joints{};
      CompensatorTilt<double> tilt;
      ASSERT_EQ(compensate(library, CompensationWay::exact, pose, joints, &tilt), CompensationStatus::ok);
      const Answer answer = answer_to(pose);
      ASSERT_EQ(answer.status, 0);
      for (std::size_t i = 0; i < robot.limb_count(); ++i)
        worst = std::max(worst, std::abs(answer.joints[i] - joints[i]));
      worst_tilt = std::max(worst_tilt, std::hypot(answer.tilt.eps_x - tilt.eps_x, answer.tilt.eps_y - tilt.eps_y));
    }
    RecordProperty("worst", fmt::format("{:.2g}", worst));
    EXPECT_LT(worst, tolerance());
    EXPECT_LT(worst_tilt, 1e-12);
  }

  /// Poses that cannot be taken leave the last joints, for the reason that the library has.
  template <typename Task>
  void survive_bad_poses(Task&& answer_to) {
    const CompensatorPose<double> good = compensator_pose(random.pose(robot));
    const Answer before = answer_to(good);
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    std::vector<CompensatorPose<double>> poses{
        {nan, 0, -900, 0},   {0, nan, -900, 0},   {0, 0, nan, 0},    {0, 0, -900, nan}, {0, -infinity, -900, 0},
        {5000, 0, -5000, 0}, {1e300, 0, -900, 0}, {0, -1e300, 0, 0}, {0, 0, 1e300, 0},  {3000, 0, -900, 0}};
    if (!robot.slide()) poses.push_back({good.x, good.y, good.z, 0.1});
    for (const CompensatorPose<double>& pose : poses) {
      const Answer answer = answer_to(pose);
      const int status = expected(pose).status;
      const bool is_no_pose = std::abs(pose.z) > 1e9;  // a text may say so before it computes
      EXPECT_TRUE(answer.status == status || (is_no_pose && answer.status == 1))
          << answer.status << ", not " << status << ": " << pose.x << " " << pose.y << " " << pose.z << " " << pose.phi;
      EXPECT_NE(answer.status, 0);
      EXPECT_EQ(answer.joints, before.joints);
      EXPECT_EQ(answer.tilt.eps_x, before.tilt.eps_x);
    }
  }

  /// Poses reached or not; the library's verdict on each. At the height of the base joints nothing holds a tilted
  /// plate, and rounding decides whether an answer is found.
  template <typename Task>
  void judge_poses_anywhere(Task&& answer_to) {
    const double size = robot.geometry().base_radius + 2.0 * robot.geometry().rod;
    std::array<int, 4> counts{};
    int others = 0;
    for (int k = 0; k < 2000; ++k) {
      const double z = k % 4 == 0 ? 0.0 : random.uniform(-size, size);
      const CompensatorPose<double> pose{random.uniform(-size, size), random.uniform(-size, size), z,
                                         robot.slide() ? 0.3 : 0.0};
      const int status = answer_to(pose).status, wanted = expected(pose).status;
      ++counts.at(static_cast<std::size_t>(status));
      ASSERT_EQ(status == 1, wanted == 1) << pose.x << " " << pose.y << " " << pose.z;
      others += status != wanted && z != 0.0 ? 1 : 0;
    }
    EXPECT_LE(others, 2);
    EXPECT_GT(counts[0], 20);
    EXPECT_GT(counts[1], 20);
    const bool fails_somewhere = robot.name() == "rotary_delta" && parameters().tilts_plate != 0;
    EXPECT_GE(counts[3], fails_somewhere ? 3 : 0);
  }

  Robot robot = robot_named(std::get<0>(GetParam()));
  Random random;
  SourceErrors errors = random.realistic_errors(robot);
};

/// On every robot, with each kind of errors.
#define PARACAL_ON_EVERY_EXPORT(suite)                                                                                \
  INSTANTIATE_TEST_SUITE_P(                                                                                           \
      Robots, suite,                                                                                                  \
      testing::Combine(testing::Values(std::string_view("huang2016"), "rotary_delta", "linear_delta", "unlike_limbs", \
                                       "inclined_rails"),                                                             \
                       testing::Values(std::string_view("tilts"), "level", "single")),                                \
      [](const auto& one) { return fmt::format("{}_{}", std::get<0>(one.param), std::get<1>(one.param)); })

}  // namespace paracal::test
