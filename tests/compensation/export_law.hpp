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
#include "paracal/kinematics/inverse.hpp"
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
  CompensatorTilt<double> tilt{};  ///< of the plate, away from the commanded one
};

/// Coordinates that can be commanded, in the order of exports: 0 to 5 of x, y, z, tilt_x, tilt_y and tilt_z or phi.
inline std::vector<std::size_t> commanded_of(const Robot& robot) {
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < 6; ++k) {
    if (robot.nominal().freedoms.free.at(k) || (k == 5 && robot.slide())) places.push_back(k);
  }
  return places;
}

inline double& coordinate(Pose& pose, const Robot& robot, std::size_t place) {
  if (place == 5 && robot.slide()) return pose.rotation;
  const auto k = static_cast<Eigen::Index>(place);
  return k < 3 ? pose.position(k) : pose.tilt(k - 3);
}

/// A robot with errors of both groups ("tilts"), of the position group alone ("level"), with a single one, so that many
/// of its constants are 0 or 1 ("single"), with errors of both groups and uneven drives ("drives"), or with these and
/// errors of each turn ("turns").
class ExportLaw : public testing::TestWithParam<std::tuple<std::string_view, std::string_view>> {
 protected:
  ExportLaw() {
    if (!robot.is_level()) {
      errors = SourceErrors();
      for (const Parameter& one : robot.parameters()) {
        errors(one.limb, one.source) = random.uniform(-one.tolerance, one.tolerance);
      }
    }
    const std::string_view kind = std::get<1>(GetParam());
    for (std::size_t i = 0; kind == "turns" && i < robot.limb_count(); ++i) {
      const double tolerance = generous_tolerances(robot.limbs())["turn_sine"];
      errors(i, "turn_sine") = random.uniform(-tolerance, tolerance);
      errors(i, "turn_cosine") = random.uniform(-tolerance, tolerance);
    }
    if (kind == "drives" || kind == "turns") drives = uneven_drives();
    if (kind == "level") errors = without_tilt_group(errors);
    if (kind != "single") return;
    errors = SourceErrors();
    errors(1, "rod_difference") = 0.3;
  }

  CompensatorParameters<double> parameters() const { return compensator_parameters(robot, errors, drives); }

  Joints library_joints(const Pose& pose) const { return drives.commanded(inverse(build(robot, errors), pose).joints); }

  Answer expected(const Pose& pose) const {
    Answer answer;
    answer.status = static_cast<int>(
        compensate(parameters(), CompensationWay::exact, closure_pose(pose), answer.joints, &answer.tilt));
    return answer;
  }

  /// 1e-9 deg, mm on rails by as much as they turn the rods.
  double tolerance() const { return 1.7e-11 * joint_scale(robot); }

