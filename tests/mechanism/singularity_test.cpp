// Robots that are singular somewhere inside their workspace are refused. A second judge looks at each: numerical
// derivatives of the rods' lengths at thousands of random poses, from the closure alone.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "paracal/error.hpp"
#include "paracal/kinematics/closure.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/rod_residuals.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::singularity_test {
namespace {

Pose random_pose(const Workspace& workspace, test::Random& random) {
  const auto within = [&](double half) { return random.uniform(-half, half); };
  const double radius = workspace.radius * std::sqrt(random.uniform(0.0, 1.0));
  const double z = workspace.top_z - workspace.height * random.uniform(0.0, 1.0);
  Pose pose{Workspace::on_circle(radius, within(std::numbers::pi), z),
            random.uniform(workspace.min_rotation, workspace.max_rotation)};
  for (int axis = 0; axis < 3; ++axis) pose.tilt(axis) = within(workspace.tilt_about(axis));
  return pose;
}

/// Lengths of the limbs' rods (means of pairs, then their differences) less what they should be.
Eigen::VectorXd lengths(const Machine& machine, const PlateState& plate, const Joints& joints) {
  std::array<double, kMaxLimbs> each{};
  std::copy(joints.begin(), joints.end(), each.begin());
  const auto all = test::rod_residuals(machine, plate, each);
  const auto n = static_cast<Eigen::Index>(machine.limb_count);
  if (!machine.is_level) return all.head(n);
  Eigen::VectorXd sorted(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    sorted(i) = 0.5 * (all(2 * i) + all(2 * i + 1));
    sorted(n + i) = (all(2 * i) - all(2 * i + 1));
  }
  return sorted;
}

/// What changes its sign where a robot is singular: determinants of rods by plate, and motions of rods by joints.
struct Signs {
  Eigen::VectorXd value;
};

/// Empty out of reach.
std::optional<Signs> signs_at(const Machine& machine, const Pose& pose) {
  const InverseResult reached = inverse(machine, pose);
  if (!reached.ok()) return std::nullopt;
  const PlateState plate = plate_at(machine, pose);
  const auto n = static_cast<Eigen::Index>(machine.limb_count);
  const auto by_plate = [&](const auto& coordinate, double step) -> Eigen::VectorXd {
    PlateState one = plate, other = plate;
    coordinate(one) += step;
    coordinate(other) -= step;
    return (lengths(machine, one, reached.joints) - lengths(machine, other, reached.joints)) / (2.0 * step);
  };
  constexpr double kMm = 1e-3, kRad = 1e-5;
  const double lever = 2.0 * machine.turn_lever;
  Eigen::MatrixXd all(!machine.is_level ? n : 2 * n, 7);
  for (int k = 0; k < 3; ++k) {
    all.col(k) = by_plate([k](PlateState& p) -> double& { return p.position(k); }, kMm);
    all.col(3 + k) = by_plate([k](PlateState& p) -> double& { return p.tilt(k); }, kRad) / lever;
  }
  all.col(6) = by_plate([](PlateState& p) -> double& { return p.slide; }, kMm);
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (!machine.is_level ? machine.freedoms.free[static_cast<std::size_t>(k)] : k < 3) free.push_back(k);
  }
  if (machine.has_slide()) free.push_back(6);
  Signs signs{Eigen::VectorXd::Ones(2 + n)};
  signs.value(0) = all(Eigen::seqN(0, n), free).determinant();
  if (machine.is_level) {
    const Eigen::MatrixXd level = all.block(n, 3, n, 3);
    signs.value(1) = n == 3 ? level.determinant() : (level.transpose() * level).determinant();
  }
  for (Eigen::Index i = 0; i < n && !machine.limbs[0].is_strut(); ++i) {
    Joints more = reached.joints, less = reached.joints;
    const double step = swings_arm(machine.actuator()) ? kRad : kMm;
    more(i) += step;
    less(i) -= step;
    signs.value(2 + i) = (lengths(machine, plate, more) - lengths(machine, plate, less))(i) / (2.0 * step);
  }
  return signs;
}

struct Judgement {
  double singular = 0.0, level = 0.0;  ///< shares of poses of the other sign, and of the same poses held level
  double least = 1.0;                  ///< smallest value over that at the centre
};

/// Empty where a pose is out of reach.
std::optional<Judgement> judged(const RobotDescription& robot, int poses, test::Random& random) {
  const Machine machine = build(robot, SourceErrors{});
  const Workspace& workspace = robot.workspace;
  const std::optional<Signs> centre =
      signs_at(machine, {workspace.centre(), std::clamp(0.0, workspace.min_rotation, workspace.max_rotation)});
  if (!centre) return std::nullopt;
  Judgement judgement;
  for (int k = 0; k < poses; ++k) {
    Pose pose = random_pose(workspace, random);
    const std::optional<Signs> here = signs_at(machine, pose);
    if (!here) return std::nullopt;
    const double least = here->value.cwiseQuotient(centre->value).minCoeff();
    judgement.least = std::min(judgement.least, least);
    if (least >= 0.0) continue;
    judgement.singular += 1.0 / poses;
    pose.tilt.setZero();
    const std::optional<Signs> level = signs_at(machine, pose);
    const bool also = level && level->value.cwiseQuotient(centre->value).minCoeff() < 0.0;
    judgement.level += (also ? 1.0 : 0.0) / poses;
  }
  return judgement;
}

