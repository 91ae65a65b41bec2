#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "paracal/mechanism/pose.hpp"
#include "paracal/units.hpp"

namespace paracal {

/// The 14 reduced source errors of one limb with an arm or a carriage, in the order of the paper's columns [huang2016,
/// Eq. (4)]. Each is actual minus nominal, in mm or rad; docs/conventions.md has the figure of a limb that names them.
/// The enumerators are spelled as in every file and JSON key. A limb with one rod has a list of its own (sources_of),
/// in places of this one.
enum class Source : std::uint8_t {
  // Position group: they move the plate but do not tilt it; compensation removes their effect.
  theta_offset,  ///< joint zero: the actuator is at q + theta_offset for the commanded q; a length on a
                 ///< rail
  e_x,           ///< base joint relative to plate joint, Delta b - Delta a, in the base frame
  e_y,
  e_z,
  arm_length,  ///< length of the arm (proximal link); a rail has the gain of its drive instead
  alpha0,      ///< rotation of the limb's frame about its radial direction: actuator axis and short side at the
               ///< plate
  beta0,       ///< the same about the vertical direction; rail: inclination about the limb's tangent
  rod_mean,    ///< mean length of the two rods of the parallelogram
  // Tilt group: they make the parallelogram imperfect and tilt the plate; only tight tolerances reduce their effect.
  rod_difference,    ///< length of rod 1 minus rod 2
  width_difference,  ///< width of the parallelogram at the elbow minus width at the plate
  alpha03,           ///< alpha0 minus its counterpart at the plate: twist between the two short sides
  beta03,            ///< beta0 minus its counterpart at the plate
  alpha2,            ///< the short side at the elbow turned about the arm
  beta2,             ///< the short side at the elbow turned about the normal of the arm

  gain = arm_length,  ///< of a linear drive: mm of excess travel per metre

