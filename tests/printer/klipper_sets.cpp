#include "printer/klipper_sets.hpp"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "paracal/units.hpp"
#include "support/places.hpp"

namespace paracal::test {
namespace {

using nlohmann::json;

std::string steps(const json& reading, std::size_t first) {
  return fmt::format("{:.3f},{:.3f},{:.3f}", reading[first].get<double>(), reading[first + 1].get<double>(),
                     reading[first + 2].get<double>());
}

JointDrops drops(const json& reading, std::size_t first, const json& step) {
  JointDrops values{};
  for (std::size_t i = 0; i < 3; ++i) values[i] = reading[first + i].get<double>() * step[i].get<double>();
  return values;
}

/// As Klipper writes it: what the owner typed, then the block that SAVE_CONFIG appends.
std::string config_of(const json& entry) {
  constexpr std::array<const char*, 3> kTowers{"stepper_a", "stepper_b", "stepper_c"};
  std::string text = "[mcu]\nserial: /dev/ttyUSB0  # not ours\n\n[printer]\nkinematics: delta\nmax_velocity: 300\n";
  std::string saved = fmt::format("#*# [printer]\n#*# delta_radius = {}\n#*#\n", entry["delta_radius_mm"].dump());
  for (std::size_t i = 0; i < 3; ++i) {
    text +=
        fmt::format("\n[{}]\nstep_pin: PF{}\nstep_distance: {}\n", kTowers[i], i, entry["step_distance_mm"][i].dump());
    if (i == 0) text += "#arm_length: 999.0 ; typed once, commented out by SAVE_CONFIG\n#position_endstop = 999\n";
    saved += fmt::format("#*# [{}]\n#*# angle = {}\n#*# arm_length = {}\n#*# position_endstop = {}\n#*#\n", kTowers[i],
                         entry["tower_angle_deg"][i].dump(), entry["arm_length_mm"][i].dump(),
                         entry["position_endstop_mm"][i].dump());
  }
  text += "\n[delta_calibrate]\nradius: 50\n\n#*# <---------------------- SAVE_CONFIG ---------------------->\n";
  text += "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n#*#\n" + saved;
  text += "#*# [delta_calibrate]\n";
  for (std::size_t k = 0; k < entry["heights"].size(); ++k) {
    const json& one = entry["heights"][k];
    text += fmt::format("#*# height{} = {}\n#*# height{}_pos = {}\n", k, one[0].dump(), k, steps(one, 1));
  }
  for (std::size_t k = 0; k < entry["distances"].size(); ++k) {
    const json& one = entry["distances"][k];
    text += fmt::format("#*# distance{0} = {1}\n#*# distance{0}_pos1 = {2}\n#*# distance{0}_pos2 = {3}\n", k,
                        one[0].dump(), steps(one, 1), steps(one, 4));
  }
  return text;
}

KlipperSet set_of(const json& entry) {
  KlipperSet set{.id = entry["id"], .geometry = {.radius = entry["delta_radius_mm"]}, .config = config_of(entry)};
  for (std::size_t i = 0; i < 3; ++i) {
    set.geometry.tower_angle[i] = to_radians(entry["tower_angle_deg"][i].get<double>());
    set.geometry.rod[i] = entry["arm_length_mm"][i];
    set.geometry.endstop[i] = entry["position_endstop_mm"][i];
  }
  const json& step = entry["step_distance_mm"];
  for (const json& one : entry["heights"]) set.readings.heights.push_back({one[0], drops(one, 1, step)});
  for (const json& one : entry["distances"]) {
    set.readings.distances.push_back({one[0], drops(one, 1, step), drops(one, 4, step)});
  }
  const json& check = entry["klipper_check"];
  set.saved_cost = check["cost_saved"];
  set.best_cost = check["scipy_lsq"]["cost"];
  set.saved_is_optimum = check["saved_is_optimum"];
  return set;
}

}  // namespace

std::vector<KlipperSet> klipper_sets() {
  std::ifstream file(test::source_folder() / "data/klipper-delta/sets.json");
  const json entries = json::parse(file);
  std::vector<KlipperSet> sets;
  sets.reserve(entries.size());
  for (const json& entry : entries) sets.push_back(set_of(entry));
  return sets;
}

const PrinterCalibration& calibrated(const KlipperSet& set) {
  static std::map<std::string, PrinterCalibration> all;
  auto found = all.find(set.id);
  if (found == all.end()) {
    found = all.emplace(set.id, calibrate_printer(set.geometry, set.readings)).first;
  }
  return found->second;
}

}  // namespace paracal::test
