#include "dimensions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "paracal/mechanism/base_motion.hpp"

namespace paracal::detail {
namespace {

/// Component of an error that all limbs have alike.
template <typename Value>
SourceErrors alike(const Robot& robot, Value&& value) {
  SourceErrors errors;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) value(limb, errors);
  return errors;
}

SourceErrors radial(const Robot& robot, double sign) {
  return alike(robot, [&](std::size_t limb, SourceErrors& errors) {
    shift_limb(robot, limb, sign * radial_of(robot.limbs()[limb]), errors);
  });
}

SourceErrors each(const Robot& robot, Source source) {
  return alike(robot, [&](std::size_t limb, SourceErrors& errors) { errors(limb, source) = 1.0; });
}

/// A longer arm of a carriage takes its elbow inward.
SourceErrors longer_arm(const Robot& robot) {
  if (has(robot.actuator(), "arm_length")) return each(robot, "arm_length");
  return alike(robot, [&](std::size_t limb, SourceErrors& errors) {
    shift_limb(robot, limb, -as_eigen(robot.nominal().limbs[limb].radial), errors);
  });
}

/// Of a base joint from where all that are alike stand.
Eigen::Vector3d shift_of(const SharedDimensions& shared, std::size_t limb) {
  const SourceErrors& differences = shared.differences;
  return {differences(limb, "e_x"), differences(limb, "e_y"), differences(limb, "e_z")};
}

SourceErrors only_limb(const SourceErrors& all, std::size_t limb) {
  SourceErrors one;
  for (const Source source : all_sources()) one(limb, source) = all(limb, source);
  return one;
}

/// A length of a limb with dimensions of its own.
Dimension length_of_limb(const Robot& robot, const LimbLength& length, std::size_t limb) {
  return {fmt::format("{} of limb {}", length.key, limb + 1), false,
          [limb, length](const RobotDescription& r) { return r.limbs[limb].*length.member; },
          [limb, length](RobotDescription& r, double value) { r.limbs[limb].*length.member = value; },
          only_limb(each(robot, length.error), limb)};
}

/// What is off by `direction` where a number of the short form is wrong.
Dimension shared_number(std::string key, bool angle, std::function<double&(SharedDimensions&)> number,
                        SourceErrors direction) {
  return {.key = std::move(key),
          .angle = angle,
          .value =
              [number](const RobotDescription& r) {
                SharedDimensions shared = *shared_dimensions(r.limbs);
                return number(shared);
              },
          .set =
              [number](RobotDescription& r, double value) {
                SharedDimensions shared = *shared_dimensions(r.limbs);
                number(shared) = value;
                r.limbs = limbs_of(shared);
              },
          .direction = direction};
}

Dimension shared_length(std::string key, double SharedDimensions::*length, const SourceErrors& direction) {
  return shared_number(
      std::move(key), false, [length](SharedDimensions& shared) -> double& { return shared.*length; }, direction);
}

/// A rod or an arm of another length.
std::vector<Dimension> lengths_of_limbs(const Robot& robot) {
  std::vector<Dimension> all;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const LimbLength& one : lengths_of(robot.limbs()[limb].kind)) {
      if (!tilts_plate(one.error)) all.push_back(length_of_limb(robot, one, limb));
    }
  }
  return all;
}

}  // namespace

std::vector<Dimension> dimensions_of_all_limbs(const Robot& robot) {
  if (!shared_dimensions(robot.limbs())) return {};
  return {shared_length("rod_mm", &SharedDimensions::rod, each(robot, "rod_mean")),
          shared_length("arm_mm", &SharedDimensions::arm, longer_arm(robot)),
          shared_length("base_radius_mm", &SharedDimensions::base_radius, radial(robot, 1.0)),
          shared_length("plate_radius_mm", &SharedDimensions::plate_radius, radial(robot, -1.0))};
}

std::vector<Dimension> dimensions(const Robot& robot) {
  const std::optional<SharedDimensions> shared = shared_dimensions(robot.limbs());
  if (!shared) return lengths_of_limbs(robot);
  std::vector<Dimension> all = dimensions_of_all_limbs(robot);
  SourceErrors turned = turned_base(robot, Eigen::Vector3d::UnitZ());
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    shift_limb(robot, limb, -Eigen::Vector3d::UnitZ().cross(shift_of(*shared, limb)), turned);  // e does not turn
    all.push_back(shared_number(
        fmt::format("limb_azimuth_deg of limb {}", limb + 1), true,
        [limb](SharedDimensions& numbers) -> double& { return numbers.limb_azimuth[limb]; }, only_limb(turned, limb)));
  }
  return all;
}

Dimension pinion_radius() {
  return {"pinion_radius_mm", false, [](const RobotDescription& r) { return r.slide->pinion_radius; },
          [](RobotDescription& r, double value) { r.slide->pinion_radius = value; }};
}

SourceErrors larger_robot(const Robot& robot) {
  SourceErrors larger;
  for (const Dimension& one : dimensions_of_all_limbs(robot)) {
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : sources_of(robot.actuator()))
        larger(limb, source) += now(robot, one) * one.direction(limb, source);
    }
  }
  return larger;
}

Robot with(const Robot& robot, const Dimension& dimension, double value) {
  RobotDescription description = robot.description();
  description.tolerances = tolerances_of(robot);
  description.workspace = robot.workspace().about_centre(1.0);
  dimension.set(description, value);
  return Robot(std::move(description));
}

double now(const Robot& robot, const Dimension& dimension) { return dimension.value(robot.description()); }

}  // namespace paracal::detail
