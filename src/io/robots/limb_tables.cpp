#include "limb_tables.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "io/tables/names.hpp"
#include "robot_tables.hpp"

namespace paracal::io {
namespace {

constexpr std::array kLimbKinds{Actuator::strut, Actuator::crank, Actuator::carriage};
constexpr std::string_view kAhead = "ahead", kBehind = "behind", kWidth = "parallelogram_width_mm";

Eigen::Vector3d vector_of(Section& limb, std::string_view key, const plausible::Range& range = plausible::kDirection) {
  const std::vector<double> values = limb.numbers(key, range, 3);
  return {values[0], values[1], values[2]};
}

[[noreturn]] void fail(Section& limb, std::string_view key, std::string_view expected, std::string_view got) {
  limb.fail(*limb.find(key), fmt::format("expected {} for {}, got \"{}\"", expected, limb.key_path(key), got));
}

/// An arm or a rail with a parallelogram has two rods.
Actuator kind_of(Section& limb) {
  const std::string name = limb.text("kind");
  const auto* kind = std::ranges::find(kLimbKinds, name, &actuator_name);
  if (kind == kLimbKinds.end()) fail(limb, "kind", "\"strut\", \"arm\" or \"rail\"", name);
  if (!limb.find(kWidth)) return *kind;
  if (*kind == Actuator::strut) limb.fail(*limb.find(kWidth), "expected an arm or a rail to carry a parallelogram");
  return {kind->drive, 2};
}

bool stands_behind(Section& rail) {
  if (!rail.find("carriage")) return false;
  const std::string stands = rail.text("carriage");
  if (stands != kAhead && stands != kBehind) {
    fail(rail, "carriage", fmt::format("\"{}\" or \"{}\"", kAhead, kBehind), stands);
  }
  return stands == kBehind;
}

LimbDescription limb_of(Section& limb) {
  const Actuator kind = kind_of(limb);
  LimbDescription one{.base = vector_of(limb, "base_joint_mm", plausible::kFinite),
                      .plate = vector_of(limb, "plate_joint_mm", plausible::kFinite),
                      .kind = kind};
  for (const LimbLength& length : lengths_of(kind)) one.*length.member = limb.number(length.key, plausible::kFinite);
  for (const LimbDirection& direction : directions_of(kind)) one.*direction.member = vector_of(limb, direction.key);
  if (runs_on_rail(kind)) one.behind = stands_behind(limb);
  const double pitch = pitch_of(limb, kind);
  limb.refuse_others();
  return with_pitch(one, pitch);
}

Json limb_json(const LimbDescription& limb) {
  const Actuator kind = limb.kind;
  Json json{{"kind", actuator_name({kind.drive, 1})},  // of the drive alone, however many rods hang on it
            {"base_joint_mm", json_array(limb.base)},
            {"plate_joint_mm", json_array(limb.plate)}};
  for (const LimbLength& length : lengths_of(kind)) json[length.key] = limb.*length.member;
  for (const LimbDirection& direction : directions_of(kind)) json[direction.key] = json_array(limb.*direction.member);
  if (runs_on_rail(kind)) json["carriage"] = limb.behind ? kBehind : kAhead;
  add_pitch(limb.kind, limb.pitch, json);
  return json;
}

std::string toml_value(const Json& value) {
  if (value.is_string()) return value.dump();
  if (value.is_array()) return array(value.get<std::vector<double>>());
  return fmt::format("{}", value.get<double>());
}

}  // namespace

double pitch_of(Section& table, Actuator kind) {
  constexpr plausible::Range kPitch{1e-3, 1e5, "", "no screw or encoder is outside"};
  return from_file_unit(joint_unit(kind), table.number_or(pitch_key(kind), 0.0, kPitch));
}

void add_pitch(Actuator kind, double pitch, Json& json) {
  if (kind.has_harmonics) json[pitch_key(kind)] = joint_unit(kind) == Unit::rad ? tidy_degrees(pitch) : pitch;
}

bool define_limbs(const toml::table& document) {
  const toml::node* limbs = document.get("limb");  // of another type: it is what is wrong, not the missing geometry
  const bool is_empty = limbs != nullptr && limbs->is_array() && limbs->as_array()->empty();
  return !document.contains("geometry") && limbs != nullptr && !is_empty;
}

PlateFreedoms freedoms_of(Section plate) {
  PlateFreedoms freedoms{.free = {}};
  if (!plate.find("freedoms")) {
    plate.fail(fmt::format("expected {} for limbs with their own dimensions", plate.key_path("freedoms")));
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

namespace {

/// The limb rotated about z by an angle, rad; mirrored at the plane of x and z before, if asked.
LimbDescription turned(LimbDescription limb, double angle, bool mirrored) {
  constexpr double kRound = 1e9;  // 1 / mm
  const Eigen::Vector3d mirror(1.0, mirrored ? -1.0 : 1.0, 1.0);
  const auto turn = [&](Eigen::Vector3d& vector, double sense) {
    vector = sense * (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * vector.cwiseProduct(mirror).eval());
    vector = (vector * kRound).array().round() / kRound + 0.0;  // a quarter of a turn keeps its zeros
  };
  for (Eigen::Vector3d* vector : {&limb.base, &limb.plate, &limb.at_zero}) turn(*vector, 1.0);
  turn(limb.axis, mirrored && swings_arm(limb.kind) ? -1.0 : 1.0);  // a motor's axis is that of a rotation
  return limb;
}

/// "repeat = 3" stands for as many limbs around z, evenly; with "mirrored = true" the mirror image of each, too.
std::vector<LimbDescription> repeated(Section& table) {
  constexpr double kMost = kMaxLimbs;
  const double count = table.number_or("repeat", 1.0, plausible::kFinite);
  const bool mirrored = table.flag("mirrored");
  if (!(count >= 1.0) || count > kMost || count != std::floor(count)) {
    table.fail(*table.find("repeat"), fmt::format("expected a number of limbs from 1 to {} for {}, got {:g}", kMaxLimbs,
                                                  table.key_path("repeat"), count));
  }
  const LimbDescription first = limb_of(table);
  std::vector<LimbDescription> limbs;
  for (int k = 0; k < static_cast<int>(count); ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    if (k == 0) limbs.push_back(first);
    if (k > 0) limbs.push_back(turned(first, angle, false));
    if (mirrored) limbs.push_back(turned(first, angle, true));
  }
  return limbs;
}

}  // namespace

void read_limbs(Section& root, RobotDescription& robot) {
  std::optional<Section> plate = root.optional_table("plate");
  const bool has_slide = plate && plate->find("slide_axis") != nullptr;
  robot.freedoms = has_slide ? kLevelPlate
                   : plate   ? freedoms_of(*plate)
                             : PlateFreedoms{};  // first: limbs may be unknown ones, too
  for (Section& limb : root.tables("limb")) {
    const std::vector<LimbDescription> copies = repeated(limb);
    robot.limbs.insert(robot.limbs.end(), copies.begin(), copies.end());
  }
  if (has_slide && std::ranges::any_of(robot.limbs, on_single_rods, &LimbDescription::kind)) {
    plate->fail(*plate->find("slide_axis"),
                fmt::format("expected {} and no slide for limbs with one rod", plate->key_path("freedoms")));
  }
}

Json freedoms_json(const PlateFreedoms& freedoms) {
  Json names = Json::array();
  for (std::size_t k = 0; k < freedoms.free.size(); ++k) {
    if (freedoms.free[k]) names.push_back(kPlateCoordinates[k]);
  }
  return names;
}

std::string limbs_toml(const Limbs& limbs) {
  std::string text;
  for (const Json& limb : limbs_json(limbs)) {
    text += "\n[[limb]]\n";
    for (const auto& [key, value] : limb.items()) text += fmt::format("{} = {}\n", key, toml_value(value));
  }
  return text;
}

Json limbs_json(const Limbs& limbs) { return json_array(limbs, limb_json); }

}  // namespace paracal::io