  double worst_of(const Answer& answer, const Answer& wanted) const {
    double worst = 0.0;
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      worst = std::max(worst, std::abs(answer.joints.at(i) - wanted.joints.at(i)));
    }
    return worst;
  }

  /// Poses of the workspace.
  template <typename Task>
  void hold_to_the_library(Task&& answer_to) {
    double worst = 0.0, worst_tilt = 0.0;
    const Machine machine = build(robot, errors);
    for (int k = 0; k < kPoses; ++k) {
      const Pose pose = random.pose(robot);
      const InverseResult library = inverse(machine, pose);
      Answer wanted{.status = 0, .joints = {}, .tilt = {}};
      std::ranges::copy(drives.commanded(library.joints), wanted.joints.begin());
      ASSERT_TRUE(library.ok());
      const Answer answer = answer_to(pose);
      ASSERT_EQ(answer.status, 0);
      worst = std::max(worst, worst_of(answer, wanted));
      const Eigen::Vector3d tilt(answer.tilt.eps_x, answer.tilt.eps_y, answer.tilt.eps_z);
      worst_tilt = std::max(worst_tilt, (tilt - library.tilt).norm());
    }
    RecordProperty("worst", fmt::format("{:.2g}", worst));
    EXPECT_LT(worst, tolerance());
    EXPECT_LT(worst_tilt, 1e-12);
  }

  /// Poses that cannot be taken leave the last joints, for the reason that the library has.
  template <typename Task>
  void survive_bad_poses(Task&& answer_to) {
    const Pose good = random.pose(robot);
    const Answer before = answer_to(good);
    std::vector<Pose> poses;
    for (const std::size_t place : commanded_of(robot)) {
      for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        poses.push_back(good);
        coordinate(poses.back(), robot, place) = bad;
      }
    }
    if (robot.is_level()) {
      for (const Eigen::Vector3d& place : {Eigen::Vector3d(5000, 0, -5000), Eigen::Vector3d(1e300, 0, -900),
                                           Eigen::Vector3d(0, -1e300, 0), Eigen::Vector3d(3000, 0, -900)}) {
        poses.push_back({place});
      }
      if (!robot.slide()) poses.push_back({good.position, 0.1});
    }
    for (const Pose& pose : poses) {
      const Answer answer = answer_to(pose);
      const bool beyond_real = pose.position.cwiseAbs().maxCoeff() > 1e37;  // a text may take it for infinite
      EXPECT_TRUE(answer.status == expected(pose).status || (beyond_real && answer.status == 2))
          << answer.status << ": " << pose.position.transpose() << " " << pose.rotation;
      EXPECT_NE(answer.status, 0);
      EXPECT_EQ(answer.joints, before.joints);
      EXPECT_EQ(answer.tilt.eps_x, before.tilt.eps_x);
    }
  }

  /// Poses reached or not; the library's verdict on each. At the height of the base joints nothing holds a tilted
  /// plate, and rounding decides whether an answer is found.
  template <typename Task>
  void judge_poses_anywhere(Task&& answer_to) {
    if (!robot.is_level()) return;
    const double size = sizes_of(robot.limbs()).base_radius + 2.0 * sizes_of(robot.limbs()).rod;
    std::array<int, 4> counts{};
    int others = 0;
    for (int k = 0; k < 2000; ++k) {
      const double z = k % 4 == 0 ? 0.0 : random.uniform(-size, size);
      const Pose pose{{random.uniform(-size, size), random.uniform(-size, size), z}, robot.slide() ? 0.3 : 0.0};
      const int status = answer_to(pose).status, wanted = expected(pose).status;
      ++counts.at(static_cast<std::size_t>(status));
      ASSERT_EQ(status == 1, wanted == 1) << pose.position.transpose();
      others += status != wanted && z != 0.0 ? 1 : 0;
    }
    EXPECT_LE(others, 2);
    EXPECT_GT(counts[0], 20);
    EXPECT_GT(counts[1], 20);
    const bool fails_somewhere = robot.name() == "rotary_delta" && parameters().tilts_plate != 0;
    EXPECT_GE(counts[3], fails_somewhere ? 3 : 0);
  }

  /// Rates against differences of the joints, relative to the largest of their coordinate. Errors of two rods change
  /// them by their size; the head of the export says by how much.
  template <typename Task>
  void hold_rates(Task&& rates_at, double most) {
    const std::vector<std::size_t> places = commanded_of(robot);
    double worst = 0.0;
    for (int count = 0; count < 100; ++count) {
      const Pose pose = random.pose(robot);
      const std::vector<double> rates = rates_at(pose);
      ASSERT_EQ(rates.size(), robot.limb_count() * places.size());
      for (std::size_t k = 0; k < places.size(); ++k) {
        const double step = places[k] < 3 ? 1e-3 : 1e-5;
        Pose up = pose, down = pose;
        coordinate(up, robot, places[k]) += step;
        coordinate(down, robot, places[k]) -= step;
        const Joints by = (library_joints(up) - library_joints(down)) / (2.0 * step);
        for (std::size_t i = 0; i < robot.limb_count(); ++i) {
          const double off = rates[i * places.size() + k] - by(static_cast<Eigen::Index>(i));
          worst = std::max(worst, std::abs(off) / by.cwiseAbs().maxCoeff());
        }
      }
    }
    RecordProperty("worst_rate", fmt::format("{:.2g}", worst));
    constexpr double kCurved = 5e-7;  // what differences have of the curves of turns
    EXPECT_LT(worst, robot.actuator().has_harmonics ? std::max(most, kCurved) : most);
  }

  /// A set of the same layout, of a robot that is a tenth larger: its sum is right.
  std::vector<double> set_of_another_robot() const {
    RobotDescription larger = robot.description();
    larger.name = "larger";
    larger.workspace.radius *= 0.99;
    for (LimbDescription& limb : larger.limbs) {
      limb.base *= 1.0 + 5e-4;
      if (limb.arm > 0.0) limb.arm += 0.1;
    }
    return exported_set(Robot(larger), errors, drives).set;
  }

  /// What a head says of the error of rates: that of the closed form.
  static double stated_rate_error(const std::string& text) {
    const std::string before = "of the closed form: within ";
    const std::size_t at = text.find(before);
    return at == std::string::npos ? 0.0 : std::stod(text.substr(at + before.size()));
  }

  /// Off by a few hundredths of a degree, and with slopes of a few hundredths.
  DriveCurves uneven_drives() {
    Joints low = Joints::Constant(static_cast<Eigen::Index>(robot.limb_count()), 1e9), high = -low;
    for (int k = 0; k < 200; ++k) {
      const InverseResult found = inverse(robot.nominal(), random.pose(robot));
      low = low.cwiseMin(found.joints);
      high = high.cwiseMax(found.joints);
    }
    std::vector<SoughtSource> knots;
    std::vector<double> sizes;
    for (Eigen::Index i = 0; i < low.size(); ++i) {
      if (low.size() > 3 && i == 1) continue;  // an even one among them
      const double spacing = (high(i) - low(i)) / 8.0;
      for (int k = 0; k < 11; ++k) {
        knots.push_back({.limb = static_cast<std::size_t>(i), .knot = SplineKnot{low(i) + (k - 1) * spacing, spacing}});
        sizes.push_back(0.02 * spacing * random.uniform(-1.0, 1.0));
      }
    }
    return {knots, Eigen::Map<const Eigen::VectorXd>(sizes.data(), std::ssize(sizes))};
  }

  /// Screws of 5 mm, encoders of 10 deg.
  static Robot turning(const Robot& even) {
    RobotDescription description = even.description();
    for (LimbDescription& limb : description.limbs) {
      limb = with_pitch(limb, joint_unit(limb.kind) == Unit::mm ? 5.0 : to_radians(10.0));
    }
    return Robot(std::move(description));
  }

  Robot robot = std::get<1>(GetParam()) == "turns" ? turning(robot_named(std::get<0>(GetParam())))
                                                   : robot_named(std::get<0>(GetParam()));
  Random random;
  DriveCurves drives;
  SourceErrors errors = robot.is_level() ? random.realistic_errors(robot) : SourceErrors();
};

