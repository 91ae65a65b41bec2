#pragma once

// Private to io: the settings of a Klipper configuration.

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/io/file.hpp"

namespace paracal::io {

/// A text without blanks around it, cut at a separator.
std::vector<std::string_view> cut(std::string_view text, char separator);

/// Settings by section and key, with the places where they stand; later ones replace earlier ones, so those of the
/// SAVE_CONFIG block win. Sections `[include NAME]` stand for the files of that name or pattern (*, ?), from the folder
/// of the file that names them.
class KlipperSettings {
 public:
  /// @throws InputFileError for an included file that is not there, or that includes itself.
  explicit KlipperSettings(const TextFile& file);
  KlipperSettings(const KlipperSettings&) = delete;
  KlipperSettings& operator=(const KlipperSettings&) = delete;

  struct Value {
    std::string_view text;
    const TextFile* file = nullptr;
    int line = 0;
  };

  [[noreturn]] static void fail(const Value& value, const std::string& complaint);

  std::optional<Value> find(std::string_view section, std::string_view key) const;
  Value require(std::string_view section, std::string_view key) const;

  static double number_of(const Value& value, std::string_view what);
  std::optional<double> optional_number(std::string_view section, std::string_view key) const;
  double positive(std::string_view section, std::string_view key) const;

  /// The file and what it includes, in the order of reading.
  const std::deque<TextFile>& files() const { return files_; }

 private:
  void add(const TextFile& given, const std::vector<std::string>& within);
  void include(const Value& pattern, const std::vector<std::string>& within);

  std::deque<TextFile> files_;  // which the values point into
  std::map<std::pair<std::string, std::string>, Value> values_;
};

}  // namespace paracal::io
