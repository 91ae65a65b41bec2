// The short form of a robot file; see limb_description.hpp.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "described_limbs.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/limb_description.hpp"
#include "paracal/mechanism/machine_impl.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

using detail::require_positive_mm;

constexpr double kSmallestAzimuthGap = std::numbers::pi / 180.0;

void check_lengths(const SharedDimensions& shared) {
  require_positive_mm("geometry.base_radius_mm", shared.base_radius);
  require_positive_mm("geometry.plate_radius_mm", shared.plate_radius);
  if (swings_arm(shared.actuator) || shared.arm != 0.0) require_positive_mm("geometry.arm_mm", shared.arm);
  require_positive_mm("geometry.rod_mm", shared.rod);
  require_positive_mm("geometry.parallelogram_width_mm", shared.parallelogram_width);
}

void check_azimuths(const std::vector<double>& azimuth) {
  if (azimuth.size() > kMaxLimbs) {
    throw InvalidArgument(
        fmt::format("geometry.limb_azimuth_deg: expected at most {} limbs, got {}", kMaxLimbs, azimuth.size()));
  }
  for (std::size_t i = 0; i < azimuth.size(); ++i) {
    if (!std::isfinite(azimuth[i])) {
      throw InvalidArgument(fmt::format("geometry.limb_azimuth_deg: expected a number for limb {}, got {}", i + 1,
                                        to_degrees(azimuth[i])));
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double gap = std::abs(std::remainder(azimuth[i] - azimuth[j], 2.0 * std::numbers::pi));
      if (gap < kSmallestAzimuthGap) {
        throw InvalidArgument(fmt::format(
            "geometry.limb_azimuth_deg: expected at least {4:g} deg between limbs, got limbs {0} and {1} at "
            "{2:g} and {3:g} deg",
            j + 1, i + 1, to_degrees(azimuth[j]), to_degrees(azimuth[i]), to_degrees(kSmallestAzimuthGap)));
      }
    }
  }
}

/// Without what sums and rotations have rounded, so that 200 mm are 200 mm again.
double tidy(double value) {
  constexpr double kPerMm = 1e11;
  return std::round(value * kPerMm) / kPerMm + 0.0;  // no -0
}

/// The value that most limbs have; the first of several.
double most_common(const Limbs& limbs, auto&& value_of) {
  std::vector<double> values(limbs.size());
  std::ranges::transform(limbs, values.begin(), value_of);
  return *std::ranges::max_element(values, {}, [&](double value) { return std::ranges::count(values, value); });
}

/// From z to a joint, where the limb stands.
double radius_of(const LimbDescription& limb, const Eigen::Vector3d& joint) {
  return tidy(joint.dot(detail::nominal_frame(azimuth_of(limb)).col(0)));
}

/// What a limb differs in from those that are alike.
void add_differences(const LimbDescription& limb, const LimbDescription& alike, std::size_t number,
                     SourceErrors& differences) {
  const Eigen::Vector3d shift = limb.base - alike.base;
  differences(number, "e_x") = tidy(shift.x());
  differences(number, "e_y") = tidy(shift.y());
  differences(number, "e_z") = tidy(shift.z());
  differences(number, "rod_mean") = tidy(limb.length - alike.length);
  if (has(limb.kind, "arm_length")) differences(number, "arm_length") = tidy(limb.arm - alike.arm);
  differences(number, "theta_offset") = limb.zero;
  differences(number, "gain") = limb.gain;
  differences(number, "alpha0") = limb.alpha0;
  differences(number, "beta0") = limb.beta0;
  differences(number, "turn_sine") = limb.turn_sine;
  differences(number, "turn_cosine") = limb.turn_cosine;
}

Limbs alike_limbs(const SharedDimensions& shared) {
  Limbs limbs;
  for (const double azimuth : shared.limb_azimuth) {
    const Eigen::Matrix3d frame = detail::nominal_frame(azimuth);
    const bool swings = swings_arm(shared.actuator);
    const LimbDescription limb{.base = shared.base_radius * frame.col(0),
                               .plate = shared.plate_radius * frame.col(0),
                               .length = shared.rod,
                               .arm = shared.arm,
                               .axis = frame.col(swings ? 2 : 1),
                               .at_zero = frame.col(0),
                               .kind = shared.actuator,
                               .width = shared.parallelogram_width,
                               .azimuth = azimuth};
    limbs.push_back(with_pitch(limb, shared.pitch));
  }
  return limbs;
}

/// Other differences than those that the short form can state.
bool is_like(const LimbDescription& limb, const LimbDescription& other) {
  constexpr double kAlike = 1e-9;  // mm
  return limb.kind == other.kind && limb.pitch == other.pitch && limb.width == other.width && !limb.behind &&
         (limb.plate - other.plate).norm() < kAlike && (has(limb.kind, "arm_length") || limb.arm == other.arm);
}

}  // namespace

Limbs limbs_of(const SharedDimensions& shared) {
  check_lengths(shared);
  check_azimuths(shared.limb_azimuth);
  return with_errors(alike_limbs(shared), shared.differences);
}

std::optional<SharedDimensions> shared_dimensions(const Limbs& limbs) {
  if (!std::ranges::all_of(limbs, [](const LimbDescription& limb) { return limb.azimuth.has_value(); })) return {};
  const auto radius = [](Eigen::Vector3d LimbDescription::*joint) {
    return [joint](const LimbDescription& limb) { return radius_of(limb, limb.*joint); };
  };
  SharedDimensions shared{.base_radius = most_common(limbs, radius(&LimbDescription::base)),
                          .plate_radius = most_common(limbs, radius(&LimbDescription::plate)),
                          .arm = most_common(limbs, std::mem_fn(&LimbDescription::arm)),
                          .rod = most_common(limbs, std::mem_fn(&LimbDescription::length)),
                          .parallelogram_width = limbs.front().width,
                          .actuator = limbs.front().kind,
                          .pitch = limbs.front().pitch};
  for (const LimbDescription& limb : limbs) shared.limb_azimuth.push_back(*limb.azimuth);
  const Limbs alike = alike_limbs(shared);
  if (!std::ranges::equal(limbs, alike, is_like)) return {};
  for (std::size_t i = 0; i < limbs.size(); ++i) add_differences(limbs[i], alike[i], i, shared.differences);
  return shared;
}

}  // namespace paracal
