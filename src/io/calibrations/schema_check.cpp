#include "schema_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <regex.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "embedded.hpp"

namespace paracal::io {
namespace {

/// A schema, or a part of it, with the file that its references are relative to.
struct Rule {
  const Json* schema = nullptr;
  const Json* file = nullptr;
};

/// Each file is parsed when it is first needed.
const Json& schema_file(std::string_view name) {
  thread_local std::map<std::string_view, Json> files;
  const auto& all = detail::result_schemas();
  const auto found = std::ranges::find(all, name, &detail::EmbeddedFile::name);
  const auto [place, is_new] = files.try_emplace(found->name);
  if (is_new) place->second = Json::parse(found->text);
  return place->second;
}

/// "common.schema.json#/$defs/vector", "#/$defs/use" or "robot.schema.json".
Rule referred(const Json& file, const std::string& reference) {
  const std::size_t hash = std::min(reference.find('#'), reference.size());
  const Json& in = hash == 0 ? file : schema_file(std::string_view(reference).substr(0, hash));
  const std::string place = reference.substr(std::min(hash + 1, reference.size()));
  return {&in.at(Json::json_pointer(place)), &in};
}

/// By the C library's regular expressions: the standard library's take five seconds to compile.
class Pattern {
 public:
  explicit Pattern(const std::string& text) {
    const int error = regcomp(&compiled_, text.c_str(), REG_EXTENDED | REG_NOSUB);
    if (error == REG_ESPACE) throw std::bad_alloc();
    assert(error == 0);
  }
  Pattern(const Pattern&) = delete;
  Pattern& operator=(const Pattern&) = delete;
  ~Pattern() { regfree(&compiled_); }

  bool fits(const std::string& text) const {
    if (text.find('\0') != std::string::npos) return false;
    const int found = regexec(&compiled_, text.c_str(), 0, nullptr, 0);
    if (found == REG_ESPACE) throw std::bad_alloc();
    return found == 0;
  }

 private:
  regex_t compiled_ = {};
};

bool fits(const std::string& text, const std::string& pattern) {
  thread_local std::map<std::string, Pattern> patterns;  // which take longer to prepare than to use
  return patterns.try_emplace(pattern, pattern).first->second.fits(text);
}

bool is_whole(const Json& value) {
  return value.is_number_integer() || (value.is_number() && std::floor(value.get<double>()) == value.get<double>());
}

struct Type {
  std::string_view name, words;
  bool (*has)(const Json&);
};
constexpr std::array<Type, 7> kTypes{{{"number", "a number", [](const Json& json) { return json.is_number(); }},
                                      {"integer", "a whole number", is_whole},
                                      {"string", "a text", [](const Json& json) { return json.is_string(); }},
                                      {"boolean", "true or false", [](const Json& json) { return json.is_boolean(); }},
                                      {"array", "an array", [](const Json& json) { return json.is_array(); }},
                                      {"object", "an object", [](const Json& json) { return json.is_object(); }},
                                      {"null", "null", [](const Json& json) { return json.is_null(); }}}};

/// Walks a value and its schema together, as far as the first value that is wrong.
class Walk {
 public:
  explicit Walk(std::span<const std::string_view> passed_over) : passed_over_(passed_over) {}

  /// What was expected of the value at path(), or nothing.
  std::optional<std::string> complaint(Rule rule, const Json& value) {
    const Json& schema = *rule.schema;
    if (auto found = of_type(schema, value)) return found;
    if (schema.size() == 1 && schema.contains("type")) return std::nullopt;  // thousands of numbers
    if (schema.contains("$ref")) {
      if (auto found = complaint(referred(*rule.file, schema["$ref"]), value)) return found;
    }
    if (auto found = of_value(schema, value)) return found;
    if (schema.contains("anyOf")) {
      if (auto found = of_alternatives({&schema["anyOf"], rule.file}, value)) return found;
    }
    return of_parts(rule, value);
  }
  const std::vector<std::string>& path() const { return path_; }

 private:
  static std::optional<std::string> of_type(const Json& schema, const Json& value) {
    if (!schema.contains("type")) return std::nullopt;
    const Json& type = schema["type"];
    std::vector<std::string_view> words;
    for (const Json& one : type.is_array() ? type : Json::array({type})) {
      const auto* known = std::ranges::find(kTypes, one.get_ref<const std::string&>(), &Type::name);
      if (known->has(value)) return std::nullopt;
      words.push_back(known->words);
    }
    return fmt::format("{}", fmt::join(words, " or "));
  }

