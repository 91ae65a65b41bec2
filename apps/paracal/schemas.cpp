#include "schemas.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "embedded.hpp"

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

}  // namespace

std::vector<std::string> schema_names() {
  std::vector<std::string> names;
  for (const detail::EmbeddedFile& file : detail::result_schemas()) {
    if (name_of(file) != "common") names.emplace_back(name_of(file));
  }
  return names;
}

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

}  // namespace paracal::app
