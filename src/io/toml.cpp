#include "paracal/io/toml.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>

#include "names.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

/// A TOML table that knows its file and its place in it, asks for keys with their type, and refuses keys nobody asked
/// for.
class Section {
 public:
  Section(std::string file, std::string path, const toml::table& table)
      : file_(std::move(file)), path_(std::move(path)), table_(table) {}

  [[noreturn]] void fail(const toml::node& where, const std::string& complaint) const {
    throw InputFileError(file_, static_cast<int>(where.source().begin.line), complaint);
  }
  [[noreturn]] void fail(const std::string& complaint) const { fail(table_, complaint); }

  std::string key_path(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
  }

  const toml::node* find(std::string_view key) {
    asked_.emplace(key);
    return table_.get(key);
  }

  const toml::node& require(std::string_view key, std::string_view expected) {
    if (const toml::node* node = find(key)) return *node;
    fail(fmt::format("expected {} ({}), got nothing", key_path(key), expected));
  }

  double number_of(const toml::node& node, std::string_view key) const {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) fail(node, fmt::format("expected a number for {}, got {}", key_path(key), type_name(node)));
    if (!std::isfinite(*value))
      fail(node, fmt::format("expected a finite number for {}, got {}", key_path(key), *value));
    return *value;
  }

  double number(std::string_view key) { return number_of(require(key, "a number"), key); }

  double number_or(std::string_view key, double otherwise) {
    const toml::node* node = find(key);
    return node ? number_of(*node, key) : otherwise;
  }

  std::vector<double> numbers_of(const toml::node& node, std::string_view key) const {
    if (!node.is_array())
      fail(node, fmt::format("expected an array of numbers for {}, got {}", key_path(key), type_name(node)));
    std::vector<double> values;
    for (const toml::node& element : *node.as_array()) values.push_back(number_of(element, key));
    return values;
  }

  std::vector<double> numbers(std::string_view key, std::optional<std::size_t> count = std::nullopt) {
    const toml::node& node = require(key, "an array of numbers");
    std::vector<double> values = numbers_of(node, key);
    if (count && values.size() != *count) {
      fail(node, fmt::format("expected {} numbers for {}, got {}", *count, key_path(key), values.size()));
    }
    return values;
  }

  std::string text(std::string_view key) {
    const toml::node& node = require(key, "a text");
    if (!node.is_string()) fail(node, fmt::format("expected a text for {}, got {}", key_path(key), type_name(node)));
    return **node.as_string();
  }

  Section table(std::string_view key) { return as_table(require(key, "a table"), key); }

  std::optional<Section> optional_table(std::string_view key) {
    const toml::node* node = find(key);
    if (!node) return std::nullopt;
    return as_table(*node, key);
  }

  Section as_table(const toml::node& node, std::string_view key) const {
    if (!node.is_table()) fail(node, fmt::format("expected a table for {}, got {}", key_path(key), type_name(node)));
    return {file_, key_path(key), *node.as_table()};
  }

  /// Call once every key has been asked for.
  void refuse_others() const {
    for (const auto& [key, node] : table_) {
      if (asked_.contains(key.str())) continue;
      std::string known;
      for (const std::string& name : asked_) known.append(known.empty() ? "" : ", ").append(name);
      throw InputFileError(file_, static_cast<int>(key.source().begin.line),
                           fmt::format("expected one of {}; got \"{}\"", known, key_path(key.str())));
    }
  }

 private:
  std::string file_;
  std::string path_;
  const toml::table& table_;
  std::set<std::string, std::less<>> asked_;
};

toml::table parse(const TextFile& file) {
  try {
    return toml::parse(file.text, file.name);
  } catch (const toml::parse_error& error) {
    throw InputFileError(file.name, static_cast<int>(error.source().begin.line),
                         fmt::format("expected TOML, got something else: {}", error.description()));
  }
}