  static std::optional<std::string> of_value(const Json& schema, const Json& value) {
    const auto has = [&](const char* key) { return schema.contains(key); };
    if (has("const") && value != schema["const"]) return schema["const"].dump();
    if (has("enum") && std::ranges::find(schema["enum"], value) == schema["enum"].end()) {
      return fmt::format("one of {}", schema["enum"].dump());
    }
    if (value.is_number()) {
      if (has("minimum") && value < schema["minimum"]) return "a number of at least " + schema["minimum"].dump();
      if (has("maximum") && value > schema["maximum"]) return "a number of at most " + schema["maximum"].dump();
    }
    if (value.is_string() && has("pattern") && !fits(value, schema["pattern"])) {
      if (has("examples")) return "a text like " + schema["examples"][0].get<std::string>();
      return fmt::format("a text of the form {}", schema["pattern"].get_ref<const std::string&>());
    }
    if (value.is_array() && has("minItems") && value.size() < schema["minItems"]) {
      return fmt::format("at least {} entries", schema["minItems"].dump());
    }
    if (value.is_array() && has("maxItems") && value.size() > schema["maxItems"]) {
      return fmt::format("at most {} entries", schema["maxItems"].dump());
    }
    return std::nullopt;
  }

  /// Of those that all forbid the value, the complaint of the one that was followed furthest. An object is of those
  /// that know all its keys, if any does: another might pass over the key that is wrong.
  std::optional<std::string> of_alternatives(Rule alternatives, const Json& value) {
    std::vector<Rule> all;
    for (const Json& one : *alternatives.schema) all.push_back({&one, alternatives.file});
    const auto knows = [&](Rule one) { return knows_keys(one, value); };
    if (std::ranges::any_of(all, knows)) std::erase_if(all, std::not_fn(knows));
    std::optional<std::string> found;
    std::vector<std::string> place;
    const std::vector<std::string> here = path_;
    int furthest = -1;
    for (const Rule& one : all) {
      const int before = followed_;
      auto said = complaint(one, value);
      if (said && followed_ - before > furthest) {
        furthest = followed_ - before;
        found = said;
        place = path_;
      }
      path_ = here;
      if (!said) return std::nullopt;
    }
    path_ = std::move(place);
    return found;
  }

  static bool knows_keys(Rule rule, const Json& value) {
    if (!value.is_object()) return true;
    if (rule.schema->contains("$ref")) rule = referred(*rule.file, (*rule.schema)["$ref"]);
    const auto is_known = [&](const auto& item) { return of_key(*rule.schema, item.key()) != nullptr; };
    const auto items = value.items();
    return std::all_of(items.begin(), items.end(), is_known);
  }

  std::optional<std::string> of_parts(Rule rule, const Json& value) {
    if (value.is_array() && rule.schema->contains("items")) {
      for (std::size_t k = 0; k < value.size(); ++k) {
        if (auto found = below({&(*rule.schema)["items"], rule.file}, std::to_string(k), value[k])) return found;
      }
    }
    if (!value.is_object()) return std::nullopt;
    for (const auto& item : value.items()) {
      const Json* schema = of_key(*rule.schema, item.key());
      const bool is_passed_over = path_.empty() && std::ranges::find(passed_over_, item.key()) != passed_over_.end();
      if (schema == nullptr || is_passed_over) continue;
      if (auto found = below({schema, rule.file}, item.key(), item.value())) return found;
    }
    return std::nullopt;
  }

  static const Json* of_key(const Json& schema, const std::string& key) {
    if (const auto known = schema.find("properties"); known != schema.end() && known->contains(key)) {
      return &(*known)[key];
    }
    if (const auto patterns = schema.find("patternProperties"); patterns != schema.end()) {
      for (const auto& item : patterns->items()) {
        if (fits(key, item.key())) return &item.value();
      }
    }
    return nullptr;
  }

  std::optional<std::string> below(Rule rule, std::string key, const Json& value) {
    path_.push_back(std::move(key));
    ++followed_;
    auto found = complaint(rule, value);
    if (!found) path_.pop_back();
    return found;
  }

  std::span<const std::string_view> passed_over_;
  std::vector<std::string> path_ = {};  ///< keys, and places in arrays
  int followed_ = 0;                    ///< values so far
};

}  // namespace

void require_schema(const JsonNode& node, std::string_view schema, std::span<const std::string_view> passed_over) {
  const Json& file = schema_file(schema);
  Walk walk(passed_over);
  if (const auto expected = walk.complaint({&file, &file}, node.json()))
    node.descendant(walk.path()).refuse_as(*expected);
}

}  // namespace paracal::io
