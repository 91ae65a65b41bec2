#include "marlin_configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "controller_text.hpp"
#include "io/tables/columns.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

struct Key {
  std::string_view name, code, letters;
};

constexpr std::string_view kRod = "DELTA_DIAGONAL_ROD", kRadii = "DELTA_RADIUS_TRIM_TOWER";
constexpr std::array<Key, 6> kKeys{{{kRod, "M665", "L"},
                                    {"DELTA_RADIUS", "M665", "R"},
                                    {"DELTA_HEIGHT", "M665", "H"},
                                    {"DELTA_TOWER_ANGLE_TRIM", "M665", "XYZ"},
                                    {"DELTA_DIAGONAL_ROD_TRIM_TOWER", "M665", "ABC"},
                                    {"DELTA_ENDSTOP_ADJ", "M666", "XYZ"}}};
constexpr std::array<std::string_view, 2> kPrintRadii{"DELTA_PRINTABLE_RADIUS", "PRINTABLE_RADIUS"};

constexpr std::string_view kBlanks = " \t\r", kDelta = "DELTA";

/// A line without its comments; `inside` tells whether one goes on from line to line.
std::string without_comments(std::string_view line, bool& inside) {
  std::string left;
  while (!line.empty()) {
    const std::size_t end = inside ? line.find("*/") : std::min(line.find("/*"), line.find("//"));
    if (!inside) left.append(line.substr(0, end));
    if (end == std::string_view::npos || (!inside && line.substr(end, 2) == "//")) break;
    inside = !inside;
    line.remove_prefix(end + 2);
  }
  return left;
}

/// "NAME" and "value" of "#define NAME value"; empty names for other lines.
std::pair<std::string_view, std::string_view> definition(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('#')) return {};
  line = trimmed(line.substr(1));
  constexpr std::string_view kDefine = "define";
  if (!line.starts_with(kDefine)) return {};
  line = trimmed(line.substr(kDefine.size()));
  const std::size_t end = std::min(line.find_first_of(kBlanks), line.size());
  return {line.substr(0, end), trimmed(line.substr(end))};
}

std::string_view without_comment_behind(std::string_view value) { return value.substr(0, value.find("//")); }

/// Between commas, without braces.
std::vector<std::string_view> parts_of(std::string_view value) {
  if (value.starts_with('{') && value.ends_with('}')) value = value.substr(1, value.size() - 2);
  return cut(value, ',');
}

/// One file, whose definitions come one after the other.
class Reader {
 public:
  /// @param names  what the whole file defines.
  Reader(const TextFile& file, const SumOfNames& names) : names_(names), found_{.codes = {file.name, {}}} {}

  void read(std::string_view name, std::string_view value) {
    ++line_;
    if (const auto* key = std::ranges::find(kKeys, name, &Key::name); key != kKeys.end()) {
      check_again(name, value);
      add(*key, parts_of(value));
    } else if (name == kRadii) {
      refuse_radii(parts_of(value));
    } else if (std::ranges::find(kPrintRadii, name) != kPrintRadii.end()) {
      found_.print_radius = finite_number(value).value_or(0.0);
    }
    found_.codes.text.push_back('\n');
  }

  /// A line of which a comment may have made nothing.
  void notice_switch(std::string_view line) {
    const bool is_comment = trimmed(line).starts_with("//");
    const auto [name, value] = definition(is_comment ? trimmed(line).substr(2) : line);
    if (name != kDelta || !trimmed(without_comment_behind(value)).empty()) return;
    (is_comment ? off_ : on_) = line_;
  }
  /// The line that would define DELTA and is a comment, where no other does; else 0.
  int switched_off() const { return on_ > 0 ? 0 : off_; }

  bool is_delta() const { return defined_.contains(kRod); }
  MarlinConfiguration&& found() && { return std::move(found_); }

 private:
  [[noreturn]] void fail(const std::string& complaint) const {
    throw InputFileError(found_.codes.name, line_, complaint);
  }

  void check_again(std::string_view name, std::string_view value) {
    const auto [before, is_new] = defined_.try_emplace(std::string(name), value, line_);
    if (is_new || before->second.first == value) return;
    fail(fmt::format("expected {} as in line {} ({}), got {}: keep only the line that was compiled", name,
                     before->second.second, before->second.first, value));
  }

  void add(const Key& key, const std::vector<std::string_view>& parts) {
    if (parts.size() != key.letters.size()) {
      fail(fmt::format("expected {} numbers for {}, got {}", key.letters.size(), key.name, parts.size()));
    }
    found_.codes.text.append(key.code);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto sum = names_.value_of(parts[k]);
      found_.codes.text.append(" ").append(1, key.letters[k]);
      found_.codes.text.append(sum ? fmt::format("{}", *sum) : std::string(parts[k]));
    }
  }

  void refuse_radii(const std::vector<std::string_view>& parts) const {
    const auto is_zero = [](std::string_view part) { return finite_number(part) == 0.0; };
    if (std::ranges::all_of(parts, is_zero)) return;
    fail(
        fmt::format("expected one radius for all towers, got {}: set it to 0 and calibrate the printer again", kRadii));
  }

  const SumOfNames& names_;
  MarlinConfiguration found_;
  std::map<std::string, std::pair<std::string, int>, std::less<>> defined_;
  int line_ = 0, on_ = 0, off_ = 0;
};

}  // namespace

std::optional<MarlinConfiguration> marlin_configuration(const TextFile& file) {
  SumOfNames names;
  bool inside_comment = false;
  for (const std::string_view line : lines_of(file.text)) {
    const std::string left = without_comments(line, inside_comment);
    const auto [name, value] = definition(left);
    names.define(name, value);
  }
  Reader reader(file, names);
  inside_comment = false;
  for (const std::string_view line : lines_of(file.text)) {
    const std::string left = without_comments(line, inside_comment);
    const auto [name, value] = definition(left);
    reader.read(name, value);
    reader.notice_switch(line);
  }
  if (!reader.is_delta()) return std::nullopt;
  if (const int line = reader.switched_off(); line > 0) {
    throw InputFileError(file.name, line,
                         "expected #define DELTA, got it in a comment: this firmware is not for a delta");
  }
  return std::move(reader).found();
}

}  // namespace paracal::io
