#include "paracal/mechanism/robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "described_limbs.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/machine_impl.hpp"
#include "paracal/mechanism/plausible.hpp"
#include "paracal/units.hpp"
#include "singularity.hpp"

namespace paracal {
namespace {

using detail::require_positive_mm;

/// What a refusal calls it, and mm.
using Dimension = std::pair<std::string, double>;

std::vector<Dimension> dimensions_of(const RobotDescription& robot) {
  const std::optional<SharedDimensions> shared = shared_dimensions(robot.limbs);
  if (!shared) return detail::dimensions_of(robot.limbs);
  std::vector<Dimension> all{{"geometry.base_radius_mm", shared->base_radius},
                             {"geometry.plate_radius_mm", shared->plate_radius},
                             {"geometry.rod_mm", shared->rod},
                             {"geometry.parallelogram_width_mm", shared->parallelogram_width}};
  if (shared->arm != 0.0) all.emplace_back("geometry.arm_mm", shared->arm);
  if (robot.slide) all.emplace_back("plate.pinion_radius_mm", robot.slide->pinion_radius);
  return all;
}

/// One that is no dimension beside the others is a slip of the pen.
void check_proportions(const RobotDescription& robot) {
  std::vector<Dimension> all = dimensions_of(robot);
  std::vector<double> lengths(all.size());
  std::ranges::transform(all, lengths.begin(), &Dimension::second);
  const plausible::Range range = plausible::dimension(std::move(lengths));
  const auto check = [&](const std::string& name, double length) {
    if (const auto complaint = plausible::complaint("a length", length, range)) {
      throw InvalidArgument(fmt::format("{}: {}", name, *complaint));
    }
  };
  for (const auto& [name, length] : all) check(name, length);
  const Workspace& workspace = robot.workspace;
  const auto [radius, height, top] = workspace.keys();
  check(fmt::format("workspace.{}", radius), workspace.radius);
  if (!workspace.is_flat()) check(fmt::format("workspace.{}", height), workspace.height);
  if (workspace.top_z != 0.0) check(fmt::format("workspace.{}", top), std::abs(workspace.top_z));
}

void check_slide(Slide& slide, std::size_t limbs) {
  require_positive_mm("plate.pinion_radius_mm", slide.pinion_radius);
  if (!slide.axis.allFinite() || slide.axis.norm() < 1e-9) {
    throw InvalidArgument(fmt::format("plate.slide_axis: expected a direction, got [{}, {}, {}]", slide.axis.x(),
                                      slide.axis.y(), slide.axis.z()));
  }
  slide.axis.normalize();
  if (slide.sign.size() != limbs) {
    throw InvalidArgument(
        fmt::format("plate.slide_sign: expected one sign per limb ({}), got {}", limbs, slide.sign.size()));
  }
  double sum = 0.0;
  for (const double sign : slide.sign) {
    if (std::abs(sign) != 1.0) {
      throw InvalidArgument(fmt::format("plate.slide_sign: expected +1 or -1, got {}", sign));
    }
    sum += sign;
  }
  if (std::abs(sum) == static_cast<double>(limbs)) {
    throw InvalidArgument("plate.slide_sign: expected both signs, got one (the slide would only shift the plate)");
  }
}

void check_rotation(const Workspace& workspace, bool has_slide) {
  const double low = to_degrees(workspace.min_rotation), high = to_degrees(workspace.max_rotation);
  if (!(low <= high) || !std::isfinite(low) || !std::isfinite(high)) {
    throw InvalidArgument(
        fmt::format("workspace.rotation_deg: expected [smallest, largest], got [{:g}, {:g}] deg", low, high));
  }
  if (!has_slide && (low != 0.0 || high != 0.0)) {
    throw InvalidArgument(fmt::format(
        "workspace.rotation_deg: expected [0, 0] or nothing for a plate without a slide, got [{:g}, {:g}] deg", low,
        high));
  }
}

void check_workspace(const RobotDescription& robot) {
  robot.workspace.check_shape();
  check_rotation(robot.workspace, robot.slide.has_value());
  detail::check_workspace_of_limbs(robot.workspace, robot.freedoms);
}

void check_tolerances(const Tolerances& tolerances, const Limbs& limbs) {
  for (const Source source : sources_of(limbs)) {
    const double half_width = tolerances[source], limit = largest_error(limbs, source);
    if (half_width >= 0.0 && half_width < limit) continue;
    throw InvalidArgument(fmt::format("tolerances.{}: expected a half-width of at least 0 and below {:.4g}, got {}",
                                      name(source), limit, half_width));
  }
}

/// Of those with harmonics.
double least_pitch(const Limbs& limbs) {
  double least = HUGE_VAL;
  for (const LimbDescription& limb : limbs) {
    if (limb.kind.has_harmonics) least = std::min(least, limb.pitch);
  }
  return least;
}

/// @param number  of the limb, from 0.
std::optional<std::string> absurd_length(const LimbDescription& limb, const SourceErrors& errors, std::size_t number) {
  const auto error = [&](Source source) { return errors(number, source); };
  for (const LimbLength& one : lengths_of(limb.kind)) {
    double value = limb.*one.member + error(one.error);
    if (is_joint_zero(one.error)) value += limb.zero;
    if (one.error == "rod_mean") value -= 0.5 * std::abs(error("rod_difference"));  // of the shorter rod
    if (!(value > 0.0))
      return fmt::format("expected {} of limb {} longer than 0 mm, got {:g} mm", one.words, number + 1, value);
  }
  const double travel = kGainLength + limb.gain + error("gain");
  if (travel > 0.0) return std::nullopt;
  return fmt::format("expected the drive of limb {} to move in the direction of its joint, got {:g} mm/m", number + 1,
                     travel);
}

void check_parts(RobotDescription& robot) {
  const bool has_slide = robot.slide.has_value();
  detail::check_described_limbs(robot.limbs, robot.freedoms, has_slide);
  for (std::size_t limb = 0; limb < robot.limbs.size(); ++limb) {
    if (auto complaint = absurd_length(robot.limbs[limb], SourceErrors{}, limb)) {
      throw InvalidArgument(fmt::format("limb: {}", *complaint));
    }
  }
  if (has_slide) check_slide(*robot.slide, robot.limbs.size());
}

/// See BasicMachine::hang.
Eigen::Vector3d hang_of(const Machine& machine) {
  constexpr double kAmong = 0.25;  // of a rod: nearer to the mean of their upper ends the plate is among them
  Eigen::Vector3d from_ends = Eigen::Vector3d::Zero();
  double rod = 0.0;
  const double share = 1.0 / static_cast<double>(machine.limb_count);
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const Eigen::Vector3d joint = machine.range.centre + as_eigen(limb.plate);
    const auto ends = ends_at<1>(limb, joint_to(limb, joint));
    from_ends += share * (joint - as_eigen(ends.elbow.centre));
    rod += share * ends.length[0];
  }
  if (from_ends.norm() < kAmong * rod) return Eigen::Vector3d::Zero();
  return from_ends.normalized();
}

DifferentiableMachine checked_nominal(RobotDescription& description) {
  if (description.name.empty()) throw InvalidArgument("name: expected a name, got an empty one");
  if (!control_character(description.name).empty())
    throw InvalidArgument("name: expected text, got a control character in it");
  check_parts(description);
  const PlateFreedoms& freedoms = description.freedoms;
  description.workspace.tilts_about = {freedoms.free[3], freedoms.free[4], freedoms.free[5]};
  check_workspace(description);
  check_proportions(description);
  if (description.tolerances) check_tolerances(*description.tolerances, description.limbs);
  if (!description.controller_origin.allFinite()) throw InvalidArgument("controller.origin_mm: expected numbers");
  const auto is_limit = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (const auto& limits = description.joint_limits;
      limits && !(is_limit(limits->speed) && is_limit(limits->acceleration))) {
    throw InvalidArgument("joints: expected a largest speed and acceleration above 0");
  }
  const Machine nominal = build(description, SourceErrors{});
  detail::check_closure(nominal, description);
  description.hang = hang_of(nominal);
  return differentiable(description, SourceErrors{});
}

std::optional<std::string> absurd_error(const Robot& robot, const SourceErrors& errors, std::size_t limb) {
  for (const Source source : sources_of(robot.nominal().limbs[limb].actuator)) {
    const double value = errors(limb, source);
    const Unit inside = unit(source, robot.actuator());
    const double limit = largest_error(robot.limbs(), source);
    if (std::abs(value) < limit) continue;
    return fmt::format("expected {} of limb {} within {:g} {}, got {:g}", name(source), limb + 1,
                       to_file_unit(inside, limit), file_unit(inside), to_file_unit(inside, value));
  }
  return std::nullopt;
}

/// mm that an angle of the drive counts for: L, or the rod of a limb on a rail, whose arm may be short or none.
double angle_lever(const Limb& limb) { return runs_on_rail(limb.actuator) ? limb.mean_rod() : limb.arm; }

/// See Parameter: limbs of one kind all count by the first.
double lever_of(const Limbs& limbs, const Machine& nominal, std::size_t number, Source source) {
  const Actuator kind = nominal.limbs[number].actuator, first = nominal.actuator();
  const Limb& limb = nominal.limbs[kind.drive == first.drive && kind.rods == first.rods ? 0 : number];
  if (tilts_plate(source) && unit(source, limb.actuator) == Unit::mm) return 1.0 / sizes_of(limbs).parallelogram_width;
  if (tilts_plate(source) || unit(source, limb.actuator) != Unit::rad) return 1.0;
  return source.unit() ? angle_lever(limb) : joint_ratio(limb);
}

/// What a limb is to the plate, at two joint coordinates: ends and lengths of its rods, mm.
Eigen::Matrix<double, 16, 1> shape_of(const Limb& limb) {
  Eigen::Matrix<double, 16, 1> shape;
  Eigen::Index at = 0;
  for (const double joint : {0.3, 0.7}) {
    const auto ends = ends_at(limb, joint);
    shape.segment<3>(at) = as_eigen(ends.elbow.centre);
    shape.segment<3>(at + 3) = as_eigen(ends.place[0]) - as_eigen(ends.place[1]);
    shape(at + 6) = ends.length[0];
    shape(at + 7) = ends.length[1];
    at += 8;
  }
  return shape;
}

/// See Parameter::as_joint_zero: by differences of the shape of the limb and of its bar at the plate.
double as_joint_zero(const RobotDescription& robot, std::size_t limb, Source zero, Source source) {
  constexpr double kStep = 1e-4, kAlike = 1e-6;
  const auto change = [&](Source moved) {
    SourceErrors plus, minus;
    plus(limb, moved) = kStep;
    minus(limb, moved) = -kStep;
    const Limb one = build(robot, plus).limbs[limb], other = build(robot, minus).limbs[limb];
    Eigen::Matrix<double, 22, 1> both;
    both << shape_of(one) - shape_of(other), as_eigen(one.plate) - as_eigen(other.plate),
        2.0 * (as_eigen(one.plate_half) - as_eigen(other.plate_half));
    return Eigen::Matrix<double, 22, 1>(both / (2.0 * kStep));
  };
  const auto of_zero = change(zero), of_source = change(source);
  const double share = of_source.dot(of_zero) / of_zero.squaredNorm();
  const bool alike =
      source != zero && !is_harmonic(source) && (of_source - share * of_zero).norm() < kAlike * of_source.norm();
  return alike ? share : 0.0;
}

std::vector<Parameter> parameters_of(const RobotDescription& robot, const Machine& nominal) {
  const Tolerances tolerances = robot.tolerances.value_or(generous_tolerances(robot.limbs));
  std::vector<Parameter> all;
  for (std::size_t limb = 0; limb < nominal.limb_count; ++limb) {
    const Actuator kind = nominal.limbs[limb].actuator;
    for (const Source source : sources_of(kind)) {
      all.push_back({.source = source,
                     .limb = limb,
                     .unit = unit(source, kind),
                     .lever = lever_of(robot.limbs, nominal, limb, source),
                     .tolerance = tolerances[source],
                     .as_joint_zero = as_joint_zero(robot, limb, joint_zero(kind), source),
                     .number = number_of(limb, source)});
    }
  }
  return all;
}

}  // namespace

