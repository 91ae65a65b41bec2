#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "paracal/mechanism/limb_closure.hpp"
#include "paracal/mechanism/pose.hpp"
#include "paracal/units.hpp"

namespace paracal {

/// What an error does to the plate.
enum class ErrorGroup : std::uint8_t {
  position,  ///< moves the plate without tilting it; compensation removes the effect
  tilt,      ///< makes a parallelogram imperfect and tilts the plate; only tight tolerances reduce the effect
};

namespace detail {

/// A name of geometric errors, in whatever limbs have one.
struct NamedError {
  std::string_view name;
  /// Empty where it is the unit of the joint coordinate.
  std::optional<Unit> unit;
  ErrorGroup group = ErrorGroup::position;
  /// Which of a limb's 14 reserved random numbers draws it; empty: number_of() makes one from the name.
  std::optional<std::uint64_t> reserved;
};

/// Every name, in the order of the paper's columns [huang2016, Eq. (4)]. docs/conventions.md has figures.
inline constexpr std::array kNamedErrors{
    // Limbs with two rods.
    NamedError{
        "theta_offset", {}, ErrorGroup::position, 0},  // joint zero: the drive is at q + theta_offset for q commanded
    NamedError{"e_x", Unit::mm, ErrorGroup::position, 1},  // joint at the base relative to that at the plate, in {O}
    NamedError{"e_y", Unit::mm, ErrorGroup::position, 2},
    NamedError{"e_z", Unit::mm, ErrorGroup::position, 3},
    NamedError{"arm_length", Unit::mm, ErrorGroup::position, 4},
    NamedError{"alpha0", Unit::rad, ErrorGroup::position, 5},  // frame of the limb about its radial direction
    NamedError{"beta0", Unit::rad, ErrorGroup::position,
               6},  // about the vertical direction; of a rail about the tangent
    NamedError{"rod_mean", Unit::mm, ErrorGroup::position, 7},
    NamedError{"rod_difference", Unit::mm, ErrorGroup::tilt, 8},    // rod 1 minus rod 2
    NamedError{"width_difference", Unit::mm, ErrorGroup::tilt, 9},  // short side at the elbow minus that at the plate
    NamedError{"alpha03", Unit::rad, ErrorGroup::tilt, 10},         // alpha0 minus its counterpart at the plate
    NamedError{"beta03", Unit::rad, ErrorGroup::tilt, 11},          // beta0 minus its counterpart at the plate
    NamedError{"alpha2", Unit::rad, ErrorGroup::tilt, 12},          // short side at the elbow about the arm
    NamedError{"beta2", Unit::rad, ErrorGroup::tilt, 13},           // about the normal of the arm
    NamedError{"gain", Unit::mm_per_m, ErrorGroup::position, 4},    // of a linear drive: excess travel
    // Limbs with one rod: all their errors move the plate, and all can be compensated.
    NamedError{"zero", {}, ErrorGroup::position, 0},
    NamedError{"base_x", Unit::mm, ErrorGroup::position, 1},
    NamedError{"base_y", Unit::mm, ErrorGroup::position, 2},
    NamedError{"base_z", Unit::mm, ErrorGroup::position, 3},
    NamedError{"normal", Unit::mm, ErrorGroup::position, 1},  // of a rail: offset along its upward normal
    NamedError{"across", Unit::mm, ErrorGroup::position, 2},  // of a rail: sideways
    NamedError{"rod_length", Unit::mm, ErrorGroup::position, 7},
    NamedError{"plate_x", Unit::mm, ErrorGroup::position, 8},  // joint at the plate, in the plate frame
    NamedError{"plate_y", Unit::mm, ErrorGroup::position, 9},
    NamedError{"plate_z", Unit::mm, ErrorGroup::position, 10},
    // Limbs whose file states the pitch of their screw or encoder: what repeats with each of its turns.
    NamedError{"turn_sine", {}, ErrorGroup::position, {}},
    NamedError{"turn_cosine", {}, ErrorGroup::position, {}},
};

constexpr auto every_source();

}  // namespace detail

/// A source error by its name: actual minus nominal, in mm, rad or mm/m. A name that does not exist does not compile.
class Source {
 public:
  consteval Source(const char* name) : Source(place_of(name)) {}

  constexpr std::string_view name() const { return entry().name; }
  constexpr ErrorGroup group() const { return entry().group; }
  /// Empty where it is the unit of the joint coordinate.
  constexpr std::optional<Unit> unit() const { return entry().unit; }
  constexpr std::optional<std::uint64_t> reserved() const { return entry().reserved; }
  /// Place among all names.
  constexpr std::size_t index() const { return place_; }
  auto operator<=>(const Source&) const = default;