/// On every robot, with each kind of errors; limbs of one rod have no tilt group.
#define PARACAL_ON_EVERY_EXPORT(suite)                                                                                \
  INSTANTIATE_TEST_SUITE_P(                                                                                           \
      Robots, suite,                                                                                                  \
      testing::Combine(testing::Values(std::string_view("huang2016"), "rotary_delta", "linear_delta", "unlike_limbs", \
                                       "inclined_rails"),                                                             \
                       testing::Values(std::string_view("tilts"), "level", "single", "drives", "turns")),             \
      [](const auto& one) { return fmt::format("{}_{}", std::get<0>(one.param), std::get<1>(one.param)); });          \
  INSTANTIATE_TEST_SUITE_P(OtherRobots, suite,                                                                        \
                           testing::Combine(testing::Values(std::string_view("hexapod"), "five-bar", "line-printer",  \
                                                            "planar-rails", "mixed_limbs", "seven_struts"),           \
                                            testing::Values(std::string_view("tilts"), "drives", "turns")),           \
                           [](const auto& one) {                                                                      \
                             std::string name = fmt::format("{}_{}", std::get<0>(one.param), std::get<1>(one.param)); \
                             std::ranges::replace(name, '-', '_');                                                    \
                             return name;                                                                             \
                           })

}  // namespace paracal::test
