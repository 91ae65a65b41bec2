#include "paracal/calibration/source_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "paracal/error.hpp"

namespace paracal {
namespace {

/// "e_x" of "e_x2" and "e_x.2".
std::string_view before_limb(std::string_view name) {
  if (!name.empty()) name.remove_suffix(1);
  if (name.ends_with('.')) name.remove_suffix(1);
  return name;
}

bool listed(const std::vector<SourceSelector>& selectors, std::size_t limb, Source source) {
  return std::ranges::any_of(selectors, [&](const SourceSelector& one) { return one.matches(limb, source); });
}

}  // namespace

std::vector<SourceSelector> source_selectors(const std::vector<std::string>& names, const JointSpace& limbs) {
  std::vector<SourceSelector> selectors;
  const std::span<const Actuator> kinds = std::span(limbs.kinds).first(limbs.count);
  for (const std::string& name : names) {
    const auto all = std::ranges::find_if(kinds, [&](Actuator kind) { return source_named(name, kind).has_value(); });
    if (all != kinds.end()) {
      selectors.push_back({*source_named(name, *all), {}});
      continue;
    }
    // The last digit numbers the limb; names of errors may end in one themselves (alpha2).
    const std::size_t limb = name.empty() ? 0 : static_cast<std::size_t>(name.back()) - '0';
    const auto one = limb < 1 || limb > limbs.count ? std::nullopt : source_named(before_limb(name), kinds[limb - 1]);
    if (!one) {
      throw InvalidArgument(
          fmt::format("expected a source error such as {0} (all limbs) or {0}2 (limb 2 of {1}), got \"{2}\"",
                      sources_of(limbs.actuator)[1].name(), limbs.count, name));
    }
    selectors.push_back({*one, limb - 1});
  }
  return selectors;
}

void check_selection(const CalibrationOptions& options, const JointSpace& limbs) {
  bool seeks = false;
  for (std::size_t limb = 0; limb < limbs.count; ++limb) {
    for (const Source source : sources_of(limbs.kinds[limb])) {
      const bool fixed = listed(options.fixed, limb, source);
      if (fixed && listed(options.free, limb, source)) {
        throw InvalidArgument(
            fmt::format("expected an error to be fixed or free, got {} of limb {} as both", name(source), limb + 1));
      }
      seeks |= !fixed && (options.stage != Stage::rough || is_joint_zero(source));
    }
  }
  if (!seeks) throw InvalidArgument("expected at least one error to estimate, got every error of the stage fixed");
}

}  // namespace paracal
