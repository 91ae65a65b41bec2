#include "described_limbs.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

#include "paracal/error.hpp"
#include "paracal/mechanism/machine_impl.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

/// So that a point on an axis reads 0, and not 5e-15 or -0.
std::string numbers(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d tidy = (vector * 1e6).array().round() / 1e6 + 0.0;
  return fmt::format("({:g}, {:g}, {:g})", tidy.x(), tidy.y(), tidy.z());
}

std::string place(const Eigen::Vector3d& point) { return numbers(point) + " mm"; }

void require_direction(std::string_view quantity, const Eigen::Vector3d& vector) {
  if (vector.allFinite() && vector.norm() > 1e-9) return;
  throw InvalidArgument(fmt::format("{}: expected a direction, got {}", quantity, numbers(vector)));
}

/// An arm that turns about itself goes nowhere: this much of a right angle at least.
constexpr double kSquare = 0.1;

void check_drive(const LimbDescription& limb, std::size_t number) {
  const auto key = [&](std::string_view name) { return fmt::format("limb: {} of limb {}", name, number); };
  for (const LimbLength& one : lengths_of(limb.kind)) detail::require_positive_mm(key(one.key), limb.*one.member);
  if (limb.kind.has_harmonics != (limb.pitch > 0.0) || !std::isfinite(limb.pitch)) {
    const Unit unit = joint_unit(limb.kind);
    throw InvalidArgument(fmt::format("{}: expected more than 0 {}, got {:g}", key(pitch_key(limb.kind)),
                                      file_unit(unit), to_file_unit(unit, limb.pitch)));
  }
  for (const LimbDirection& one : directions_of(limb.kind)) require_direction(key(one.key), limb.*one.member);
  if (!swings_arm(limb.kind)) return;
  if (limb.axis.normalized().cross(limb.at_zero.normalized()).norm() > kSquare) return;
  throw InvalidArgument(fmt::format("{}: expected an arm that points away from its axis {}, got {}", key("arm_at_zero"),
                                    numbers(limb.axis), numbers(limb.at_zero)));
}

bool is_alike(const LimbDescription& one, const LimbDescription& other) {
  return one.base == other.base && one.plate == other.plate && one.axis == other.axis && one.at_zero == other.at_zero &&
         one.behind == other.behind;
}

void check_freedoms(const Limbs& limbs, const PlateFreedoms& freedoms, bool has_slide) {
  const std::size_t count = limbs.size(), wanted = freedoms.count() + (has_slide ? 1 : 0);
  if (const std::string why = coupled_motions(freedoms); !why.empty()) throw InvalidArgument("plate.freedoms: " + why);
  if (count < wanted || count > static_cast<std::size_t>(kMaxLimbs)) {
    const std::string of = freedoms.are_all() ? "six degrees of freedom" : "degrees of freedom " + in_words(freedoms);
    throw InvalidArgument(fmt::format("limb: expected {} to {} limbs for a plate with {}{}, got {}", wanted, kMaxLimbs,
                                      of, has_slide ? " and a slide" : "", count));
  }
  std::size_t rods = 0;
  for (const LimbDescription& limb : limbs) rods += limb.kind.rods;
  const std::size_t pairs = rods - count;
  if (has_slide && (pairs != count || count != 4)) {
    throw InvalidArgument("plate: expected no slide, or four limbs with two rods");
  }
  if (pairs > 0 && rods < (has_slide ? 7 : 6)) {
    throw InvalidArgument(fmt::format(
        "limb: expected 6 rods or more, because no guides hold a plate on limbs with two rods, got {}: add a limb, or "
        "give each limb one rod",
        rods));
  }
}

/// Both bars of a parallelogram stay parallel, so it lets a plate turn about their direction alone.
void check_parallelograms(const Limbs& limbs, const PlateFreedoms& freedoms) {
  constexpr double kParallel = 1e-6;  // sine
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    if (on_single_rods(limbs[i].kind)) continue;
    const Eigen::Vector3d bar = frame_of(limbs[i]).col(2);
    for (int k = 0; k < 3; ++k) {
      const auto coordinate = static_cast<std::size_t>(k) + 3;
      if (!freedoms.free[coordinate] || bar.cross(Eigen::Vector3d::Unit(k)).norm() < kParallel) continue;
      throw InvalidArgument(fmt::format(
          "plate.freedoms: expected no {} for limb {} with two rods: its bars lie along {} and keep the plate from "
          "turning about {}. Remove {}, or give this limb one rod (no parallelogram_width_mm)",
          kPlateCoordinates[coordinate], i + 1, numbers(bar), "xyz"[k], kPlateCoordinates[coordinate]));
    }
  }
}