/// Few random poses are in the corners, where all tilts are extreme.
bool reaches_rim(const RobotDescription& robot) {
  const Machine machine = build(robot, SourceErrors{});
  return std::ranges::all_of(robot.workspace.rim(24), [&](const Pose& pose) { return inverse(machine, pose).ok(); });
}

/// A robot like one of the templates or the catalogue, of other proportions, in a workspace of another size.
RobotDescription varied(const std::string& like, test::Random& random) {
  RobotDescription robot = test::robot_named(like == "five-struts" ? "hexapod" : like).description();
  robot.tolerances.reset();
  const auto factor = [&](double log) { return std::exp(random.uniform(-log, log)); };
  if (on_single_rods(actuator_of(robot.limbs))) {
    const double base = factor(0.5), plate = factor(0.7), rod = factor(0.3), arm = factor(0.3);
    const double off = 0.1 * sizes_of(robot.limbs).base_radius;
    if (like == "five-struts") {
      robot.limbs.pop_back();
      robot.freedoms.free[5] = false;
    }
    for (LimbDescription& limb : robot.limbs) {
      limb.base.head<2>() *= base;
      limb.plate.head<2>() *= plate;
      limb.length *= rod;
      limb.arm *= arm;
      const bool flat = robot.freedoms.holds_z();
      limb.base += off * Eigen::Vector3d(random.normal(0.3), random.normal(0.3), flat ? 0.0 : random.normal(0.3));
    }
  } else {
    test::redimension(robot, [&](SharedDimensions& shared) {
      shared.base_radius *= factor(0.6);
      shared.plate_radius *= factor(0.6);
      shared.rod *= factor(0.5);
      shared.arm *= factor(0.5);
      for (double& azimuth : shared.limb_azimuth) azimuth += random.normal(0.3);
    });
    if (robot.slide) {
      const double angle = random.uniform(0.0, std::numbers::pi);
      robot.slide->axis = {std::cos(angle), std::sin(angle), 0.0};
    }
  }
  Workspace& workspace = robot.workspace;
  workspace.radius *= factor(1.2);
  workspace.top_z *= factor(0.7);
  workspace.height *= factor(0.7);
  workspace.max_tilt = std::min(workspace.max_tilt * random.uniform(0.0, 6.0), to_radians(75.0));
  for (std::size_t k = 0; k < 3; ++k) workspace.tilts_about[k] = robot.freedoms.free[3 + k];
  return robot;
}

bool is_refused(const RobotDescription& robot, std::string& why) {
  try {
    (void)Robot(robot);
  } catch (const InvalidArgument& refusal) {
    why = refusal.what();
    return true;
  }
  return false;
}

const std::vector<std::string> kLike{"hexapod", "five-struts",  "five-bar",     "3-rrr",    "6-rss",
                                     "6-pss",   "rotary_delta", "linear_delta", "huang2016"};

/// Of robots with the other sign in at least a hundredth of their poses, reach everywhere, at least 99 % are refused;
/// of those whose determinants stay above a fifth of that at the centre none is.
TEST(SingularRobots, AreRefusedAndOthersAreNot) {
  const test::Machines wanted{.claim = 207, .quick = 27};
  const int each = test::machines(wanted) / static_cast<int>(kLike.size());
  int singular = 0, refused = 0, tilted = 0, sound = 0, accepted = 0;
  std::string text;
  for (const std::string& like : kLike) {
    test::Random random(11);
    int bad = 0, good = 0, bad_refused = 0, good_accepted = 0, bad_tilted = 0;
    for (int number = 0; number < 1500 && (bad < each || good < each); ++number) {
      const RobotDescription robot = varied(like, random);
      const std::optional<Judgement> first = judged(robot, 60, random);
      if (!first || (first->least > 0.0 ? good >= each : bad >= each)) continue;
      const std::optional<Judgement> found = judged(robot, test::every_machine() ? 20'000 : 1000, random);
      if (!found) continue;
      std::string why;
      if (found->singular >= 0.01 && bad < each) {
        ++bad;
        bad_tilted += found->level == 0.0 ? 1 : 0;
        bad_refused += is_refused(robot, why) ? 1 : 0;
      } else if (found->least > 0.2 && good < each && reaches_rim(robot)) {
        ++good;
        const bool is_bad = is_refused(robot, why);
        good_accepted += is_bad ? 0 : 1;
        if (is_bad) fmt::format_to(std::back_inserter(text), "{}: refused though sound: {}\n", like, why);
      }
    }
    fmt::format_to(std::back_inserter(text),
                   "{}: {} of {} singular refused ({} when tilted), {} of {} sound accepted\n", like, bad_refused, bad,
                   bad_tilted, good_accepted, good);
    singular += bad;
    refused += bad_refused;
    tilted += bad_tilted;
    sound += good;
    accepted += good_accepted;
  }
  RecordProperty("robots", text);
  EXPECT_GE(refused, 0.99 * singular) << text;
  EXPECT_EQ(accepted, sound) << text;
  EXPECT_GE(singular, 0.6 * each * static_cast<double>(kLike.size())) << text;
  EXPECT_GT(tilted, 0) << text;
}

}  // namespace
}  // namespace paracal::singularity_test
