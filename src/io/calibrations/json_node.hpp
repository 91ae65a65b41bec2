#pragma once

// Private to io: values of a JSON file that know where they stand.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/json.hpp"
#include "paracal/mechanism/plausible.hpp"

namespace paracal::io {

/// A value of a JSON file. Whatever is not as it was expected is refused with the value's line.
class JsonNode {
 public:
  /// The file as a whole.
  /// @param what  that it should be: "a calibration".
  JsonNode(const TextFile& file, const Json& value, std::string what);

  const Json& json() const { return *value_; }
  /// Its line in the file, from 1.
  int line() const;

  /// @throws InputFileError for what has no such key.
  JsonNode at(const char* key) const;
  JsonNode object_at(const char* key) const;
  /// Empty where there is no such key, or null under it.
  std::optional<JsonNode> find(const char* key) const;
  /// Of an array.
  std::vector<JsonNode> entries() const;
  /// @param path  keys, and places in arrays, that lead to it.
  JsonNode descendant(std::span<const std::string> path) const;
  /// Of an array of finite numbers.
  std::vector<double> numbers() const;

  /// @throws InputFileError for what is no number of the range.
  double number(const plausible::Range& range = plausible::kFinite) const;
  std::uint64_t whole_number(std::uint64_t least, std::uint64_t most) const;
  std::string text() const;
  bool flag() const;

  /// @throws InputFileError always.
  [[noreturn]] void refuse(const std::string& complaint) const;
  /// "accepted: expected true or false, got 1".
  [[noreturn]] void refuse_as(std::string_view expected) const;

 private:
  JsonNode child(std::string key, const Json& value, std::string what) const;
  JsonNode entry(std::size_t k) const;

  const TextFile* file_;
  const Json* value_;
  std::string what_;
  std::vector<std::string> path_ = {};  ///< keys, and places in arrays, that lead to it
};

}  // namespace paracal::io
