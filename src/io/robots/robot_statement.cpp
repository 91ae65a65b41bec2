#include "paracal/io/robot_statement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/calibrations/json_node.hpp"
#include "io/files/stored.hpp"
#include "io/tables/columns.hpp"
#include "paracal/error.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "robot_tables.hpp"
#include "same_robot.hpp"

namespace paracal::io {
namespace {

bool agrees(const Json& expected, const Json& got) {
  constexpr double kRounding = 1e-9;
  if (expected.is_array() && got.is_array()) return std::ranges::equal(expected, got, agrees);
  if (expected.is_object() && got.is_object()) {
    const auto same = [&](const auto& item) {
      return got.contains(item.key()) && agrees(item.value(), got[item.key()]);
    };
    const auto items = expected.items();
    return expected.size() == got.size() && std::all_of(items.begin(), items.end(), same);
  }
  if (!expected.is_number() || !got.is_number()) return expected == got;
  const double a = expected.get<double>(), b = got.get<double>();
  return std::abs(a - b) <= kRounding * std::max({1.0, std::abs(a), std::abs(b)});
}

/// A value in a message; what is nested deeper than a robot's is not followed.
std::string shown(const Json& json) {
  const bool is_nested =
      json.is_structured() && std::ranges::any_of(json, [](const Json& v) { return v.is_structured(); });
  return is_nested ? "something nested" : json.dump();
}

/// Of two values and all that they hold; `path` names them.
std::optional<std::string> first_difference(const Json& expected, const Json& got, const std::string& path) {
  const bool same_shape = expected.type() == got.type() && expected.size() == got.size();
  if (same_shape && expected.is_object()) {
    for (const auto& [key, value] : expected.items()) {
      const std::string inner = fmt::format("{}.{}", path, key);
      if (auto found = first_difference(value, got.value(key, Json()), inner)) return found;
    }
    return std::nullopt;
  }
  const auto is_structured = [](const Json& one) { return one.is_structured(); };
  if (same_shape && expected.is_array() && std::ranges::any_of(expected, is_structured)) {
    for (std::size_t k = 0; k < expected.size(); ++k) {
      if (auto found = first_difference(expected[k], got[k], fmt::format("{} {}", path, k + 1))) return found;
    }
    return std::nullopt;
  }
  const bool same =
      same_shape && expected.is_array() ? std::ranges::equal(expected, got, agrees) : agrees(expected, got);
  if (same) return std::nullopt;
  return fmt::format("{} {}, got {}", path, shown(expected), shown(got));
}

/// The name in "# robot: NAME"; spreadsheets put separators behind it.
std::optional<std::string> name_in(std::string_view line) {
  constexpr std::string_view kKey = "robot:";
  if (!line.starts_with('#')) return std::nullopt;
  line = trimmed(line.substr(1));
  if (!line.starts_with(kKey)) return std::nullopt;
  return std::string(trimmed(line.substr(kKey.size()), " \t\r,;"));
}

/// Whether a name stands for a file rather than the catalogue's.
bool is_file(const std::filesystem::path& name) { return name.extension() == ".toml" || name.has_parent_path(); }

/// Where a table's robot file is looked for: in its folder; of standard input and other open files in the current one.
std::filesystem::path folder_of(const std::string& table) {
  const bool is_open_already = table.starts_with("/dev/") || table.starts_with("/proc/");
  return is_open_already ? std::filesystem::path() : std::filesystem::path(table).parent_path();
}

/// Of a line in a table that lies in `folder`.
void require_robot_file(const std::string& name, const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!is_file(name) || std::filesystem::exists(folder / name, ignored)) return;
  throw InvalidArgument(
      fmt::format("expected the robot file {}, got none there; write the path from this table's folder "
                  "to the file, or remove this line and add --robot FILE",
                  (folder / name).string()));
}

/// The depth of a robot's JSON is 4; nothing deeper is followed.
constexpr int kDeepestRobot = 8;

toml::array toml_of_array(const Json& json, int depth);

/// Calls add(value) with what TOML has for a JSON value.
void convert(const Json& json, int depth, const auto& add);

toml::table toml_of_object(const Json& json, int depth) {
  toml::table table;
  for (const auto& item : json.items()) {
    const auto add = [&](auto&& one) { table.insert_or_assign(item.key(), std::forward<decltype(one)>(one)); };
    convert(item.value(), depth + 1, add);
  }
  return table;
}

void convert(const Json& json, int depth, const auto& add) {
  if (depth > kDeepestRobot) throw InvalidArgument("expected a robot, got deeper nesting");
  if (json.is_object()) return add(toml_of_object(json, depth));
  if (json.is_array()) return add(toml_of_array(json, depth));
  if (json.is_number()) return add(json.get<double>());
  if (json.is_boolean()) return add(json.get<bool>());
  add(json.get<std::string>());  // of null, refuse_null() came before
}

toml::array toml_of_array(const Json& json, int depth) {
  toml::array array;
  for (const Json& value : json) {
    convert(value, depth + 1, [&](auto&& one) { array.push_back(std::forward<decltype(one)>(one)); });
  }
  return array;
}

/// TOML has no null.
void refuse_null(const JsonNode& node, int depth) {
  if (node.json().is_null()) node.refuse_as("a value");
  if (depth > kDeepestRobot) return;
  if (node.json().is_array()) {
    for (const JsonNode& one : node.entries()) refuse_null(one, depth + 1);
  }
  if (!node.json().is_object()) return;
  for (const auto& item : node.json().items()) refuse_null(node.at(item.key().c_str()), depth + 1);
}

/// @param read  the file, where it is no name of the catalogue.
RobotStatement robot_under(const std::string& name, const std::filesystem::path& folder, const auto& read) {
  const std::filesystem::path path(name);
  if (!is_file(path)) return {.robot = catalogue::find(name), .by = name};
  const std::filesystem::path file = folder / path;
  return {.robot = read_robot(read(file)), .by = file.string(), .robot_file = file};
}

}  // namespace

