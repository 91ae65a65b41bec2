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

/// Settings by section and key, with the places where they stand. What is typed is in force, the last of a key, in the
/// file itself or in one that it includes; the SAVE_CONFIG block states what nobody has typed (Klipper comments out the
/// lines of its block that others contradict). Sections `[include NAME]` stand for the files of that name or pattern
/// (*,
/// ?), from the folder of the file that names them.
class KlipperSettings {
 public:
  /// @throws InputFileError for an included file that includes itself.
  explicit KlipperSettings(const TextFile& file);
  KlipperSettings(const KlipperSettings&) = delete;
  KlipperSettings& operator=(const KlipperSettings&) = delete;

  struct Value {
    std::string_view text;
    const TextFile* file = nullptr;
    int line = 0;
    bool saved = false;  ///< in the SAVE_CONFIG block
  };

  [[noreturn]] static void fail(const Value& value, const std::string& complaint);

  std::optional<Value> find(std::string_view section, std::string_view key) const;
  Value require(std::string_view section, std::string_view key) const;

  static double number_of(const Value& value, std::string_view what);
  double positive(std::string_view section, std::string_view key) const;

  /// What the SAVE_CONFIG block says of a key that is typed otherwise, and so is not in force.
  std::optional<Value> overridden(std::string_view section, std::string_view key) const;
  /// The line for which the firmware passes over the whole SAVE_CONFIG block, as it does where anything else stands
  /// among its lines or below it, or where it does not begin as it should. Of such a block readings count, which are
  /// true all the same, and nothing else.
  struct Unread {
    int line = 0;
    std::string why;
  };
  const std::optional<Unread>& unread_block() const { return unread_; }
  /// Files that should be included and are not there.
  const std::vector<Value>& missing() const { return missing_; }

  /// The file and what it includes, in the order of reading.
  const std::deque<TextFile>& files() const { return files_; }

 private:
  void add(TextFile given, const std::vector<std::string>& within);
  void include(const Value& pattern, const std::vector<std::string>& within);

  std::deque<TextFile> files_;  // which the values point into
  using Values = std::map<std::pair<std::string, std::string>, Value>;
  Values typed_, saved_;
  std::vector<Value> missing_;
  std::size_t included_bytes_ = 0;
  std::optional<Unread> unread_;
};

}  // namespace paracal::io
