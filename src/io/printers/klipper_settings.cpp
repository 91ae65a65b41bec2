#include "klipper_settings.hpp"

#include <dirent.h>
#include <fmt/format.h>
#include <glob.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>

#include "io/files/letters.hpp"
#include "io/files/stored.hpp"
#include "io/tables/columns.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

/// Of all that is included together, so that a pattern that matches half the disk is refused before memory is full.
constexpr std::size_t kMostFiles = 1000, kMostBytes = std::size_t{64} << 20;
constexpr std::string_view kSavedMark = "#*#", kInclude = "include ", kReadings = "delta_calibrate";

/// Without a comment: # or ; at the beginning or after a blank.
std::string_view without_comment(std::string_view line) {
  for (std::size_t k = 0; k < line.size(); ++k) {
    const bool marks = line[k] == '#' || line[k] == ';';
    if (marks && (k == 0 || line[k - 1] == ' ' || line[k - 1] == '\t')) return line.substr(0, k);
  }
  return line;
}

/// Names in folders that a pattern may still have looked at: glob() has no limit of its own.
thread_local int entries_left = 0;

void* open_folder(const char* name) { return opendir(name); }
void close_folder(void* folder) { closedir(static_cast<DIR*>(folder)); }
dirent* next_entry(void* folder) { return --entries_left < 0 ? nullptr : readdir(static_cast<DIR*>(folder)); }

/// Sorted; none where nothing matches, and empty where it takes too many folders to tell.
std::optional<std::vector<std::string>> matches(const std::string& pattern) {
  constexpr int kMostEntries = 100'000;
  entries_left = kMostEntries;
  glob_t found{};
  found.gl_opendir = open_folder;
  found.gl_readdir = next_entry;
  found.gl_closedir = close_folder;
  found.gl_stat = [](const char* name, struct stat* status) { return stat(name, status); };
  found.gl_lstat = [](const char* name, struct stat* status) { return lstat(name, status); };
  std::vector<std::string> names;
  if (glob(pattern.c_str(), GLOB_ALTDIRFUNC, nullptr, &found) == 0) {
    names.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  globfree(&found);
  return entries_left < 0 ? std::nullopt : std::optional(std::move(names));
}

constexpr std::string_view kSavedHead = "#*# <---------------------- SAVE_CONFIG ---------------------->";
constexpr std::array<std::string_view, 3> kBlockBegins{
    kSavedHead, "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.", kSavedMark};

/// Why the firmware passes over all lines that begin with #*#, and in which line; empty where it reads them, or there
/// are none. Its rule: they stand together at the end, below three lines that begin them, and only these three lines
/// begin a block.
std::optional<std::pair<std::size_t, std::string>> line_that_spoils(const std::vector<std::string_view>& lines) {
  const auto begins = [&](std::size_t k) {
    return k > 0 && k + kBlockBegins.size() <= lines.size() &&
           std::ranges::equal(kBlockBegins, std::span(lines).subspan(k, kBlockBegins.size()));
  };
  std::size_t end = lines.size(), head = 0;
  while (end > 0 && trimmed(lines[end - 1]).empty()) --end;
  while (head < end && !begins(head)) {
    if (lines[head].starts_with("#*# "))
      return {{head, "which is above the three lines that begin the SAVE_CONFIG block"}};
    ++head;
  }
  for (std::size_t k = head + 1; k < end; ++k) {
    if (begins(k)) return {{k, "which begins a second block"}};
    const bool saved = lines[k] == kSavedMark || lines[k].starts_with("#*# ");
    if (!saved) return {{k, "which does not begin with #*# and stands below the block"}};
  }
  return std::nullopt;
}

}  // namespace

KlipperSettings::KlipperSettings(const TextFile& file) {
  const std::vector<std::string_view> lines = lines_of(file.text);
  if (const auto why = line_that_spoils(lines)) {
    const auto& [line, words] = *why;
    const std::string_view text = lines[line].substr(0, 60);
    const std::string shown = trimmed(text).empty() ? "an empty line" : fmt::format("\"{}\"", text);
    unread_ = Unread{static_cast<int>(line) + 1, fmt::format("{}, {}", shown, words)};
  }
  add(file, {});
}

