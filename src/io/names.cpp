#include "names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::array<std::string_view, 3> kDistributions{"normal", "uniform", "truncated_normal"};

}  // namespace

std::string_view actuator_name(Actuator actuator) { return actuator == Actuator::linear ? "linear" : "revolute"; }

std::string_view file_unit(Source source, Actuator actuator) { return file_unit(unit(source, actuator)); }

double file_factor(Source source, Actuator actuator) { return to_file_unit(unit(source, actuator), 1.0); }

std::string file_key(Source source, Actuator actuator) {
  return fmt::format("{}_{}", name(source), file_unit(source, actuator));
}

std::string tolerance_key(Source source, Actuator actuator) {
  return is_e(source) ? "e_mm" : file_key(source, actuator);
}

std::vector<Source> tolerance_sources() {
  std::vector<Source> sources;
  for (const Source source : all_sources()) {
    if (source != Source::e_y && source != Source::e_z) sources.push_back(source);
  }
  return sources;
}

std::vector<Source> listed_tolerances(const Tolerances& tolerances) {
  std::vector<Source> sources = tolerance_sources();
  std::erase_if(sources, [&](Source source) { return tolerances.origin[index(source)] == Origin::exact; });
  return sources;
}

std::vector<std::string> generous_keys(const Tolerances& tolerances, Actuator actuator) {
  std::vector<std::string> keys;
  for (const Source source : tolerance_sources()) {
    if (tolerances.origin[index(source)] == Origin::generous) keys.push_back(tolerance_key(source, actuator));
  }
  return keys;
}

std::string_view distribution_name(Distribution distribution) {
  return kDistributions[static_cast<std::size_t>(distribution)];
}

std::optional<Distribution> distribution_named(std::string_view name) {
  const auto* found = std::ranges::find(kDistributions, name);
  if (found == kDistributions.end()) return std::nullopt;
  return static_cast<Distribution>(found - kDistributions.begin());
}

std::string distribution_names() {
  std::string names;
  for (const std::string_view name : kDistributions)
    fmt::format_to(std::back_inserter(names), "{}\"{}\"", names.empty() ? "" : " or ", name);
  return names;
}

double tidy(double value) {
  const std::string digits = fmt::format("{:.15g}", value);
  double rounded = 0.0;
  std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
  return rounded;
}

double tidy_degrees(double radians) { return tidy(to_degrees(radians)); }

}  // namespace paracal::io