 private:
  friend constexpr auto detail::every_source();
  explicit constexpr Source(std::size_t place) : place_(static_cast<std::uint8_t>(place)) {}
  constexpr const detail::NamedError& entry() const { return detail::kNamedErrors[place_]; }
  static constexpr std::size_t place_of(std::string_view name) {
    for (std::size_t k = 0; k < detail::kNamedErrors.size(); ++k) {
      if (detail::kNamedErrors[k].name == name) return k;
    }
    throw "no source error has this name";
  }

  std::uint8_t place_;
};

inline constexpr std::size_t kSourceNames = detail::kNamedErrors.size();

namespace detail {
constexpr auto every_source() {
  return []<std::size_t... k>(std::index_sequence<k...>) { return std::array<Source, kSourceNames>{Source(k)...}; }
  (std::make_index_sequence<kSourceNames>());
}
inline constexpr std::array<Source, kSourceNames> kEverySource = every_source();

/// The list of a kind of limb, in column order, with what only limbs with harmonics have.
template <std::size_t Count>
consteval auto with_harmonics(const std::array<Source, Count>& own) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) {
    return std::array<Source, Count + 2>{own[k]..., "turn_sine", "turn_cosine"};
  }
  (std::make_index_sequence<Count>());
}

/// The lists of each kind of limb; the joint zero comes first.
inline constexpr auto kRevoluteSources =
    with_harmonics<14>({"theta_offset", "e_x", "e_y", "e_z", "arm_length", "alpha0", "beta0", "rod_mean",
                        "rod_difference", "width_difference", "alpha03", "beta03", "alpha2", "beta2"});
inline constexpr auto kLinearSources =
    with_harmonics<14>({"theta_offset", "e_x", "e_y", "e_z", "gain", "alpha0", "beta0", "rod_mean", "rod_difference",
                        "width_difference", "alpha03", "beta03", "alpha2", "beta2"});
inline constexpr auto kStrutSources =
    with_harmonics<8>({"zero", "base_x", "base_y", "base_z", "gain", "plate_x", "plate_y", "plate_z"});
inline constexpr auto kCrankSources = with_harmonics<11>({"zero", "base_x", "base_y", "base_z", "arm_length", "alpha0",
                                                          "beta0", "rod_length", "plate_x", "plate_y", "plate_z"});
inline constexpr auto kCarriageSources = with_harmonics<10>(
    {"zero", "normal", "across", "gain", "alpha0", "beta0", "rod_length", "plate_x", "plate_y", "plate_z"});
}  // namespace detail

/// Every name, whichever limbs have it.
constexpr std::span<const Source> all_sources() { return detail::kEverySource; }

constexpr std::size_t index(Source source) { return source.index(); }
constexpr std::string_view name(Source source) { return source.name(); }
constexpr bool tilts_plate(Source source) { return source.group() == ErrorGroup::tilt; }

/// A value for each name.
template <typename Value>
struct BySource {
  std::array<Value, kSourceNames> values{};

  constexpr Value& operator[](Source source) { return values[source.index()]; }
  constexpr const Value& operator[](Source source) const { return values[source.index()]; }
  constexpr auto begin() { return values.begin(); }
  constexpr auto begin() const { return values.begin(); }
  constexpr auto end() { return values.end(); }
  constexpr auto end() const { return values.end(); }
};

/// Travel that `gain` refers to, mm.
inline constexpr double kGainLength = 1000.0;

/// The kind of a limb: what its joint moves, and how many rods hang on that.
struct Actuator {
  Drive drive = Drive::strut;
  std::uint8_t rods = 1;       ///< 1, or 2 of a parallelogram
  bool has_harmonics = false;  ///< its file states a pitch (LimbDescription): turn_sine and turn_cosine are its errors

  friend constexpr bool operator==(const Actuator&, const Actuator&) = default;
  static const Actuator revolute, linear;        ///< an arm or a rail with a parallelogram
  static const Actuator strut, crank, carriage;  ///< the limb is a rod that extends; an arm or a rail with one rod
};
inline constexpr Actuator Actuator::revolute{Drive::arm, 2};
inline constexpr Actuator Actuator::linear{Drive::rail, 2};
inline constexpr Actuator Actuator::strut{Drive::strut, 1};
inline constexpr Actuator Actuator::crank{Drive::arm, 1};
inline constexpr Actuator Actuator::carriage{Drive::rail, 1};

/// One rod hangs on the drive, not a parallelogram.
constexpr bool on_single_rods(Actuator actuator) { return actuator.rods == 1; }

/// The joint coordinate is the angle of an arm.
constexpr bool swings_arm(Actuator actuator) { return actuator.drive == Drive::arm; }

/// The joint coordinate is a position on a rail.
constexpr bool runs_on_rail(Actuator actuator) { return actuator.drive == Drive::rail; }

/// Unit of a joint coordinate.
constexpr Unit joint_unit(Actuator actuator) { return swings_arm(actuator) ? Unit::rad : Unit::mm; }

namespace detail {
/// By drive, then by the number of its rods.
inline constexpr std::array<std::array<std::span<const Source>, 2>, 3> kSourcesOfKinds{
    {{kCrankSources, kRevoluteSources}, {kCarriageSources, kLinearSources}, {kStrutSources, {}}}};
}  // namespace detail

