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

std::vector<SourceSelector> source_selectors(const std::vector<std::string>& names, std::size_t limb_count) {
  std::vector<SourceSelector> selectors;
  for (const std::string& name : names) {
    if (const auto all = source_named(name)) {
      selectors.push_back({*all, {}});
      continue;
    }
    // The last digit numbers the limb; names of errors may end in one themselves (alpha2).
    const std::size_t limb = name.empty() ? 0 : static_cast<std::size_t>(name.back()) - '0';
    const auto one = source_named(before_limb(name));
    if (!one || limb < 1 || limb > limb_count) {
      throw InvalidArgument(fmt::format(
          "expected a source error such as e_x (all limbs) or e_x2 (limb 2 of {}), got \"{}\"", limb_count, name));
    }
    selectors.push_back({*one, limb - 1});
  }
  return selectors;
}

void check_selection(const CalibrationOptions& options, std::size_t limb_count) {
  bool seeks = false;
  for (std::size_t limb = 0; limb < limb_count; ++limb) {
    for (const Source source : all_sources()) {
      const bool fixed = listed(options.fixed, limb, source);
      if (fixed && listed(options.free, limb, source)) {
        throw InvalidArgument(
            fmt::format("expected an error to be fixed or free, got {} of limb {} as both", name(source), limb + 1));
      }
      seeks |= !fixed && (options.stage != Stage::rough || source == Source::theta_offset);
    }
  }
  if (!seeks) throw InvalidArgument("expected something to be left to seek, got every source error of the stage fixed");
}

}  // namespace paracal
