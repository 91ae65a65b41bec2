#include "json_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "io/files/stored.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

/// Reads a text until it comes to a place, the first under its name.
class PlaceFinder final : public nlohmann::json_sax<Json> {
 public:
  PlaceFinder(const std::string& text, const std::vector<std::string>& path) : text_(text), path_(path) {
    Json::sax_parse(text_, this);
  }
  /// Of the first character of the value, or near it in its line.
  std::size_t byte() const { return byte_; }

  bool null() override { return value(); }
  bool boolean(bool /*value*/) override { return value(); }
  bool number_integer(number_integer_t /*value*/) override { return value(); }
  bool number_unsigned(number_unsigned_t /*value*/) override { return value(); }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return value(); }
  bool string(string_t& /*value*/) override { return value(); }
  bool binary(binary_t& /*value*/) override { return value(); }
  bool start_object(std::size_t /*count*/) override { return open(false); }
  bool start_array(std::size_t /*count*/) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& key) override {
    levels_.back().place = key;
    return true;
  }
  bool parse_error(std::size_t /*byte*/, const std::string& /*token*/, const Json::exception& /*error*/) override {
    return false;
  }

 private:
  struct Level {
    bool is_array = false;
    std::size_t next = 0;
    std::string place = {};
  };

  bool value() {
    if (!levels_.empty() && levels_.back().is_array) levels_.back().place = std::to_string(levels_.back().next++);
    const bool is_it = std::ranges::equal(levels_, path_, {}, &Level::place);
    // The character before last belongs to the value or stands before it: behind a number one more was read.
    if (is_it) byte_ = static_cast<std::size_t>(text_.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in)) - 1;
    return !is_it;
  }
  bool open(bool is_array) {
    const bool goes_on = value();
    levels_.push_back({.is_array = is_array});
    return goes_on;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }

  std::istringstream text_;
  const std::vector<std::string>& path_;
  std::vector<Level> levels_;
  std::size_t byte_ = 0;
};

bool is_finite(const Json& value) { return value.is_number() && std::isfinite(value.get<double>()); }

}  // namespace

JsonNode::JsonNode(const TextFile& file, const Json& value, std::string what)
    : file_(&file), value_(&value), what_(std::move(what)) {}

JsonNode JsonNode::child(std::string key, const Json& value, std::string what) const {
  JsonNode child(*file_, value, std::move(what));
  child.path_ = path_;
  child.path_.push_back(std::move(key));
  return child;
}

JsonNode JsonNode::entry(std::size_t k) const {
  return child(std::to_string(k), value_->at(k), fmt::format("entry {} of {}", k + 1, what_));
}

int JsonNode::line() const { return line_at(file_->text, PlaceFinder(file_->text, path_).byte()); }

JsonNode JsonNode::at(const char* key) const {
  if (!value_->is_object()) refuse_as(fmt::format("an object with \"{}\"", key));
  if (!value_->contains(key)) refuse(fmt::format("expected {} with \"{}\", got none", what_, key));
  return child(key, value_->at(key), key);
}

JsonNode JsonNode::object_at(const char* key) const {
  JsonNode object = at(key);
  if (!object.json().is_object()) object.refuse_as("an object");
  return object;
}

std::optional<JsonNode> JsonNode::find(const char* key) const {
  if (!value_->is_object() || !value_->contains(key) || value_->at(key).is_null()) return std::nullopt;
  return at(key);
}

std::vector<JsonNode> JsonNode::entries() const {
  if (!value_->is_array()) refuse_as("an array");
  std::vector<JsonNode> all;
  for (std::size_t k = 0; k < value_->size(); ++k) all.push_back(entry(k));
  return all;
}

JsonNode JsonNode::descendant(std::span<const std::string> path) const {
  JsonNode node = *this;
  for (const std::string& part : path) {
    node = node.json().is_array() ? node.entry(std::stoul(part)) : node.at(part.c_str());
  }
  return node;
}

/// Thousands of numbers in a covariance: none is a node of its own but one that is refused.
std::vector<double> JsonNode::numbers() const {
  if (!value_->is_array()) refuse_as("an array");
  std::vector<double> all;
  all.reserve(value_->size());
  for (std::size_t k = 0; k < value_->size(); ++k) {
    const Json& one = value_->at(k);
    all.push_back(is_finite(one) ? one.get<double>() : entry(k).number());
  }
  return all;
}

double JsonNode::number(const plausible::Range& range) const {
  if (!is_finite(*value_)) refuse_as("a number");
  const auto value = value_->get<double>();
  if (const auto complaint = plausible::complaint(what_, value, range)) refuse(*complaint);
  return value;
}

std::uint64_t JsonNode::whole_number(std::uint64_t least, std::uint64_t most) const {
  const bool is_whole = value_->is_number_unsigned();
  if (!is_whole || *value_ < least || *value_ > most)
    refuse_as(fmt::format("a whole number from {} to {}", least, most));
  return value_->get<std::uint64_t>();
}

std::string JsonNode::text() const {
  if (!value_->is_string()) refuse_as("a text");
  return value_->get<std::string>();
}

bool JsonNode::flag() const {
  if (!value_->is_boolean()) refuse_as("true or false");
  return value_->get<bool>();
}

void JsonNode::refuse(const std::string& complaint) const { throw InputFileError(file_->name, line(), complaint); }

void JsonNode::refuse_as(std::string_view expected) const {
  constexpr std::size_t kShown = 200;  // of a value that may be a whole table
  std::string got = value_->dump();
  if (got.size() > kShown) got = value_->dump(-1, ' ', true).substr(0, kShown) + " ...";
  refuse(fmt::format("{}: expected {}, got {}", what_, expected, got));
}

}  // namespace paracal::io
