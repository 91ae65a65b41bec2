#include "limb_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "io/calibrations/json_parts.hpp"
#include "io/tables/names.hpp"
#include "robot_tables.hpp"

namespace paracal::io {
namespace {

constexpr std::array kLimbKinds{Actuator::strut, Actuator::crank, Actuator::carriage};
constexpr std::string_view kAhead = "ahead", kBehind = "behind";

Eigen::Vector3d vector_of(Section& limb, std::string_view key, const plausible::Range& range = plausible::kDirection) {
  const std::vector<double> values = limb.numbers(key, range, 3);
  return {values[0], values[1], values[2]};
}

[[noreturn]] void fail(Section& limb, std::string_view key, std::string_view expected, std::string_view got) {
  limb.fail(*limb.find(key), fmt::format("expected {} for {}, got \"{}\"", expected, limb.key_path(key), got));
}

/// @param first  kind of the first limb, which all others share; empty where this is the first.
Actuator kind_of(Section& limb, std::optional<Actuator> first) {
  const std::string name = limb.text("kind");
  const auto* kind = std::ranges::find(kLimbKinds, name, &actuator_name);
  if (kind == kLimbKinds.end()) {
    fail(limb, "kind", "\"strut\", \"arm\" or \"rail\" (describe limbs with two rods by [geometry])", name);
  }
  if (first && *kind != *first) {
    fail(limb, "kind", fmt::format("\"{}\", as of the first limb,", actuator_name(*first)), name);
  }
  return *kind;
}

bool stands_behind(Section& rail) {
  if (!rail.find("carriage")) return false;
  const std::string stands = rail.text("carriage");
  if (stands != kAhead && stands != kBehind) {
    fail(rail, "carriage", fmt::format("\"{}\" or \"{}\"", kAhead, kBehind), stands);
  }
  return stands == kBehind;
}

SingleRod limb_of(Section& limb, Actuator kind) {
  SingleRod one{.base = vector_of(limb, "base_joint_mm", plausible::kFinite),
                .plate = vector_of(limb, "plate_joint_mm", plausible::kFinite)};
  one.length = limb.number(kind == Actuator::strut ? "length_at_zero_mm" : "rod_mm", plausible::kFinite);
  if (kind == Actuator::crank) {
    one.arm = limb.number("arm_mm", plausible::kFinite);
    one.axis = vector_of(limb, "axis");
    one.at_zero = vector_of(limb, "arm_at_zero");
  }
  if (kind == Actuator::carriage) {
    one.axis = vector_of(limb, "direction");
    one.behind = stands_behind(limb);
  }
  limb.refuse_others();
  return one;
}

Json limb_json(const SingleRod& limb, Actuator kind) {
  Json json{{"kind", actuator_name(kind)},
            {"base_joint_mm", json_array(limb.base)},
            {"plate_joint_mm", json_array(limb.plate)},
            {kind == Actuator::strut ? "length_at_zero_mm" : "rod_mm", limb.length}};
  if (kind == Actuator::crank) {
    json["arm_mm"] = limb.arm;
    json["axis"] = json_array(limb.axis);
    json["arm_at_zero"] = json_array(limb.at_zero);
  }
  if (kind == Actuator::carriage) {
    json["direction"] = json_array(limb.axis);
    json["carriage"] = limb.behind ? kBehind : kAhead;
  }
  return json;
}

std::string toml_value(const Json& value) {
  if (value.is_string()) return value.dump();
  if (value.is_array()) return array(value.get<std::vector<double>>());
  return fmt::format("{}", value.get<double>());
}

}  // namespace

bool define_limbs(const toml::table& document) {
  const toml::array* limbs = document["limb"].as_array();
  return !document.contains("geometry") && limbs != nullptr && !limbs->empty() && limbs->front().is_table();
}

PlateFreedoms freedoms_of(Section plate) {
  PlateFreedoms freedoms{.free = {}};
  if (!plate.find("freedoms")) {
    plate.fail(fmt::format("expected {} and no slide for limbs with one rod", plate.key_path("freedoms")));
  }
  for (const std::string& name : plate.texts("freedoms")) {
    const auto* coordinate = std::ranges::find(kPlateCoordinates, name);
    if (coordinate == kPlateCoordinates.end()) {
      fail(plate, "freedoms", fmt::format("names of {}", fmt::join(kPlateCoordinates, ", ")), name);
    }
    bool& free = freedoms.free.at(static_cast<std::size_t>(coordinate - kPlateCoordinates.begin()));
    if (free) fail(plate, "freedoms", "each name once", name);
    free = true;
  }
  if (const std::string why = coupled_motions(freedoms); !why.empty()) plate.fail(*plate.find("freedoms"), why);
  plate.refuse_others();
  return freedoms;
}

Geometry limbs_geometry(Section& root) {
  const std::optional<Section> plate = root.optional_table("plate");
  const PlateFreedoms freedoms =
      plate ? freedoms_of(*plate) : PlateFreedoms{};  // first: limbs may be unknown ones, too
  std::optional<Actuator> kind;
  std::vector<SingleRod> limbs;
  for (Section& limb : root.tables("limb")) {
    kind = kind_of(limb, kind);
    limbs.push_back(limb_of(limb, *kind));
  }
  return single_rod_geometry(kind.value(), std::move(limbs), freedoms);
}

Json freedoms_json(const PlateFreedoms& freedoms) {
  Json names = Json::array();
  for (std::size_t k = 0; k < freedoms.free.size(); ++k) {
    if (freedoms.free[k]) names.push_back(kPlateCoordinates[k]);
  }
  return names;
}

std::string limbs_toml(const Geometry& geometry) {
  std::string text;
  if (!geometry.freedoms.are_all())
    text = fmt::format("\n[plate]\n{} = {}\n", "freedoms", freedoms_json(geometry.freedoms).dump());
  for (const Json& limb : limbs_json(geometry)) {
    text += "\n[[limb]]\n";
    for (const auto& [key, value] : limb.items()) text += fmt::format("{} = {}\n", key, toml_value(value));
  }
  return text;
}

Json limbs_json(const Geometry& geometry) {
  Json limbs = Json::array();
  for (const SingleRod& limb : geometry.single_rods) limbs.push_back(limb_json(limb, geometry.actuator));
  return limbs;
}

}  // namespace paracal::io
