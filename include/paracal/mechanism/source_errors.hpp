#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// The 14 reduced source errors of one limb, in the order of the paper's columns [huang2016, Eq. (4)].
/// Each is actual minus nominal, in mm or rad; docs/conventions.md has the figure of a limb that names them.
/// The enumerators are spelled as in every file and JSON key.
enum class Source : std::uint8_t {
  // Position group: they move the plate but do not tilt it; compensation removes their effect.
  theta_offset,  ///< encoder offset: the arm stands at theta + theta_offset when the controller believes theta
  e_x,           ///< base joint relative to plate joint, Delta b - Delta a, in the base frame
  e_y,
  e_z,
  arm_length,  ///< length of the arm (proximal link)
  alpha0,      ///< the limb's frame turned about its radial direction: actuator axis and, alike, the short side at the
               ///< plate
  beta0,       ///< the same about the vertical direction
  rod_mean,    ///< mean length of the two rods of the parallelogram
  // Tilt group: they make the parallelogram imperfect and tilt the plate; only tight parts remove their effect.
  rod_difference,    ///< length of rod 1 minus rod 2
  width_difference,  ///< width of the parallelogram at the elbow minus width at the plate
  alpha03,           ///< alpha0 minus its counterpart at the plate: twist between the two short sides
  beta03,            ///< beta0 minus its counterpart at the plate
  alpha2,            ///< the short side at the elbow turned about the arm
  beta2,             ///< the short side at the elbow turned about the normal of the arm
};

inline constexpr std::size_t kSourceCount = 14;
inline constexpr std::size_t kPositionSourceCount = 8;
inline constexpr std::size_t kTiltSourceCount = kSourceCount - kPositionSourceCount;

enum class Unit : std::uint8_t { mm, rad };

constexpr std::size_t index(Source source) { return static_cast<std::size_t>(source); }

/// Every source, in column order.
constexpr std::array<Source, kSourceCount> all_sources() {
  std::array<Source, kSourceCount> sources{};
  for (std::size_t k = 0; k < kSourceCount; ++k) sources[k] = static_cast<Source>(k);
  return sources;
}

/// True for the group that tilts the plate.
constexpr bool tilts_plate(Source source) { return index(source) >= kPositionSourceCount; }

/// Unit of the error inside the library. Files and JSON carry deg instead of rad.
Unit unit(Source source);

/// The name used in every file and JSON key, e.g. "theta_offset".
std::string_view name(Source source);

/// The source with that name; empty when there is none.
std::optional<Source> source_named(std::string_view name);

/// Source errors of all limbs: actual minus nominal, zero until set. Scalar is double, or an automatic-derivative type.
template <typename Scalar>
class BasicSourceErrors {
 public:
  /// @param limb  0 ... limb_count - 1 (files and messages count from 1).
  Scalar& operator()(std::size_t limb, Source source) { return values_[limb][index(source)]; }
  const Scalar& operator()(std::size_t limb, Source source) const { return values_[limb][index(source)]; }

 private:
  std::array<std::array<Scalar, kSourceCount>, kMaxLimbs> values_{};
};

using SourceErrors = BasicSourceErrors<double>;

/// The position group alone: the tilt group set to zero.
SourceErrors without_tilt_group(SourceErrors errors);

}  // namespace paracal
