#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "embedded.hpp"
#include "paracal/io/json.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

constexpr std::string_view kSuffix = ".schema.json", kParts = "#/$defs/";

std::string_view name_of(const detail::EmbeddedFile& file) {
  return file.name.substr(0, file.name.size() - kSuffix.size());
}

io::Json file_named(std::string_view name) {
  return io::Json::parse(std::ranges::find(detail::result_schemas(), name, &name_of)->text);
}

/// Parts of several files, in one.
class Parts {
 public:
  /// Makes references within a schema of a file lead to parts, and takes these in.
  void point_inwards(io::Json& schema, const std::string& file) {
    if (schema.is_object() && schema.contains("$ref")) {
      schema["$ref"] = std::string(kParts) + take(schema["$ref"].get<std::string>(), file);
    }
    if (!schema.is_structured()) return;
    for (io::Json& below : schema) point_inwards(below, file);
  }

  /// What a reference in a file leads to: "#/$defs/stage", "common.schema.json#/$defs/vector", "robot.schema.json".
  /// @returns the name of the part.
  std::string take(const std::string& reference, const std::string& file) {
    const std::size_t mark = reference.find(kParts);
    const bool is_whole = mark == std::string::npos;
    const std::string from = mark == 0 ? file : reference.substr(0, reference.find(kSuffix));
    std::string name = is_whole ? from : reference.substr(mark + kParts.size());
    if (json_.contains(name)) return name;
    json_[name] = nullptr;  // it may lead back to itself
    io::Json part = file_named(from);
    if (!is_whole) part = io::Json(part["$defs"][name]);
    for (const char* of_files : {"$schema", "$defs"}) part.erase(of_files);
    point_inwards(part, from);
    json_[name] = std::move(part);
    return name;
  }

  const io::Json& json() const { return json_; }

 private:
  io::Json json_ = io::Json::object();
};

/// Of all results: "calibration".
std::vector<std::string> schema_names() {
  std::vector<std::string> names;
  for (const detail::EmbeddedFile& file : detail::result_schemas()) {
    const bool has_parts_alone = name_of(file) == "common" || name_of(file) == "parts";
    if (!has_parts_alone) names.emplace_back(name_of(file));
  }
  return names;
}

/// What a result looks like, by itself: a JSON Schema (draft 2020-12) that refers to nothing outside of it. What its
/// file in schema/ takes from others stands under its `$defs`.
io::Json result_schema(const std::string& name) {
  io::Json schema = file_named(name);
  const io::Json own = schema.value("$defs", io::Json::object());
  schema.erase("$defs");
  Parts parts;
  for (const auto& [part, unused] : own.items()) parts.take(std::string(kParts) + part, name);
  parts.point_inwards(schema, name);
  schema["$defs"] = parts.json();
  return schema;
}

void list_schemas(Session& session) {
  io::Json schemas = io::Json::array();
  std::string text;
  for (const std::string& name : schema_names()) {
    const std::string about = result_schema(name).at("description").get<std::string>();
    schemas.push_back({{"name", name}, {"about", about}});
    text += fmt::format("{:<22}{}\n", name, about);
  }
  session.json() ? session.print_json({{"schemas", schemas}}) : session.print(text);
}

}  // namespace

void add_schema(Command& program, Session& session) {
  Command* command = session.add_command(program, "schema", "Read its results",
                                         "print the JSON Schema of a result, or list all schemas");
  const auto name = std::make_shared<std::string>();
  command->add_option("name", *name, "name of the result")->check(one_of(schema_names()));
  command->example("All schemas", "paracal schema");
  command->callback(
      [&session, name] { name->empty() ? list_schemas(session) : session.print_json(result_schema(*name)); });
}

}  // namespace paracal::app
