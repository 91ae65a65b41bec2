#pragma once

// Private to io: the JSON Schemas (draft 2020-12) of structs with a list of fields.

#include <fmt/format.h>

#include <cstdint>
#include <set>
#include <string>

#include "field.hpp"

namespace paracal::io {

/// Collects the schemas of structs, and of all structs in them that belong to the same file, each once.
class SchemaFile {
 public:
  explicit SchemaFile(std::string_view name) : name_(name) {}

  /// The schema of what the file as a whole describes.
  template <typename Struct>
  Json of_result() {
    Json schema{{"$schema", kDraft}};
    schema.update(object<Struct>());
    schema["$defs"] = parts_;
    return schema;
  }

  /// Of parts that several results refer to.
  template <typename... Structs>
  Json of_parts(std::string_view title, std::string_view meaning) {
    (reference<Structs>(), ...);
    return {{"$schema", kDraft}, {"title", title}, {"description", meaning}, {"$defs", parts_}};
  }

 private:
  static constexpr std::string_view kDraft = "https://json-schema.org/draft/2020-12/schema";

  template <typename Struct>
  Json object() {
    constexpr Place place = List<Struct>::kPlace;
    Json schema{{"title", place.title}};
    if (!place.meaning.empty()) schema["description"] = place.meaning;
    schema["type"] = "object";
    Json properties = Json::object(), required = Json::array();
    const auto add = [&](std::string_view key, Json one, std::string_view meaning, const Form& form) {
      if (!meaning.empty()) one["description"] = meaning;
      properties[std::string(key)] = std::move(one);
      if (!form.may_lack) required.push_back(key);
    };
    if constexpr (HasValues<Struct>) {
      List<Struct>::values(List<Struct>::example(),
                           [&]<typename T>(std::string_view key, const T& /*value*/, std::string_view meaning,
                                           const Form& form) { add(key, of_value<T>(form), meaning, form); });
    } else {
      List<Struct>::fields(
          [&]<typename Get>(std::string_view key, const Get& /*get*/, std::string_view meaning, const Form& form = {}) {
            add(key, of_value<ValueOf<Struct, Get>>(form), meaning, form);
          });
    }
    schema["properties"] = std::move(properties);
    schema["required"] = std::move(required);
    if constexpr (requires { List<Struct>::one_of(); }) schema["oneOf"] = List<Struct>::one_of();
    schema["additionalProperties"] = false;
    return schema;
  }

  template <typename Struct>
  Json reference() {
    constexpr Place place = List<Struct>::kPlace;
    const std::string part = fmt::format("#/$defs/{}", place.name);
    if (place.file != name_) return {{"$ref", std::string(place.file) + part}};
    if (known_.insert(part).second) {
      Json schema = object<Struct>();  // first, so that the parts of a part stand before it
      parts_[std::string(place.name)] = std::move(schema);
    }
    return {{"$ref", part}};
  }

  template <typename T>
  Json of_value(const Form& form) {
    if constexpr (is_optional<T>) {
      const Json schema = of_value<typename T::value_type>(form);
      return form.may_lack ? schema : nullable(schema);
    } else if (!form.refers.empty()) {
      return {{"$ref", form.refers}};
    } else if (!form.only.empty()) {
      return {{"const", form.only}};
    } else if constexpr (Listed<T>) {
      return reference<T>();
    } else if constexpr (Worded<T> || Named<T>) {
      return {{"enum", words_of<T>()}};
    } else if constexpr (is_choice<T>) {
      return choice(form, static_cast<const T*>(nullptr));
    } else if constexpr (std::same_as<T, bool>) {
      return {{"type", "boolean"}};
    } else if constexpr (std::is_arithmetic_v<T>) {
      return number(std::is_integral_v<T> ? "integer" : "number", form);
    } else if constexpr (std::is_convertible_v<T, std::string_view>) {
      Json schema{{"type", "string"}};
      if (!form.pattern.empty()) schema["pattern"] = form.pattern;
      return schema;
    } else if constexpr (std::same_as<T, Eigen::Vector3d>) {
      return {{"$ref", "common.schema.json#/$defs/vector"}};
    } else if constexpr (std::same_as<T, Eigen::Matrix3d>) {
      return {{"$ref", "common.schema.json#/$defs/rotation_matrix"}};
    } else if constexpr (EigenValue<T>) {
      const Json row = list_of(number("number", form));
      return EigenMatrix<T> ? list_of(row) : row;
    } else {
      return list_of(of_value<typename T::value_type>(form));
    }
  }

  template <typename... T>
  Json choice(const Form& form, const std::variant<T...>* /*of these*/) {
    return {{"title", form.title}, {"anyOf", Json::array({reference<T>()...})}};
  }

  static Json list_of(const Json& item) { return {{"type", "array"}, {"items", item}}; }

  static Json number(const char* type, const Form& form) {
    Json schema{{"type", type}};
    if (form.least) schema["minimum"] = limit(*form.least);
    if (form.most) schema["maximum"] = limit(*form.most);
    return schema;
  }

  /// Messages show it: 0, not 0.0.
  static Json limit(double value) {
    const auto whole = static_cast<std::int64_t>(value);
    return static_cast<double>(whole) == value ? Json(whole) : Json(value);
  }

  static Json nullable(Json schema) {
    if (schema.contains("enum")) {
      schema["enum"].push_back(nullptr);
    } else if (schema.contains("type") && schema["type"] != "array") {
      schema["type"] = Json::array({schema["type"], "null"});
    } else {
      schema = {{"anyOf", Json::array({schema, {{"type", "null"}}})}};
    }
    return schema;
  }

  std::string_view name_;
  std::set<std::string> known_;
  Json parts_ = Json::object();
};

}  // namespace paracal::io
