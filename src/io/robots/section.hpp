#pragma once

// Private to io: TOML tables that complain with file and line.

#include <toml++/toml.h>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/file.hpp"
#include "paracal/mechanism/plausible.hpp"

namespace paracal::io {

/// A TOML table that knows its file and its place in it, asks for keys with their type, and refuses keys nobody asked
/// for.
class Section {
 public:
  Section(std::string file, std::string path, const toml::table& table)
      : file_(std::move(file)), path_(std::move(path)), table_(table) {}

  [[noreturn]] void fail(const toml::node& where, const std::string& complaint) const;
  [[noreturn]] void fail(const std::string& complaint) const { fail(table_, complaint); }

  std::string key_path(std::string_view key) const;

  const toml::node* find(std::string_view key);
  const toml::node& require(std::string_view key, std::string_view expected);

  /// @throws InputFileError for what is no number of the range; so do the others.
  double number_of(const toml::node& node, std::string_view key, const plausible::Range& range) const;
  double number(std::string_view key, const plausible::Range& range) {
    return number_of(require(key, "a number"), key, range);
  }
  double number_or(std::string_view key, double otherwise, const plausible::Range& range);

  std::vector<double> numbers_of(const toml::node& node, std::string_view key, const plausible::Range& range) const;
  std::vector<double> numbers(std::string_view key, const plausible::Range& range,
                              std::optional<std::size_t> count = std::nullopt);

  /// False where it is not stated.
  bool flag(std::string_view key);
  std::string text(std::string_view key);
  std::vector<std::string> texts(std::string_view key);

  std::string text_of(const toml::node& node, std::string_view key) const;

  Section table(std::string_view key) { return as_table(require(key, "a table"), key); }
  std::optional<Section> optional_table(std::string_view key);
  Section as_table(const toml::node& node, std::string_view key) const;

  /// The tables of an array of tables, [[key]]; none when there is no such key.
  std::vector<Section> tables(std::string_view key);

  /// Call once every key has been asked for.
  void refuse_others() const;

 private:
  std::string file_;
  std::string path_;
  const toml::table& table_;
  std::set<std::string, std::less<>> asked_;
};

/// "a table", "a number", ...: for messages.
std::string_view type_name(const toml::node& node);

/// @throws InputFileError for what is no TOML.
toml::table parse_toml(const TextFile& file);

}  // namespace paracal::io
