#include "paracal/mechanism/catalogue.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "paracal/error.hpp"
#include "paracal/spelling.hpp"
#include "paracal/units.hpp"

namespace paracal::catalogue {
namespace {

struct Entry {
  std::string_view name;
  Robot (*make)();
};

constexpr std::array<Entry, 3> kEntries{
    {{"huang2016", huang2016}, {"rotary_delta", rotary_delta}, {"linear_delta", linear_delta}}};

/// The paper states those of the tilt group alone.
Tolerances table2(const Limbs& limbs) {
  Tolerances tolerances = generous_tolerances(limbs);
  for (const Source source : all_sources()) {
    if (tilts_plate(source)) tolerances.origin[source] = Origin::stated;
  }
  list_assumed(tolerances, limbs);
  return tolerances;
}

}  // namespace

Robot huang2016() {
  RobotDescription robot;
  robot.name = "huang2016";
  robot.limbs = limbs_of({.base_radius = 200.0,
                          .plate_radius = 75.0,
                          .arm = 375.0,
                          .rod = 950.0,
                          .parallelogram_width = 100.0,
                          .limb_azimuth = {to_radians(-45), to_radians(45), to_radians(135), to_radians(225)}});
  robot.freedoms = kLevelPlate;
  robot.slide = Slide{.axis = {0.0, -1.0, 0.0}, .sign = {1, 1, -1, -1}, .pinion_radius = 12.0};
  robot.workspace = {.radius = 500.0,
                     .height = 250.0,
                     .top_z = -763.0,
                     .min_rotation = to_radians(-180),
                     .max_rotation = to_radians(180)};
  robot.tolerances = table2(robot.limbs);
  return Robot(std::move(robot));
}

Robot rotary_delta() {
  RobotDescription robot;
  robot.name = "rotary_delta";
  robot.limbs = limbs_of({.base_radius = 200.0,
                          .plate_radius = 60.0,
                          .arm = 400.0,
                          .rod = 950.0,
                          .parallelogram_width = 100.0,
                          .limb_azimuth = {to_radians(0), to_radians(120), to_radians(240)}});
  robot.freedoms = kLevelPlate;
  robot.workspace = {.radius = 500.0, .height = 250.0, .top_z = -800.0};
  robot.tolerances = generous_tolerances(robot.limbs);
  return Robot(std::move(robot));
}

Robot linear_delta() {
  RobotDescription robot;
  robot.name = "linear_delta";
  robot.limbs = limbs_of({.base_radius = 185.0,
                          .plate_radius = 35.0,
                          .arm = 20.0,
                          .rod = 290.0,
                          .parallelogram_width = 50.0,
                          .limb_azimuth = {to_radians(210), to_radians(330), to_radians(90)},
                          .actuator = Actuator::linear});
  robot.freedoms = kLevelPlate;
  robot.workspace = {.radius = 120.0, .height = 250.0, .top_z = -300.0};
  robot.tolerances = generous_tolerances(robot.limbs);
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
    const std::vector<std::string_view> all = names();
    const std::vector<std::string> known(all.begin(), all.end());
    throw InvalidArgument(fmt::format("robot: expected a catalogue name ({}), got \"{}\"{}", fmt::join(known, ", "),
                                      name, did_you_mean(name, known)));
  }
  return found->make();
}

}  // namespace paracal::catalogue