Robot::Robot(RobotDescription description)
    : description_(std::move(description)),
      nominal_(checked_nominal(description_)),
      parameters_(parameters_of(description_, nominal_)) {}

const Parameter& Robot::parameter(std::size_t limb, Source source) const {
  if (limb < limb_count() && has(nominal_.limbs[limb].actuator, source)) {
    return parameters_[nominal_.parameter(limb, source)];
  }
  throw InvalidArgument(
      fmt::format("expected an error of limb {} of {}, got {}", limb + 1, description_.name, source.name()));
}

JointSpace Robot::joint_space() const {
  JointSpace joints(limb_count(), actuator());
  std::ranges::copy(kinds_of(limbs()), joints.kinds.begin());
  if (nominal_.has_guides && freedoms().holds_z()) joints.guided_z = nominal_.guided_z;
  joints.reach = reach();
  return joints;
}

double Robot::reach() const {
  const LimbSizes sizes = sizes_of(limbs());
  return std::max(sizes.base_radius + sizes.arm + sizes.rod + sizes.plate_radius, workspace().farthest());
}

double largest_error(const Limbs& limbs, Source source) {
  if (is_harmonic(source)) return kSteepestDrive * least_pitch(limbs) / (2.0 * std::numbers::pi);
  const Unit inside = unit(source, actuator_of(limbs));
  if (inside == Unit::rad) return std::numbers::pi;
  if (inside == Unit::mm_per_m) return kGainLength;
  const LimbSizes sizes = sizes_of(limbs);
  return sizes.base_radius + std::abs(sizes.arm) + std::abs(sizes.rod);  // before they are checked, too
}

std::optional<std::string> implausible(const Robot& robot, const SourceErrors& errors) {
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    if (auto complaint = absurd_error(robot, errors, limb)) return complaint;
    if (auto complaint = absurd_length(robot.limbs()[limb], errors, limb)) return complaint;
  }
  return std::nullopt;
}

Tolerances tolerances_of(const Robot& robot) { return robot.tolerances().value_or(generous_tolerances(robot.limbs())); }

}  // namespace paracal
