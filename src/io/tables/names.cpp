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

std::string_view actuator_name(Actuator actuator) {
  static constexpr std::array<std::array<std::string_view, 2>, 3> kNames{
      {{"arm", "revolute"}, {"rail", "linear"}, {"strut", ""}}};
  return kNames[static_cast<std::size_t>(actuator.drive)][actuator.rods - 1U];
}

std::string_view file_unit(Source source, Actuator actuator) { return file_unit(unit(source, actuator)); }

double file_factor(Source source, Actuator actuator) { return to_file_unit(unit(source, actuator), 1.0); }

std::string file_key(Source source, Actuator actuator) {
  const Unit inside = unit(source, actuator);
  return fmt::format("{}_{}", shared_name(source), inside == Unit::mm_per_m ? "mm_per_m" : paracal::file_unit(inside));
}

std::string joint_speed_key(Actuator actuator) {
  return fmt::format("max_speed_{}_per_s", file_unit(joint_unit(actuator)));
}

std::string joint_acceleration_key(Actuator actuator) {
  return fmt::format("max_acceleration_{}_per_s2", file_unit(joint_unit(actuator)));
}

std::array<std::pair<std::string, double>, 2> joint_limits_in_file(const JointLimits& limits, Actuator actuator) {
  const auto value = [&](double limit) { return joint_unit(actuator) == Unit::rad ? tidy_degrees(limit) : limit; };
  return {{{joint_speed_key(actuator), value(limits.speed)},
           {joint_acceleration_key(actuator), value(limits.acceleration)}}};
}

std::vector<Source> leading_sources(const Limbs& limbs) {
  std::vector<Source> sources = sources_of(limbs);
  std::erase_if(sources, [](Source source) { return !is_leading(source); });
  return sources;
}

std::vector<Source> listed_tolerances(const Tolerances& tolerances, const Limbs& limbs) {
  std::vector<Source> sources = leading_sources(limbs);
  std::erase_if(sources, [&](Source source) { return tolerances.origin[source] == Origin::exact; });
  return sources;
}

std::vector<std::string> generous_keys(const Tolerances& tolerances, const Limbs& limbs) {
  std::vector<std::string> keys;
  for (const Source source : leading_sources(limbs)) {
    if (tolerances.origin[source] == Origin::generous) keys.push_back(file_key(source, actuator_of(limbs)));
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
