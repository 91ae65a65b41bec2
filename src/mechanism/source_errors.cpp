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

SourceErrors combined(SourceErrors one, const SourceErrors& other, auto by) {
  for (std::size_t limb = 0; limb < kMaxLimbs; ++limb) {
    for (const Source source : all_sources()) one(limb, source) = by(one(limb, source), other(limb, source));
  }
  return one;
}

}  // namespace

Unit unit(Source source, Actuator actuator) {
  return source == Source::theta_offset ? joint_unit(actuator) : kSources[index(source)].unit;
}

std::string_view name(Source source) { return kSources[index(source)].name; }

std::optional<Source> source_named(std::string_view name) {
  const auto* found = std::ranges::find(kSources, name, &SourceEntry::name);
  if (found == kSources.end()) return std::nullopt;
  return static_cast<Source>(found - kSources.begin());
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