  // Of a limb with one rod. All their errors move the plate, and all can be compensated.
  normal = e_x,              ///< of a rail: offset along its upward normal
  across = e_y,              ///< of a rail: sideways offset
  rod_length = rod_mean,     ///< length of the one rod
  plate_x = rod_difference,  ///< plate joint, in the plate frame
  plate_y = width_difference,
  plate_z = alpha03,
};

/// Travel that `gain` refers to, mm.
inline constexpr double kGainLength = 1000.0;

inline constexpr std::size_t kSourceCount = 14;
inline constexpr std::size_t kPositionSourceCount = 8;
inline constexpr std::size_t kTiltSourceCount = kSourceCount - kPositionSourceCount;

/// The actuator of a limb. All limbs of a robot have the same kind.
enum class Actuator : std::uint8_t {
  revolute,  ///< a motor rotates an arm; joint coordinate: angle, rad
  linear,    ///< a carriage runs along a rail; joint coordinate: its height along the rail, mm
  strut,     ///< the limb is one rod that extends; joint coordinate: extension, mm
  crank,     ///< a motor rotates an arm with one rod; joint coordinate: angle, rad
  carriage,  ///< a carriage with one rod runs along a rail; joint coordinate: travel, mm
};

/// A plate on limbs with one rod each, as many as its degrees of freedom: compensation corrects all their errors.
constexpr bool on_single_rods(Actuator actuator) { return actuator >= Actuator::strut; }

/// The joint coordinate is the angle of an arm.
constexpr bool swings_arm(Actuator actuator) { return actuator == Actuator::revolute || actuator == Actuator::crank; }

/// The joint coordinate is a position on a rail.
constexpr bool runs_on_rail(Actuator actuator) {
  return actuator == Actuator::linear || actuator == Actuator::carriage;
}

/// Unit of a joint coordinate.
constexpr Unit joint_unit(Actuator actuator) { return swings_arm(actuator) ? Unit::rad : Unit::mm; }

constexpr std::size_t index(Source source) { return static_cast<std::size_t>(source); }

namespace detail {
inline constexpr std::array<Source, kSourceCount> kAllSources = [] {
  std::array<Source, kSourceCount> sources{};
  for (std::size_t k = 0; k < kSourceCount; ++k) sources[k] = static_cast<Source>(k);
  return sources;
}();

inline constexpr std::array kStrutSources{Source::theta_offset, Source::e_x,     Source::e_y,     Source::e_z,
                                          Source::gain,         Source::plate_x, Source::plate_y, Source::plate_z};
inline constexpr std::array kCrankSources{Source::theta_offset, Source::e_x,     Source::e_y,    Source::e_z,
                                          Source::arm_length,   Source::alpha0,  Source::beta0,  Source::rod_length,
                                          Source::plate_x,      Source::plate_y, Source::plate_z};
inline constexpr std::array kCarriageSources{Source::theta_offset, Source::normal, Source::across,     Source::gain,
                                             Source::alpha0,       Source::beta0,  Source::rod_length, Source::plate_x,
                                             Source::plate_y,      Source::plate_z};
}  // namespace detail

/// Every place of a source, in column order.
constexpr const std::array<Source, kSourceCount>& all_sources() { return detail::kAllSources; }

/// Those that a kind of limb has, in column order.
constexpr std::span<const Source> sources_of(Actuator actuator) {
  switch (actuator) {
    case Actuator::strut:
      return detail::kStrutSources;
    case Actuator::crank:
      return detail::kCrankSources;
    case Actuator::carriage:
      return detail::kCarriageSources;
    default:
      return detail::kAllSources;
  }
}

/// True for the group that tilts a level plate.
constexpr bool tilts_plate(Source source, Actuator actuator = Actuator::revolute) {
  return !on_single_rods(actuator) && index(source) >= kPositionSourceCount;
}

/// mm; for a robot that is not stated: no robot is larger.
inline constexpr double kLargestReach = 1e5;

/// Properties of a robot for reading tables: number and kind of its joint coordinates, and its reach. The
/// default applies to any robot.
struct JointSpace {
  JointSpace(std::size_t limbs = 0, Actuator kind = Actuator::revolute) : count(limbs), actuator(kind) {}
  std::size_t count;
  Actuator actuator;
  std::optional<double> guided_z = {};  ///< z of the plate, mm, if guides fix it: poses may omit it
  double reach = kLargestReach;         ///< mm; see Robot::reach()
};

/// Unit of the error inside the library: theta_offset has that of the joint coordinate. Files and JSON carry deg
/// instead of rad.
Unit unit(Source source, Actuator actuator);

/// Whether an error has an effect of its own. On a rail e_z has the same effect as theta_offset; a calibration fixes
/// it at zero. On a revolute limb all errors have.
constexpr bool is_felt(Source source, Actuator actuator) {
  if (on_single_rods(actuator)) return std::ranges::find(sources_of(actuator), source) != sources_of(actuator).end();
  return actuator == Actuator::revolute || source != Source::e_z;
}

/// The name used in every file and JSON key, e.g. "theta_offset"; of a rail "gain" in the place of "arm_length"; of a
/// limb with one rod "zero", "base_x", "gain", "plate_x", ...
std::string_view name(Source source, Actuator actuator = Actuator::revolute);

/// The source with that name; empty when that kind of limb has none.
std::optional<Source> source_named(std::string_view name, Actuator actuator);

/// The coordinates of a point share a tolerance and a key of files: "e" of e_x, e_y and e_z. Else the name itself.
std::string_view shared_name(Source source, Actuator actuator);

/// Which of the three it is, from 0; empty where the source is no coordinate of a point.
std::optional<std::size_t> coordinate(Source source, Actuator actuator);

/// The first source of its shared name.
inline bool is_leading(Source source, Actuator actuator) { return coordinate(source, actuator).value_or(0) == 0; }

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

SourceErrors operator+(SourceErrors one, const SourceErrors& other);
SourceErrors operator-(SourceErrors one, const SourceErrors& other);

/// The position group alone: the tilt group set to zero.
SourceErrors without_tilt_group(SourceErrors errors);

}  // namespace paracal