/// Tables of joints have one unit.
void check_joint_units(const Limbs& limbs) {
  for (std::size_t i = 1; i < limbs.size(); ++i) {
    if (joint_unit(limbs[i].kind) == joint_unit(limbs[0].kind)) continue;
    throw InvalidArgument(fmt::format(
        "limb: expected joint coordinates of one unit (arms: deg; rails and struts: mm), got limb {} in {} beside limb "
        "1 in {}",
        i + 1, file_unit(joint_unit(limbs[i].kind)), file_unit(joint_unit(limbs[0].kind))));
  }
}

}  // namespace

namespace detail {

void require_positive_mm(std::string_view quantity, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InvalidArgument(fmt::format("{}: expected a length above 0 mm, got {} mm", quantity, value));
  }
}

std::vector<std::pair<std::string, double>> dimensions_of(const Limbs& limbs) {
  std::vector<std::pair<std::string, double>> all;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const LimbDescription& limb = limbs[i];
    const auto add = [&](std::string_view key, double length) {
      if (length != 0.0) all.emplace_back(fmt::format("limb: {} of limb {}", key, i + 1), length);
    };
    add("base_joint_mm", limb.base.norm());
    add("plate_joint_mm", limb.plate.norm());
    add(lengths_of(limb.kind).front().key, limb.length);
    add("arm_mm", limb.arm);
  }
  return all;
}

void check_described_limbs(const Limbs& limbs, const PlateFreedoms& freedoms, bool has_slide) {
  check_freedoms(limbs, freedoms, has_slide);
  check_joint_units(limbs);
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const LimbDescription& limb = limbs[i];
    if (!limb.base.allFinite() || !limb.plate.allFinite() ||
        !std::isfinite(limb.zero + limb.gain + limb.alpha0 + limb.beta0 + limb.turn_sine + limb.turn_cosine)) {
      throw InvalidArgument(fmt::format("limb: expected numbers for the joints of limb {}", i + 1));
    }
    check_drive(limb, i + 1);
    for (std::size_t j = 0; j < i; ++j) {
      if (!is_alike(limb, limbs[j])) continue;
      throw InvalidArgument(fmt::format("limb: expected different limbs, got limbs {} and {} both from {} to {}", j + 1,
                                        i + 1, place(limb.base), place(limb.plate)));
    }
  }
  check_parallelograms(limbs, freedoms);
}

void check_workspace_of_limbs(const Workspace& workspace, const PlateFreedoms& freedoms) {
  const double bottom = workspace.top_z - workspace.height;
  if (freedoms.holds_z() ? workspace.height != 0.0 : !(workspace.height > 0.0)) {
    throw InvalidArgument(
        fmt::format("workspace.{}: expected {}, got {:g} mm", workspace.keys().height,
                    freedoms.holds_z() ? "nothing or 0 for a plate that stays in its plane" : "a length above 0 mm",
                    workspace.height));
  }
  if (!std::isfinite(workspace.top_z) || !std::isfinite(bottom)) {
    throw InvalidArgument(
        fmt::format("workspace.{}: expected a number, got {} mm", workspace.keys().top, workspace.top_z));
  }
  if (!(workspace.max_tilt >= 0.0) || !(workspace.max_tilt < 0.5 * std::numbers::pi)) {
    throw InvalidArgument(fmt::format("workspace.tilt_deg: expected at least 0 and less than 90 deg, got {:g}",
                                      to_degrees(workspace.max_tilt)));
  }
  if (workspace.max_tilt > 0.0 && !freedoms.tilt()) {
    throw InvalidArgument("workspace.tilt_deg: expected nothing for a plate with the degrees of freedom " +
                          in_words(freedoms));
  }
}

}  // namespace detail

std::string in_words(const PlateFreedoms& freedoms) {
  std::string text;
  for (std::size_t k = 0; k < freedoms.free.size(); ++k) {
    if (freedoms.free[k]) text.append(text.empty() ? "" : ", ").append(kPlateCoordinates[k]);
  }
  return text;
}

std::string coupled_motions(const PlateFreedoms& freedoms) {
  if (freedoms.free[0] && freedoms.free[1]) return "";
  return fmt::format(
      "expected x and y among plate.freedoms, got {}: paracal describes plates that move at least along x and y. State "
      "a robot in an upright plane with x and y in this plane. There is no robot file for a plate that guides hold "
      "along x or y, or that moves sideways when it tilts (3-RPS, Agile Eye)",
      in_words(freedoms));
}

}  // namespace paracal
