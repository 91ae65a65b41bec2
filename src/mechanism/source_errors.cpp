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

constexpr std::array<SourceEntry, kPositionSourceCount> kStrutSources{{
    {"zero", Unit::mm},
    {"base_x", Unit::mm},
    {"base_y", Unit::mm},
    {"base_z", Unit::mm},
    {"gain", Unit::mm_per_m},
    {"plate_x", Unit::mm},
    {"plate_y", Unit::mm},
    {"plate_z", Unit::mm},
}};

std::span<const SourceEntry> entries_of(Actuator actuator) {
  if (actuator == Actuator::strut) return kStrutSources;
  return kSources;
}

SourceErrors combined(SourceErrors one, const SourceErrors& other, auto by) {
  for (std::size_t limb = 0; limb < kMaxLimbs; ++limb) {
    for (const Source source : all_sources()) one(limb, source) = by(one(limb, source), other(limb, source));
  }
  return one;
}

}  // namespace

Unit unit(Source source, Actuator actuator) {
  const std::span<const SourceEntry> entries = entries_of(actuator);
  if (source == Source::theta_offset || index(source) >= entries.size()) return joint_unit(actuator);
  return entries[index(source)].unit;
}

std::string_view name(Source source, Actuator actuator) {
  const std::span<const SourceEntry> entries = entries_of(actuator);
  return index(source) < entries.size() ? entries[index(source)].name : kSources[index(source)].name;
}

std::optional<Source> source_named(std::string_view name, Actuator actuator) {
  const std::span<const SourceEntry> entries = entries_of(actuator);
  const auto found = std::ranges::find(entries, name, &SourceEntry::name);
  if (found == entries.end()) return std::nullopt;
  return static_cast<Source>(found - entries.begin());
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
      if (tilts_plate(source)) errors(limb, source) = 0.0;
    }
  }
  return errors;
}

}  // namespace paracal
