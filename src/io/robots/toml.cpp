#include "paracal/io/toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <sstream>

#include "io/tables/names.hpp"
#include "limb_tables.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/round_trip.hpp"
#include "paracal/units.hpp"
#include "robot_tables.hpp"

namespace paracal::io {
namespace {

Eigen::Vector3d vector_of(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

SharedDimensions shared_of(Section section) {
  SharedDimensions shared;
  shared.base_radius = section.number("base_radius_mm", plausible::kFinite);
  shared.plate_radius = section.number("plate_radius_mm", plausible::kFinite);
  shared.arm = section.number("arm_mm", plausible::kFinite);
  shared.rod = section.number("rod_mm", plausible::kFinite);
  shared.parallelogram_width = section.number("parallelogram_width_mm", plausible::kFinite);
  for (const double azimuth : section.numbers("limb_azimuth_deg", plausible::kAngle))
    shared.limb_azimuth.push_back(to_radians(azimuth));
  const std::string actuator = section.text("actuator");
  if (actuator != "revolute" && actuator != "linear") {
    section.fail(section.require("actuator", ""), fmt::format("expected \"revolute\" or \"linear\" for {}, got \"{}\"",
                                                              section.key_path("actuator"), actuator));
  }
  shared.actuator = actuator == "linear" ? Actuator::linear : Actuator::revolute;
  shared.pitch = pitch_of(section, shared.actuator);
  section.refuse_others();
  return shared;
}

Slide slide_of(Section section) {
  Slide slide;
  slide.axis = vector_of(section.numbers("slide_axis", plausible::kDirection, 3));
  slide.sign = section.numbers("slide_sign", plausible::kDirection);
  slide.pinion_radius = section.number("pinion_radius_mm", plausible::kFinite);
  section.refuse_others();
  return slide;
}

std::array<double, 2> range_of(Section& section, const char* key, const plausible::Range& range) {
  const toml::node& node = section.require(key, "[smallest, largest]");
  const std::vector<double> limits = section.numbers_of(node, key, range);
  if (limits.size() == 2) return {limits[0], limits[1]};
  section.fail(
      node, fmt::format("expected [smallest, largest] for {}, got {} numbers", section.key_path(key), limits.size()));
}

/// @param is_flat  guides hold the plate in a plane: z = 0, where nobody says where.
Workspace cylinder_of(Section& section, bool is_flat) {
  const auto number = [&](const char* key) {
    return is_flat ? section.number_or(key, 0.0, plausible::kFinite) : section.number(key, plausible::kFinite);
  };
  return {.radius = section.number("radius_mm", plausible::kFinite),
          .height = number("height_mm"),
          .top_z = number("top_z_mm")};
}

Workspace box_of(Section& section, bool is_flat) {
  Workspace::Box box{range_of(section, "x_mm", plausible::kFinite), range_of(section, "y_mm", plausible::kFinite)};
  if (!is_flat || section.find("z_mm")) box.z = range_of(section, "z_mm", plausible::kFinite);
  return Workspace::of_box(box);
}

Workspace levels_of(Section& section, bool /*is_flat*/) {
  const std::vector<double> heights = section.numbers("heights_mm", plausible::kFinite);
  if (heights.size() < 2) {
    section.fail(*section.find("heights_mm"),
                 fmt::format("expected at least 2 numbers for {}, from the top down, got {}",
                             section.key_path("heights_mm"), heights.size()));
  }
  const std::vector<double> radii = section.numbers("radii_mm", plausible::kFinite, heights.size());
  std::vector<Workspace::Level> levels;
  for (std::size_t k = 0; k < heights.size(); ++k) levels.push_back({heights[k], radii[k]});
  return Workspace::of_levels(std::move(levels));
}

struct Shape {
  std::array<const char*, 3> keys;
  Workspace (*read)(Section&, bool);
};
constexpr std::array<Shape, 3> kShapes{{{{"radius_mm", "height_mm", "top_z_mm"}, cylinder_of},
                                        {{"x_mm", "y_mm", "z_mm"}, box_of},
                                        {{"heights_mm", "radii_mm", "radii_mm"}, levels_of}}};

/// The shape whose keys the table has; the first where it has none.
Workspace shape_of(Section& section, bool is_flat) {
  const Shape* said = nullptr;
  const char* by = nullptr;
  for (const Shape& shape : kShapes) {
    const auto* key = std::ranges::find_if(shape.keys, [&](const char* one) { return section.find(one) != nullptr; });
    if (key == shape.keys.end()) continue;
    if (said != nullptr) {
      section.fail(*section.find(*key),
                   fmt::format("expected a cylinder (radius_mm, height_mm, top_z_mm), a box (x_mm, y_mm, z_mm) or "
                               "levels (heights_mm, radii_mm), got {} and {}; remove one",
                               section.key_path(by), section.key_path(*key)));
    }
    said = &shape;
    by = *key;
  }
  return (said != nullptr ? said : kShapes.data())->read(section, is_flat);
}

Workspace workspace_of(Section section, bool is_flat) {
  Workspace workspace = shape_of(section, is_flat);
  if (section.find("rotation_deg")) {
    const auto [smallest, largest] = range_of(section, "rotation_deg", plausible::kAngle);
    workspace.min_rotation = to_radians(smallest);
    workspace.max_rotation = to_radians(largest);
  }
  workspace.max_tilt = to_radians(section.number_or("tilt_deg", 0.0, plausible::kErrorDeg));
  section.refuse_others();
  return workspace;
}

plausible::Range error_range(Unit unit, double reach) {
  if (unit == Unit::rad) return plausible::kErrorDeg;
  return unit == Unit::mm ? plausible::error(reach) : plausible::Range{-kGainLength, kGainLength, "mm/m"};
}

/// Errors of one limb in its table; those that it does not state are zero.
void read_errors(Section& table, std::size_t limb, const JointSpace& joints, SourceErrors& errors) {
  const Actuator kind = joints.kinds[limb];
  for (const Source source : sources_of(kind)) {
    if (!is_leading(source)) continue;
    const std::string key = file_key(source, kind);
    const std::span<const Source> point = sharing(source, kind);
    if (point.size() == 1) {
      const Unit inside = unit(source, kind);
      errors(limb, source) = from_file_unit(inside, table.number_or(key, 0.0, error_range(inside, joints.reach)));
    } else if (table.find(key)) {
      const std::vector<double> values = table.numbers(key, plausible::error(joints.reach), point.size());
      for (std::size_t k = 0; k < point.size(); ++k) errors(limb, point[k]) = values[k];
    }
  }
  table.refuse_others();
}

/// One [[limb]] table a limb.
SourceErrors errors_of_limbs(const Section& root, const toml::node& limbs, const JointSpace& joints) {
  if (!limbs.is_array_of_tables()) root.fail(limbs, fmt::format("expected [[limb]] tables, got {}", type_name(limbs)));
  const toml::array& tables = *limbs.as_array();
  if (tables.size() != joints.count) {
    root.fail(limbs,
              fmt::format("expected {} [[limb]] tables, one for each limb, got {}", joints.count, tables.size()));
  }
  SourceErrors errors;
  for (std::size_t i = 0; i < joints.count; ++i) {
    Section limb = root.as_table(tables[i], fmt::format("limb {}", i + 1));
    read_errors(limb, i, joints, errors);
  }
  return errors;
}

/// [[error]] tables, each with the number of its limb; limbs without one have no errors.
SourceErrors numbered_errors(Section& root, const JointSpace& joints) {
  SourceErrors errors;
  std::vector<bool> seen(joints.count, false);
  for (Section& table : root.tables("error")) {
    const double number = table.number("limb", plausible::kFinite);
    if (!(number >= 1.0) || number > static_cast<double>(joints.count) || number != std::floor(number)) {
      table.fail(*table.find("limb"), fmt::format("expected a limb from 1 to {} for {}, got {:g}", joints.count,
                                                  table.key_path("limb"), number));
    }
    const auto limb = static_cast<std::size_t>(number) - 1;
    if (seen[limb])
      table.fail(*table.find("limb"), fmt::format("expected each limb once, got limb {} again", limb + 1));
    seen[limb] = true;
    read_errors(table, limb, joints, errors);
  }
  return errors;
}

/// [geometry], and what its limbs differ in by [[limb]] tables.
void read_short_form(Section& root, RobotDescription& robot) {
  SharedDimensions shared = shared_of(root.table("geometry"));
  const std::size_t limbs = shared.limb_azimuth.size(), wanted = robot.slide ? 4 : 3;
  if (limbs != wanted) {
    throw InvalidArgument(fmt::format(
        "geometry.limb_azimuth_deg: expected {} limbs for a {}, got {}: describe a robot with other limbs by "
        "[plate] and [[limb]] tables instead of [geometry]",
        wanted, robot.slide ? "plate with a slide" : "rigid plate", limbs));
  }
  if (const toml::node* tables = root.find("limb")) {
    shared.differences = errors_of_limbs(root, *tables, {limbs, shared.actuator});
  }
  robot.limbs = limbs_of(shared);
  robot.freedoms = kLevelPlate;
}

/// The short form describes robots that hang.
void check_below(const Workspace& workspace) {
  if (workspace.top_z < 0.0) return;
  throw InvalidArgument(fmt::format("workspace.{}: expected a depth below the base (< 0 mm), got {} mm",
                                    workspace.keys().top, workspace.top_z));
}

RobotDescription description_of(const std::string& file, const toml::table& document) {
  Section root(file, "", document);
  RobotDescription robot;
  robot.name = root.text("name");
  const bool of_limbs = define_limbs(document);
  auto plate = root.optional_table("plate");
  if (of_limbs) read_limbs(root, robot);
  if (plate && (!of_limbs || plate->find("slide_axis"))) robot.slide = slide_of(*plate);
  if (!of_limbs) read_short_form(root, robot);
  robot.workspace = workspace_of(root.table("workspace"), robot.freedoms.holds_z());
  if (!of_limbs) check_below(robot.workspace);
  if (const auto tolerances = root.optional_table("tolerances")) {
    robot.tolerances = tolerances_of(*tolerances, robot.limbs);
  }
  if (auto controller = root.optional_table("controller")) {
    robot.controller_origin = vector_of(controller->numbers("origin_mm", plausible::length(kLargestReach), 3));
    controller->refuse_others();
  }
  if (auto joints = root.optional_table("joints")) {
    const Actuator actuator = actuator_of(robot.limbs);
    const auto limit = [&](const std::string& key) {
      return from_file_unit(joint_unit(actuator), joints->number(key, plausible::kSpeed));
    };
    robot.joint_limits = {limit(joint_speed_key(actuator)), limit(joint_acceleration_key(actuator))};
    joints->refuse_others();
  }
  root.find("error");  // read_source_errors() reads what this machine is known to have
  root.refuse_others();
  return robot;
}

/// "limb[2].rod_mm" of a complaint "limb: rod_mm of limb 3: ..."; empty of others.
std::string limb_path(std::string_view complaint) {
  constexpr std::string_view kHead = "limb: ", kOf = " of limb ";
  const std::size_t of = complaint.find(kOf);
  if (!complaint.starts_with(kHead) || of == std::string_view::npos) return "";
  const std::string_view key = complaint.substr(kHead.size(), of - kHead.size()),
                         behind = complaint.substr(of + kOf.size());
  int number = 0;
  std::from_chars(behind.data(), behind.data() + behind.size(), number);
  return fmt::format("limb[{}].{}", number - 1, key);
}

/// Line of the key that a complaint of Robot begins with ("geometry.arm_mm: ..."), or of its table; 0 when there is
/// none.
int line_of_complaint(const toml::table& document, std::string_view complaint) {
  const std::string of_limb = limb_path(complaint);
  if (const auto node = document.at_path(of_limb); node && !of_limb.empty()) {
    return static_cast<int>(node.node()->source().begin.line);
  }
  const std::string_view path = complaint.substr(0, complaint.find(':'));
  if (const auto node = document.at_path(path)) return static_cast<int>(node.node()->source().begin.line);
  return 0;
}

std::string limb_toml(const std::vector<KeyValues>& values) { return "[[limb]]\n" + values_toml(values); }

std::string toml_quoted(const std::string& text) {
  std::ostringstream stream;
  stream << toml::value<std::string>(text);
  return stream.str();
}

std::string shared_toml(const SharedDimensions& shared) {
  std::vector<double> azimuth;
  for (const double angle : shared.limb_azimuth) azimuth.push_back(tidy_degrees(angle));
  Json pitch = Json::object();
  add_pitch(shared.actuator, shared.pitch, pitch);
  std::string text = fmt::format(
      "\n[geometry]\nbase_radius_mm = {}\nplate_radius_mm = {}\narm_mm = {}\nrod_mm = {}\n"
      "parallelogram_width_mm = {}\nlimb_azimuth_deg = {}\nactuator = \"{}\"\n",
      shared.base_radius, shared.plate_radius, shared.arm, shared.rod, shared.parallelogram_width, array(azimuth),
      actuator_name(shared.actuator));
  for (const auto& [key, value] : pitch.items()) text += fmt::format("{} = {}\n", key, value.get<double>());
  return text;
}

std::string plate_toml(const Robot& robot) {
  if (const std::optional<Slide>& slide = robot.slide()) {
    return fmt::format("\n[plate]\nslide_axis = {}\nslide_sign = {}\npinion_radius_mm = {}\n", array(slide->axis),
                       array(slide->sign), slide->pinion_radius);
  }
  if (robot.freedoms().are_all()) return "";
  return fmt::format("\n[plate]\n{} = {}\n", "freedoms", freedoms_json(robot.freedoms()).dump());
}

}  // namespace

Robot robot_of(const std::string& file, const toml::table& document) {
  try {
    return Robot(description_of(file, document));
  } catch (const InvalidArgument& complaint) {
    throw InputFileError(file, line_of_complaint(document, complaint.what()), complaint.what());
  }
}

Robot read_robot(const TextFile& file) {
  const toml::table document = parse_toml(file);
  Robot robot = robot_of(file.name, document);
  try {
    check_round_trip(robot);
  } catch (const InvalidArgument& complaint) {
    throw InputFileError(file.name, line_of_complaint(document, complaint.what()), complaint.what());
  }
  return robot;
}

std::string robot_toml(const Robot& robot) {
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "name = {}\n", toml_quoted(robot.name()));
  if (const std::optional<SharedDimensions> shared = shared_dimensions(robot.limbs())) {
    text += shared_toml(*shared) + (robot.slide() ? plate_toml(robot) : "");
  } else {
    text += plate_toml(robot) + limbs_toml(robot.limbs());
  }
  text += "\n[workspace]\n" + values_toml(workspace_values(robot.workspace()));
  if (!robot.controller_origin().isZero(0.0)) {
    fmt::format_to(out, "\n[controller]\norigin_mm = {}\n", array(robot.controller_origin()));
  }
  if (const auto& limits = robot.joint_limits()) {
    text += "\n[joints]\n";
    for (const auto& [key, value] : joint_limits_in_file(*limits, robot.actuator()))
      fmt::format_to(out, "{} = {}\n", key, value);
  }
  for (const auto& limb : differences(robot)) text.append("\n").append(limb_toml(limb));
  if (robot.tolerances()) text.append("\n").append(tolerances_toml(*robot.tolerances(), robot.limbs()));
  return text;
}

std::string values_toml(const std::vector<KeyValues>& values) {
  std::string text;
  for (const auto& [key, numbers] : values) {
    fmt::format_to(std::back_inserter(text), "{} = {}\n", key,
                   numbers.size() == 1 ? fmt::format("{}", numbers.front()) : array(numbers));
  }
  return text;
}

std::vector<KeyValues> workspace_values(const Workspace& workspace) {
  const auto range = [](const std::array<double, 2>& ends) { return std::vector<double>(ends.begin(), ends.end()); };
  std::vector<KeyValues> values{
      {"radius_mm", {workspace.radius}}, {"height_mm", {workspace.height}}, {"top_z_mm", {workspace.top_z}}};
  if (const auto& box = workspace.box) {
    values = {{"x_mm", range(box->x)}, {"y_mm", range(box->y)}, {"z_mm", range(box->z)}};
  } else if (!workspace.levels.empty()) {
    values = {{"heights_mm", {}}, {"radii_mm", {}}};
    for (const auto& [z, radius] : workspace.levels) {
      values[0].values.push_back(z);
      values[1].values.push_back(radius);
    }
  }
  values.push_back({"rotation_deg", {tidy_degrees(workspace.min_rotation), tidy_degrees(workspace.max_rotation)}});
  if (workspace.max_tilt > 0.0) values.push_back({"tilt_deg", {tidy_degrees(workspace.max_tilt)}});
  return values;
}

std::vector<KeyValues> limb_values(const SourceErrors& errors, std::size_t limb, Actuator actuator) {
  std::vector<KeyValues> all;
  const auto value = [&](Source source) { return to_file_unit(unit(source, actuator), errors(limb, source)); };
  for (const Source source : sources_of(actuator)) {
    if (!is_leading(source)) continue;
    std::vector<double> values;
    std::ranges::transform(sharing(source, actuator), std::back_inserter(values), value);
    all.push_back({file_key(source, actuator), std::move(values)});
  }
  return all;
}

std::vector<std::vector<KeyValues>> differences(const Robot& robot) {
  const std::optional<SharedDimensions> shared = shared_dimensions(robot.limbs());
  if (!shared) return {};
  std::vector<std::vector<KeyValues>> limbs(robot.limb_count());
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (KeyValues& one : limb_values(shared->differences, limb, robot.nominal().limbs[limb].actuator)) {
      if (std::ranges::all_of(one.values, [](double value) { return value == 0.0; })) continue;
      std::ranges::transform(one.values, one.values.begin(), tidy);
      limbs[limb].push_back(std::move(one));
    }
  }
  if (std::ranges::all_of(limbs, &std::vector<KeyValues>::empty)) return {};
  return limbs;
}

std::string source_errors_toml(const SourceErrors& errors, const JointSpace& joints) {
  std::string text;
  for (std::size_t limb = 0; limb < joints.count; ++limb) {
    if (limb > 0) text.append("\n");
    text.append(limb_toml(limb_values(errors, limb, joints.kinds[limb])));
  }
  return text;
}

SourceErrors read_source_errors(const TextFile& file, const JointSpace& joints) {
  const toml::table document = parse_toml(file);
  Section root(file.name, "", document);
  if (document.contains("error")) {
    const SourceErrors errors = numbered_errors(root, joints);
    if (!document.contains("workspace")) root.refuse_others();  // else the file describes the robot, too
    return errors;
  }
  const toml::node& limbs = root.require("limb", "one [[limb]] table for each limb, or [[error]] tables");
  root.refuse_others();
  return errors_of_limbs(root, limbs, joints);
}

}  // namespace paracal::io