void KlipperSettings::add(TextFile given, const std::vector<std::string>& within) {
  const TextFile& file = files_.emplace_back(std::move(given));
  std::vector<std::string> inside(within);
  inside.push_back(file.name);
  int number = 0;
  std::string section;
  for (std::string_view line : lines_of(file.text)) {
    ++number;
    const bool saved = within.empty() && line.starts_with(kSavedMark);  // the firmware passes over them in others
    if (saved) line.remove_prefix(kSavedMark.size());
    const std::string_view text = trimmed(saved ? line : without_comment(line));
    if (text.starts_with('[') && text.ends_with(']')) {
      const std::string_view name = trimmed(text.substr(1, text.size() - 2));
      if (name.starts_with(kInclude)) include({trimmed(name.substr(kInclude.size())), &file, number}, inside);
      section = name;
      continue;
    }
    const std::size_t end = text.find_first_of(":=");
    if (end == std::string_view::npos || section.empty()) continue;
    (saved ? saved_ : typed_)[{section, lower_case(trimmed(text.substr(0, end)))}] = {trimmed(text.substr(end + 1)),
                                                                                      &file, number, saved};
  }
}

void KlipperSettings::include(const Value& pattern, const std::vector<std::string>& within) {
  const std::filesystem::path folder = std::filesystem::path(pattern.file->name).parent_path();
  const std::string whole = (folder / pattern.text).string();
  const std::optional<std::vector<std::string>> names = matches(whole);
  if (!names) fail(pattern, fmt::format("expected a pattern that matches fewer folders, got {}", pattern.text));
  if (names->empty() && pattern.text.find_first_of("*?[") == std::string_view::npos) missing_.push_back(pattern);
  for (const std::string& name : *names) {
    if (std::ranges::find(within, name) != within.end()) {
      fail(pattern, fmt::format("expected no file that includes itself, got {}", name));
    }
    if (!std::filesystem::is_regular_file(name)) fail(pattern, fmt::format("expected a regular file, got {}", name));
    if (files_.size() > kMostFiles) fail(pattern, fmt::format("expected at most {} files, got more", kMostFiles));
    included_bytes_ += std::filesystem::file_size(name);
    if (included_bytes_ > kMostBytes) {
      fail(pattern, fmt::format("expected at most {} MiB in all included files, got more", kMostBytes >> 20));
    }
    add(read_included(name), within);
  }
}

void KlipperSettings::fail(const Value& value, const std::string& complaint) {
  throw InputFileError(value.file->name, value.line, complaint);
}

std::optional<KlipperSettings::Value> KlipperSettings::find(std::string_view section, std::string_view key) const {
  const std::pair name{std::string(section), std::string(key)};
  if (const auto found = typed_.find(name); found != typed_.end()) return found->second;
  const auto found = saved_.find(name);
  // What was measured is true, whether the firmware reads it or not.
  const bool counts = found != saved_.end() && (!unread_ || section == kReadings);
  return counts ? std::optional(found->second) : std::nullopt;
}

std::optional<KlipperSettings::Value> KlipperSettings::overridden(std::string_view section,
                                                                  std::string_view key) const {
  const std::pair name{std::string(section), std::string(key)};
  const auto typed = typed_.find(name), saved = saved_.find(name);
  if (typed == typed_.end() || saved == saved_.end() || unread_) return std::nullopt;
  const auto one = finite_number(typed->second.text), other = finite_number(saved->second.text);
  const bool same = one && other ? *one == *other : typed->second.text == saved->second.text;
  return same ? std::nullopt : std::optional(saved->second);
}

KlipperSettings::Value KlipperSettings::require(std::string_view section, std::string_view key) const {
  if (const auto value = find(section, key)) return *value;
  std::string complaint = fmt::format("expected {} in [{}], got none", key, section);
  if (unread_ && saved_.contains({std::string(section), std::string(key)})) {
    fail({{}, &files_.front(), unread_->line},
         fmt::format("{} that the firmware reads: it ignores the whole SAVE_CONFIG block because of this line: {}",
                     complaint, unread_->why));
  }
  for (const Value& one : missing_) {
    complaint +=
        fmt::format("; it may be in {}, which {}:{} includes but is missing", one.text, one.file->name, one.line);
  }
  fail({{}, &files_.front(), 0}, complaint);
}

double KlipperSettings::number_of(const Value& value, std::string_view what) {
  const std::optional<double> number = finite_number(value.text);
  if (!number) fail(value, fmt::format("expected a number for {}, got \"{}\"", what, value.text));
  return *number;
}

double KlipperSettings::positive(std::string_view section, std::string_view key) const {
  const Value value = require(section, key);
  const double number = number_of(value, key);
  if (!(number > 0.0)) fail(value, fmt::format("expected {} above 0, got {}", key, number));
  return number;
}

}  // namespace paracal::io
