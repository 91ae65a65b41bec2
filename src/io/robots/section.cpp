#include "section.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "io/files/stored.hpp"
#include "paracal/error.hpp"
#include "paracal/spelling.hpp"

namespace paracal::io {

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

void Section::fail(const toml::node& where, const std::string& complaint) const {
  throw InputFileError(file_, static_cast<int>(where.source().begin.line), complaint);
}

std::string Section::key_path(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

const toml::node* Section::find(std::string_view key) {
  asked_.emplace(key);
  return table_.get(key);
}

const toml::node& Section::require(std::string_view key, std::string_view expected) {
  if (const toml::node* node = find(key)) return *node;
  fail(fmt::format("expected {} ({}), got nothing", key_path(key), expected));
}

double Section::number_of(const toml::node& node, std::string_view key, const plausible::Range& range) const {
  const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value) fail(node, fmt::format("expected a number for {}, got {}", key_path(key), type_name(node)));
  if (!std::isfinite(*value)) fail(node, fmt::format("expected a finite number for {}, got {}", key_path(key), *value));
  if (const auto complaint = plausible::complaint(key_path(key), *value, range)) fail(node, *complaint);
  return *value;
}

double Section::number_or(std::string_view key, double otherwise, const plausible::Range& range) {
  const toml::node* node = find(key);
  return node ? number_of(*node, key, range) : otherwise;
}

std::vector<double> Section::numbers_of(const toml::node& node, std::string_view key,
                                        const plausible::Range& range) const {
  if (!node.is_array())
    fail(node, fmt::format("expected an array of numbers for {}, got {}", key_path(key), type_name(node)));
  std::vector<double> values;
  for (const toml::node& element : *node.as_array()) values.push_back(number_of(element, key, range));
  return values;
}

std::vector<double> Section::numbers(std::string_view key, const plausible::Range& range,
                                     std::optional<std::size_t> count) {
  const toml::node& node = require(key, "an array of numbers");
  std::vector<double> values = numbers_of(node, key, range);
  if (count && values.size() != *count) {
    fail(node, fmt::format("expected {} numbers for {}, got {}", *count, key_path(key), values.size()));
  }
  return values;
}

std::string Section::text_of(const toml::node& node, std::string_view key) const {
  if (!node.is_string()) fail(node, fmt::format("expected a text for {}, got {}", key_path(key), type_name(node)));
  return **node.as_string();
}

bool Section::flag(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  if (!node->is_boolean()) {
    fail(*node, fmt::format("expected true or false for {}, got {}", key_path(key), type_name(*node)));
  }
  return **node->as_boolean();
}

std::string Section::text(std::string_view key) { return text_of(require(key, "a text"), key); }

std::vector<std::string> Section::texts(std::string_view key) {
  const toml::node& node = require(key, "an array of texts");
  if (!node.is_array()) {
    fail(node, fmt::format("expected an array of texts for {}, got {}", key_path(key), type_name(node)));
  }
  std::vector<std::string> values;
  for (const toml::node& element : *node.as_array()) values.push_back(text_of(element, key));
  return values;
}

std::optional<Section> Section::optional_table(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  return as_table(*node, key);
}

Section Section::as_table(const toml::node& node, std::string_view key) const {
  if (!node.is_table()) fail(node, fmt::format("expected a table for {}, got {}", key_path(key), type_name(node)));
  return {file_, key_path(key), *node.as_table()};
}

std::vector<Section> Section::tables(std::string_view key) {
  std::vector<Section> tables;
  const toml::node* node = find(key);
  if (node == nullptr) return tables;
  if (!node->is_array()) {
    fail(*node, fmt::format("expected an array of tables for {}, got {}", key_path(key), type_name(*node)));
  }
  for (const toml::node& element : *node->as_array()) tables.push_back(as_table(element, key));
  return tables;
}

void Section::refuse_others() const {
  for (const auto& [key, node] : table_) {
    if (asked_.contains(key.str())) continue;
    const std::vector<std::string> known(asked_.begin(), asked_.end());
    std::vector<std::string> missing;
    std::ranges::copy_if(known, std::back_inserter(missing), [&](const auto& name) { return !table_.contains(name); });
    throw InputFileError(file_, static_cast<int>(key.source().begin.line),
                         fmt::format("expected one of {}; got \"{}\"{}", fmt::join(known, ", "), key_path(key.str()),
                                     did_you_mean(key.str(), missing)));
  }
}

toml::table parse_toml(const TextFile& file) {
  if (file.text.size() > kStoredLimits.toml_bytes) {
    throw InputFileError(file.name, 0,
                         fmt::format("expected at most {} MiB of TOML, got more", kStoredLimits.toml_bytes >> 20));
  }
  if (const auto line = line_of_endless_key(file.text)) {
    throw InputFileError(file.name, *line,
                         fmt::format("expected keys of at most {} parts, got more", kStoredLimits.levels));
  }
  if (const auto line = line_of_deep_nesting(file.text)) {
    throw InputFileError(file.name, *line,
                         fmt::format("expected at most {} levels of nesting, got more", kStoredLimits.levels));
  }
  try {
    return toml::parse(file.text, file.name);
  } catch (const toml::parse_error& error) {
    throw InputFileError(file.name, static_cast<int>(error.source().begin.line),
                         fmt::format("expected TOML, got something else: {}", error.description()));
  }
}

}  // namespace paracal::io
