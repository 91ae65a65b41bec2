#include "paracal/mechanism/catalogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::catalogue {
namespace {

struct Entry {
  std::string_view name;
  Robot (*make)();
};

constexpr std::array<Entry, 2> kEntries{{{"huang2016", huang2016}, {"rotary_delta", rotary_delta}}};

/// Half-widths for the position group: about twice the largest identified error of [huang2016, section 5.2.1, Table 4].
Tolerances generous_position_tolerances() {
  Tolerances tolerances;
  tolerances[Source::theta_offset] = to_radians(1.5);
  tolerances[Source::e_x] = tolerances[Source::e_y] = tolerances[Source::e_z] = 1.5;
  tolerances[Source::arm_length] = 0.4;
  tolerances[Source::alpha0] = tolerances[Source::beta0] = to_radians(0.15);
  tolerances[Source::rod_mean] = 1.2;
  return tolerances;
}

/// Adds [huang2016, Table 2], in which rod and width differences are divided by the parallelogram's width.
Tolerances with_table2(Tolerances tolerances, double parallelogram_width) {
  tolerances[Source::rod_difference] = 0.22e-3 * parallelogram_width;
  tolerances[Source::width_difference] = 0.90e-3 * parallelogram_width;
  tolerances[Source::alpha03] = 0.26e-3;
  tolerances[Source::beta03] = 0.52e-3;
  tolerances[Source::alpha2] = 0.25e-3;
  tolerances[Source::beta2] = 0.84e-3;
  return tolerances;
}

}  // namespace

Robot huang2016() {
  RobotDescription robot;
  robot.name = "huang2016";
  robot.geometry = {.base_radius = 200.0,
                    .plate_radius = 75.0,
                    .arm = 375.0,
                    .rod = 950.0,
                    .parallelogram_width = 100.0,
                    .limb_azimuth = {to_radians(-45), to_radians(45), to_radians(135), to_radians(225)}};
  robot.slide = Slide{.axis = {0.0, -1.0, 0.0}, .sign = {1, 1, -1, -1}, .pinion_radius = 12.0};
  robot.workspace = {.radius = 500.0,
                     .height = 250.0,
                     .top_z = -763.0,
                     .min_rotation = to_radians(-180),
                     .max_rotation = to_radians(180)};
  robot.tolerances = with_table2(generous_position_tolerances(), robot.geometry.parallelogram_width);
  return Robot(std::move(robot));
}

Robot rotary_delta() {
  RobotDescription robot;
  robot.name = "rotary_delta";
  robot.geometry = {.base_radius = 200.0,
                    .plate_radius = 60.0,
                    .arm = 400.0,
                    .rod = 950.0,
                    .parallelogram_width = 100.0,
                    .limb_azimuth = {to_radians(0), to_radians(120), to_radians(240)}};
  robot.workspace = {.radius = 500.0, .height = 250.0, .top_z = -800.0};
  robot.tolerances = with_table2(generous_position_tolerances(), robot.geometry.parallelogram_width);
  return Robot(std::move(robot));
}

std::vector<std::string_view> names() {
  std::vector<std::string_view> names;
  names.reserve(kEntries.size());
  for (const Entry& entry : kEntries) names.push_back(entry.name);
  return names;
}

Robot find(std::string_view name) {
  const auto* found = std::ranges::find(kEntries, name, &Entry::name);
  if (found == kEntries.end()) {
    std::string known;
    for (const Entry& entry : kEntries) known.append(known.empty() ? "" : ", ").append(entry.name);
    throw InvalidArgument(fmt::format("robot: expected a catalogue name ({}), got \"{}\"", known, name));
  }
  return found->make();
}

}  // namespace paracal::catalogue