/// The source errors of a kind of limb, in column order. The first is its joint zero.
constexpr std::span<const Source> sources_of(Actuator actuator) {
  const auto all = detail::kSourcesOfKinds[static_cast<std::size_t>(actuator.drive)][actuator.rods - 1U];
  return actuator.has_harmonics ? all : all.first(all.size() - 2);
}

/// The most that a limb has.
inline constexpr std::size_t kMostSources = 16;

constexpr Source joint_zero(Actuator actuator) { return sources_of(actuator).front(); }
constexpr bool is_joint_zero(Source source) { return source == "theta_offset" || source == "zero"; }
constexpr bool is_harmonic(Source source) { return source == "turn_sine" || source == "turn_cosine"; }

namespace detail {
using Places = BySource<std::uint8_t>;
inline constexpr std::array<std::array<Places, 2>, 3> kPlaces = [] {
  std::array<std::array<Places, 2>, 3> places{};
  for (std::size_t drive = 0; drive < places.size(); ++drive) {
    for (std::size_t more = 0; more < 2; ++more) {
      Places& of_kind = places[drive][more];
      of_kind.values.fill(kMostSources);
      const std::span<const Source> own = kSourcesOfKinds[drive][more];
      for (std::size_t k = 0; k < own.size(); ++k) of_kind[own[k]] = static_cast<std::uint8_t>(k);
    }
  }
  return places;
}();
}  // namespace detail

/// Place of a source in the list of a kind of limb, from 0; kMostSources where that kind does not have it.
constexpr std::size_t place_in(Actuator actuator, Source source) {
  if (is_harmonic(source) && !actuator.has_harmonics) return kMostSources;
  return detail::kPlaces[static_cast<std::size_t>(actuator.drive)][actuator.rods - 1U][source];
}

/// That kind of limb has it.
constexpr bool has(Actuator actuator, Source source) { return place_in(actuator, source) < kMostSources; }

/// mm; for a robot that is not stated: no robot is larger.
inline constexpr double kLargestReach = 1e5;

/// Properties of a robot for reading tables: number and kinds of its limbs, and its reach. The default applies to any
/// robot.
struct JointSpace {
  JointSpace(std::size_t limbs = 0, Actuator kind = Actuator::revolute) : count(limbs), actuator(kind) {
    kinds.fill(kind);
  }
  std::size_t count;
  Actuator actuator;  ///< of the first limb; all joint coordinates have its unit
  std::array<Actuator, kMaxLimbs> kinds;
  std::optional<double> guided_z = {};  ///< z of the plate, mm, if guides fix it: poses may omit it
  double reach = kLargestReach;         ///< mm; see Robot::reach()
};

/// Unit of the error inside the library: that of the joint coordinate of a joint zero or a harmonic. Files and JSON
/// carry deg instead of rad.
constexpr Unit unit(Source source, Actuator actuator) { return source.unit().value_or(joint_unit(actuator)); }

/// The source with that name; empty when that kind of limb has none.
std::optional<Source> source_named(std::string_view name, Actuator actuator);

/// Which coordinate of a point it is, from 0; empty where it is none.
constexpr std::optional<std::size_t> coordinate(Source source) {
  const std::string_view whole = source.name();
  if (whole[whole.size() - 2] != '_') return std::nullopt;
  return static_cast<std::size_t>(whole.back() - 'x');
}

/// The coordinates of a point share a tolerance and a key of files: "e" of e_x, e_y and e_z. Else the name itself.
constexpr std::string_view shared_name(Source source) {
  const std::string_view whole = source.name();
  return coordinate(source) ? whole.substr(0, whole.size() - 2) : whole;
}

/// The first of its shared name.
constexpr bool is_leading(Source source) { return coordinate(source).value_or(0) == 0; }

/// The sources of a kind of limb that share the name of this one: itself, or the three coordinates of a point.
std::span<const Source> sharing(Source leading, Actuator actuator);

/// Source errors of all limbs: actual minus nominal, zero until set. Scalar is double, or an automatic-derivative type.
template <typename Scalar>
class BasicSourceErrors {
 public:
  /// @param limb  0 ... limb_count - 1 (files and messages count from 1).
  Scalar& operator()(std::size_t limb, Source source) { return values_[limb][source]; }
  const Scalar& operator()(std::size_t limb, Source source) const { return values_[limb][source]; }

 private:
  std::array<BySource<Scalar>, kMaxLimbs> values_{};
};

using SourceErrors = BasicSourceErrors<double>;

SourceErrors operator+(SourceErrors one, const SourceErrors& other);
SourceErrors operator-(SourceErrors one, const SourceErrors& other);

/// The position group alone: the tilt group set to zero.
SourceErrors without_tilt_group(SourceErrors errors);

}  // namespace paracal