RobotStatement named_robot(const std::string& name, const std::filesystem::path& folder) {
  return robot_under(name, folder, read_stored);
}

std::optional<RobotStatement> robot_of_line(const std::string& file, int line, std::string_view text) {
  const std::optional<std::string> name = name_in(text);
  if (!name) return std::nullopt;
  try {
    const std::filesystem::path folder = folder_of(file);
    require_robot_file(*name, folder);
    RobotStatement stated = robot_under(*name, folder, read_included);
    stated.by = file;
    stated.line = line;
    return stated;
  } catch (const Error& unknown) {
    throw InputFileError(file, line, unknown.what());
  }
}

void add_statement(std::optional<RobotStatement>& found, const std::string& file, int line, std::string_view text) {
  std::optional<RobotStatement> stated = robot_of_line(file, line, text);
  if (stated && found) require_same(*found, *stated);
  if (stated && !found) found = std::move(stated);
}

std::optional<RobotStatement> robot_of_table(const TextFile& file) {
  std::optional<RobotStatement> found;
  int line = 0;
  for (const std::string_view text : lines_of(file.text)) add_statement(found, file.name, ++line, text);
  return found;
}

Robot robot_in(const JsonNode& node, const std::string& file) {
  refuse_null(node, 0);
  try {
    return robot_of(file, toml_of_object(node.json(), 0));
  } catch (const InvalidArgument& complaint) {
    node.refuse(complaint.what());
  } catch (const InputFileError& complaint) {
    node.refuse(std::string(complaint.what()).substr(file.size() + 2));  // its tables have no lines of their own
  }
}

RobotStatement robot_of_calibration(const JsonFile& file) {
  const JsonNode robot = JsonNode(file.text, file.json, "a calibration").object_at("robot");
  return {.robot = robot_in(robot, file.text.name), .by = file.text.name, .line = robot.line()};
}

std::optional<std::string> robot_difference(const Json& expected, const Json& got) {
  for (const char* part : {"name", "geometry", "plate", "limb"}) {
    if (auto found = first_difference(expected.value(part, Json()), got.value(part, Json()), part)) return found;
  }
  return std::nullopt;
}

std::optional<std::string> difference(const Robot& expected, const Robot& got) {
  return robot_difference(to_json(expected), to_json(got));
}

void require_same(const RobotStatement& expected, const RobotStatement& got) {
  if (const auto found = difference(expected.robot, got.robot)) {
    throw InputFileError(got.by, got.line, fmt::format("expected the robot of {} with {}", expected.by, *found));
  }
}

std::string robot_line(const Robot& robot) {
  const auto known = catalogue::names();
  if (std::ranges::find(known, robot.name()) == known.end()) return "";
  return difference(catalogue::find(robot.name()), robot) ? "" : fmt::format("# robot: {}\n", robot.name());
}

}  // namespace paracal::io
