#include "paracal/mechanism/source_errors.hpp"

#include <algorithm>
#include <functional>

namespace paracal {
namespace {

struct SourceEntry {
  std::string_view name;
  Unit unit;
};

constexpr std::array<SourceEntry, kSourceCount> kSources{{
    {"theta_offset", Unit::rad},
    {"e_x", Unit::mm},
    {"e_y", Unit::mm},
    {"e_z", Unit::mm},
    {"arm_length", Unit::mm},
    {"alpha0", Unit::rad},
    {"beta0", Unit::rad},
    {"rod_mean", Unit::mm},
    {"rod_difference", Unit::mm},
    {"width_difference", Unit::mm},
    {"alpha03", Unit::rad},
    {"beta03", Unit::rad},
    {"alpha2", Unit::rad},
    {"beta2", Unit::rad},
}};

constexpr SourceEntry kGain{"gain", Unit::mm_per_m};

/// Of limbs with one rod, but where one of these has its own.
constexpr std::array<SourceEntry, kSourceCount> kSingleRodSources{{
    {"zero", Unit::mm},
    {"base_x", Unit::mm},
    {"base_y", Unit::mm},
    {"base_z", Unit::mm},
    kGain,
    {"alpha0", Unit::rad},
    {"beta0", Unit::rad},
    {"rod_length", Unit::mm},
    {"plate_x", Unit::mm},
    {"plate_y", Unit::mm},
    {"plate_z", Unit::mm},
}};
constexpr SourceEntry kNormal{"normal", Unit::mm}, kAcross{"across", Unit::mm};

/// A place that the kind of limb does not have reads as elsewhere.
const SourceEntry& entry_of(Source source, Actuator actuator) {
  const SourceEntry &of_parallelogram = kSources[index(source)], &of_one_rod = kSingleRodSources[index(source)];
  if (actuator == Actuator::linear && source == Source::gain) return kGain;
  if (!on_single_rods(actuator) || of_one_rod.name.empty()) return of_parallelogram;
  if (actuator == Actuator::crank && source == Source::arm_length) return of_parallelogram;
  if (actuator == Actuator::carriage && source == Source::normal) return kNormal;
  if (actuator == Actuator::carriage && source == Source::across) return kAcross;
  return of_one_rod;
}

SourceErrors combined(SourceErrors one, const SourceErrors& other, auto by) {
  for (std::size_t limb = 0; limb < kMaxLimbs; ++limb) {
    for (const Source source : all_sources()) one(limb, source) = by(one(limb, source), other(limb, source));
  }
  return one;
}

}  // namespace

Unit unit(Source source, Actuator actuator) {
  return source == Source::theta_offset ? joint_unit(actuator) : entry_of(source, actuator).unit;
}

std::string_view name(Source source, Actuator actuator) { return entry_of(source, actuator).name; }

std::optional<Source> source_named(std::string_view name, Actuator actuator) {
  const std::span<const Source> own = sources_of(actuator);
  const auto found = std::ranges::find(own, name, [&](Source source) { return paracal::name(source, actuator); });
  if (found == own.end()) return std::nullopt;
  return *found;
}

std::string_view shared_name(Source source, Actuator actuator) {
  const std::string_view whole = name(source, actuator);
  return coordinate(source, actuator) ? whole.substr(0, whole.size() - 2) : whole;
}

std::optional<std::size_t> coordinate(Source source, Actuator actuator) {
  const std::string_view whole = name(source, actuator);
  if (whole[whole.size() - 2] != '_') return std::nullopt;
  return static_cast<std::size_t>(whole.back() - 'x');
}

SourceErrors operator+(SourceErrors one, const SourceErrors& other) { return combined(one, other, std::plus()); }

SourceErrors operator-(SourceErrors one, const SourceErrors& other) { return combined(one, other, std::minus()); }

SourceErrors without_tilt_group(SourceErrors errors) {
  for (std::size_t limb = 0; limb < kMaxLimbs; ++limb) {
    for (const Source source : all_sources()) {
      if (index(source) >= kPositionSourceCount) errors(limb, source) = 0.0;
    }
  }
  return errors;
}

}  // namespace paracal
