#include "paracal/mechanism/source_errors.hpp"

#include <algorithm>
#include <functional>

namespace paracal {
namespace {

SourceErrors combined(SourceErrors one, const SourceErrors& other, auto by) {
  for (std::size_t limb = 0; limb < kMaxLimbs; ++limb) {
    for (const Source source : all_sources()) one(limb, source) = by(one(limb, source), other(limb, source));
  }
  return one;
}

}  // namespace

std::optional<Source> source_named(std::string_view name, Actuator actuator) {
  const std::span<const Source> own = sources_of(actuator);
  const auto found = std::ranges::find(own, name, &Source::name);
  if (found == own.end()) return std::nullopt;
  return *found;
}

std::span<const Source> sharing(Source leading, Actuator actuator) {
  const std::span<const Source> own = sources_of(actuator);
  const auto shares = [&](Source other) { return shared_name(other) == shared_name(leading); };
  const auto first = std::ranges::find_if(own, shares), last = std::find_if_not(first, own.end(), shares);
  return {first, last};
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