Eigen::Vector3d vector_of(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

Geometry geometry_of(Section section) {
  Geometry geometry;
  geometry.base_radius = section.number("base_radius_mm");
  geometry.plate_radius = section.number("plate_radius_mm");
  geometry.arm = section.number("arm_mm");
  geometry.rod = section.number("rod_mm");
  geometry.parallelogram_width = section.number("parallelogram_width_mm");
  for (const double azimuth : section.numbers("limb_azimuth_deg")) geometry.limb_azimuth.push_back(to_radians(azimuth));
  const std::string actuator = section.text("actuator");
  if (actuator != "revolute") {
    section.fail(section.require("actuator", ""),
                 fmt::format("expected \"revolute\" for {}, got \"{}\"{}", section.key_path("actuator"), actuator,
                             actuator == "linear" ? " (linear actuators are not supported yet)" : ""));
  }
  section.refuse_others();
  return geometry;
}

Slide slide_of(Section section) {
  Slide slide;
  slide.axis = vector_of(section.numbers("slide_axis", 3));
  slide.sign = section.numbers("slide_sign");
  slide.pinion_radius = section.number("pinion_radius_mm");
  section.refuse_others();
  return slide;
}

Workspace workspace_of(Section section) {
  Workspace workspace;
  workspace.radius = section.number("radius_mm");
  workspace.height = section.number("height_mm");
  workspace.top_z = section.number("top_z_mm");
  if (const toml::node* rotation = section.find("rotation_deg")) {
    const std::vector<double> limits = section.numbers_of(*rotation, "rotation_deg");
    if (limits.size() != 2) {
      section.fail(*rotation, fmt::format("expected [smallest, largest] for {}, got {} numbers",
                                          section.key_path("rotation_deg"), limits.size()));
    }
    workspace.min_rotation = to_radians(limits[0]);
    workspace.max_rotation = to_radians(limits[1]);
  }
  section.refuse_others();
  return workspace;
}

Tolerances tolerances_of(Section section) {
  Tolerances tolerances;
  const auto half_width = [&](const std::string& key) {
    const double value = section.number_or(key, 0.0);
    if (value < 0.0) {
      section.fail(*section.find(key),
                   fmt::format("expected a half-width of at least 0 for {}, got {}", section.key_path(key), value));
    }
    return value;
  };
  for (const Source source : all_sources()) {
    tolerances[source] = from_file_unit(source, half_width(is_e(source) ? "e_mm" : file_key(source)));
  }
  if (const toml::node* node = section.find("distribution")) {
    const std::string name = section.text("distribution");
    const std::optional<Distribution> distribution = distribution_named(name);
    if (!distribution) {
      section.fail(*node, fmt::format("expected {} for {}, got \"{}\"", distribution_names(),
                                      section.key_path("distribution"), name));
    }
    tolerances.distribution = *distribution;
  }
  if (auto measured = section.optional_table("measured")) {
    for (const Source source : all_sources()) {
      const std::string key = is_e(source) ? "e_mm" : file_key(source);
      if (!measured->find(key)) continue;
      for (const double value : measured->numbers(key)) {
        tolerances.measured[index(source)].push_back(from_file_unit(source, value));
      }
    }
    measured->refuse_others();
  }
  section.refuse_others();
  return tolerances;
}

RobotDescription description_of(const TextFile& file, const toml::table& document) {
  Section root(file.name, "", document);
  RobotDescription robot;
  robot.name = root.text("name");
  robot.geometry = geometry_of(root.table("geometry"));
  if (const auto plate = root.optional_table("plate")) robot.slide = slide_of(*plate);
  robot.workspace = workspace_of(root.table("workspace"));
  if (const auto tolerances = root.optional_table("tolerances")) robot.tolerances = tolerances_of(*tolerances);
  root.refuse_others();
  return robot;
}

/// Line of the key that a complaint of Robot begins with ("geometry.arm_mm: ..."), or of its table; 0 when there is
/// none.
int line_of_complaint(const toml::table& document, std::string_view complaint) {
  const std::string_view path = complaint.substr(0, complaint.find(':'));
  if (const auto node = document.at_path(path)) return static_cast<int>(node.node()->source().begin.line);
  return 0;
}

std::string quoted(const std::string& text) {
  std::ostringstream stream;
  stream << toml::value<std::string>(text);
  return stream.str();
}

std::string array(const auto& values) {
  std::string text;
  for (const double value : values) fmt::format_to(std::back_inserter(text), "{}{}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

}  // namespace

Robot read_robot(const TextFile& file) {
  const toml::table document = parse(file);
  RobotDescription description = description_of(file, document);
  try {
    return Robot(std::move(description));
  } catch (const InvalidArgument& complaint) {
    throw InputFileError(file.name, line_of_complaint(document, complaint.what()), complaint.what());
  }
}

namespace {

void write_measured(const Tolerances& tolerances, std::back_insert_iterator<std::string> out) {
  bool any = false;
  for (const Source source : all_sources()) {
    if (source == Source::e_y || source == Source::e_z || tolerances.measured[index(source)].empty()) continue;
    std::vector<double> values;
    for (const double value : tolerances.measured[index(source)]) values.push_back(tidy(to_file_unit(source, value)));
    fmt::format_to(out, "{}{} = {}\n", any ? "" : "\n[tolerances.measured]  # errors of built parts\n",
                   is_e(source) ? "e_mm" : file_key(source), array(values));
    any = true;
  }
}

}  // namespace

std::string robot_toml(const Robot& robot) {
  std::string text;
  const auto out = std::back_inserter(text);
  const Geometry& geometry = robot.geometry();
  std::vector<double> azimuth;
  for (const double angle : geometry.limb_azimuth) azimuth.push_back(tidy_degrees(angle));
  fmt::format_to(out, "name = {}\n\n[geometry]\nbase_radius_mm = {}\nplate_radius_mm = {}\narm_mm = {}\nrod_mm = {}\n",
                 quoted(robot.name()), geometry.base_radius, geometry.plate_radius, geometry.arm, geometry.rod);
  fmt::format_to(out, "parallelogram_width_mm = {}\nlimb_azimuth_deg = {}\nactuator = \"revolute\"\n",
                 geometry.parallelogram_width, array(azimuth));
  if (const std::optional<Slide>& slide = robot.slide()) {
    fmt::format_to(out, "\n[plate]\nslide_axis = {}\nslide_sign = {}\npinion_radius_mm = {}\n", array(slide->axis),
                   array(slide->sign), slide->pinion_radius);
  }
  const Workspace& workspace = robot.workspace();
  fmt::format_to(out, "\n[workspace]\nradius_mm = {}\nheight_mm = {}\ntop_z_mm = {}\nrotation_deg = {}\n",
                 workspace.radius, workspace.height, workspace.top_z,
                 array(std::array{tidy_degrees(workspace.min_rotation), tidy_degrees(workspace.max_rotation)}));
  if (const std::optional<Tolerances>& tolerances = robot.tolerances()) {
    fmt::format_to(out, "\n[tolerances]  # half-widths, 3 sigma\n");
    for (const Source source : all_sources()) {
      if (source == Source::e_y || source == Source::e_z) continue;
      fmt::format_to(out, "{} = {}\n", is_e(source) ? "e_mm" : file_key(source),
                     tidy(to_file_unit(source, (*tolerances)[source])));
    }
    fmt::format_to(out, "distribution = \"{}\"\n", distribution_name(tolerances->distribution));
    write_measured(*tolerances, out);
  }
  return text;
}

Tolerances read_tolerances(const TextFile& file) {
  const toml::table document = parse(file);
  Section root(file.name, "", document);
  if (!root.find("tolerances")) return tolerances_of(root);
  return tolerances_of(root.table("tolerances"));
}

std::string source_errors_toml(const SourceErrors& errors, std::size_t limb_count) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (std::size_t limb = 0; limb < limb_count; ++limb) {
    fmt::format_to(out, "{}[[limb]]\n", limb == 0 ? "" : "\n");
    const auto value = [&](Source source) { return to_file_unit(source, errors(limb, source)); };
    for (const Source source : all_sources()) {
      if (source == Source::e_x) {
        fmt::format_to(out, "e_mm = {}\n", array(std::array{value(source), value(Source::e_y), value(Source::e_z)}));
      } else if (!is_e(source)) {
        fmt::format_to(out, "{} = {}\n", file_key(source), value(source));
      }
    }
  }
  return text;
}

SourceErrors read_source_errors(const TextFile& file, std::size_t limb_count) {
  const toml::table document = parse(file);
  Section root(file.name, "", document);
  const toml::node& limbs = root.require("limb", "one [[limb]] table a limb");
  root.refuse_others();
  if (!limbs.is_array_of_tables()) root.fail(limbs, fmt::format("expected [[limb]] tables, got {}", type_name(limbs)));
  const toml::array& tables = *limbs.as_array();
  if (tables.size() != limb_count) {
    root.fail(limbs,
              fmt::format("expected {} [[limb]] tables as the robot has limbs, got {}", limb_count, tables.size()));
  }
  SourceErrors errors;
  for (std::size_t i = 0; i < limb_count; ++i) {
    Section limb = root.as_table(tables[i], fmt::format("limb {}", i + 1));
    for (const Source source : all_sources()) {
      if (!is_e(source)) errors(i, source) = from_file_unit(source, limb.number_or(file_key(source), 0.0));
    }
    if (limb.find("e_mm")) {
      const std::vector<double> e = limb.numbers("e_mm", 3);
      for (std::size_t k = 0; k < 3; ++k) errors(i, static_cast<Source>(index(Source::e_x) + k)) = e[k];
    }
    limb.refuse_others();
  }
  return errors;
}

}  // namespace paracal::io
