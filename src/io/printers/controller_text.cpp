#include "controller_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "io/tables/columns.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

/// Files of firmwares that keep a delta in other words, by a word that only they have.
struct OtherFirmware {
  std::string_view word, name;
};
constexpr std::array<OtherFirmware, 6> kOthers{{{"arm_solution", "Smoothieware"},
                                                {"EPR:", "Repetier"},
                                                {"DIAGONAL_ROD_LENGTH", "Repetier"},
                                                {"MK4duo", "MK4duo"},
                                                {"[KINS]", "LinuxCNC"},
                                                {"kinematics:\n", "FluidNC"}}};

void refuse_others(const TextFile& file) {
  for (const OtherFirmware& one : kOthers) {
    if (file.text.find(one.word) == std::string::npos) continue;
    throw InputFileError(
        file.name, 0,
        fmt::format("expected the M-codes of Marlin or RepRapFirmware, got a file of {}: write its radius, rods and "
                    "height as M665 R L H, and its endstops as M666 X Y Z",
                    one.name));
  }
}

/// What follows a word, as far as numbers and colons go; empty where the word is missing.
std::string_view after(std::string_view line, std::string_view word) {
  const std::size_t at = line.find(word);
  if (at == std::string_view::npos) return {};
  line = trimmed(line.substr(at + word.size()));
  return line.substr(0, std::min(line.find_first_not_of("0123456789.:+-"), line.size()));
}

struct Letter {
  std::string_view word;
  char letter;
};

/// The code whose words a line states; empty where it lacks one of them.
std::string code_of(std::string_view line, std::string_view code, const auto& letters) {
  std::string text(code);
  for (const Letter& one : letters) {
    const std::string_view value = after(line, one.word);
    if (value.empty()) return {};
    text += fmt::format(" {}{}", one.letter, value);
  }
  return text;
}

/// RepRapFirmware's answers to M665 and M666; empty for other lines.
std::string answer(std::string_view line) {
  constexpr std::array<Letter, 7> kDelta{{{"Diagonals", 'L'},
                                          {"delta radius", 'R'},
                                          {"homed height", 'H'},
                                          {"bed radius", 'B'},
                                          {", X", 'X'},
                                          {", Y", 'Y'},
                                          {", Z", 'Z'}}};
  constexpr std::array<Letter, 3> kEndstops{{{"adjustments X", 'X'}, {" Y", 'Y'}, {" Z", 'Z'}}};
  constexpr std::array<Letter, 2> kTilt{{{"tilt X", 'A'}, {"% Y", 'B'}}};
  if (line.find("delta radius") != std::string_view::npos) return code_of(line, "M665", kDelta);
  if (line.find("Endstop adjustments") == std::string_view::npos) return {};
  const std::string endstops = code_of(line, "M666", kEndstops), tilt = code_of(line, "", kTilt);
  return endstops + tilt;
}

using Globals = std::map<std::string, std::string, std::less<>>;

/// "global NAME = VALUE" and "set global.NAME = VALUE".
void remember(std::string_view line, Globals& globals) {
  line = trimmed(line.substr(0, line.find(';')));
  for (const std::string_view begin : {"global ", "set global."}) {
    const std::size_t equals = line.find('=');
    if (!line.starts_with(begin) || equals == std::string_view::npos) continue;
    const std::string_view name = trimmed(line.substr(begin.size(), equals - begin.size()));
    globals[std::string(name)] = trimmed(line.substr(equals + 1));
  }
}

/// A name without a value stays, and is complained about where a number is expected.
std::string with_globals(std::string_view line, const Globals& globals) {
  constexpr std::string_view kBegin = "{global.";
  std::string text;
  while (true) {
    const std::size_t begin = line.find(kBegin), end = line.find('}', begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) return text.append(line);
    const auto found = globals.find(line.substr(begin + kBegin.size(), end - begin - kBegin.size()));
    const std::string_view name = line.substr(begin, end + 1 - begin);
    text.append(line.substr(0, begin)).append(found == globals.end() ? name : std::string_view(found->second));
    line.remove_prefix(end + 1);
  }
}

/// Without the word B of M665.
std::string without_calibration_radius(std::string_view line) {
  const std::size_t code = line.find("M665"), begin = line.find(" B", code);
  if (code == std::string_view::npos || begin == std::string_view::npos) return std::string(line);
  const std::size_t end = std::min(line.find(' ', begin + 1), line.size());
  return std::string(line.substr(0, begin)).append(line.substr(end));
}

}  // namespace

TextFile as_machine_codes(const TextFile& file) {
  refuse_others(file);
  const bool has_calibration_radius = file.text.find("B<calibration radius>") != std::string::npos;
  TextFile codes = file;
  codes.text.clear();
  Globals globals;
  for (const std::string_view line : lines_of(file.text)) {
    remember(line, globals);
    std::string text = with_globals(line, globals);
    if (has_calibration_radius) text = without_calibration_radius(text);
    const std::string code = answer(text);
    codes.text.append(code.empty() ? text : code).append("\n");
  }
  return codes;
}

void SumOfNames::define(std::string_view name, std::string_view value) {
  values_.insert_or_assign(std::string(name), std::string(value));
}

std::optional<double> SumOfNames::value_of(std::string_view text, int depth) const {
  constexpr int kDeepest = 20;  // names that stand for each other
  text = trimmed(text);
  if (const auto number = finite_number(text)) return number;
  if (depth > kDeepest) return std::nullopt;
  if (text.starts_with('(') && text.ends_with(')') && text.find('(', 1) == std::string_view::npos) {
    return value_of(text.substr(1, text.size() - 2), depth + 1);
  }
  if (const auto found = values_.find(text); found != values_.end()) return value_of(found->second, depth + 1);
  const std::size_t last = text.find_last_of("+-");
  if (last == std::string_view::npos || last == 0) return std::nullopt;
  const auto left = value_of(text.substr(0, last), depth + 1), right = value_of(text.substr(last + 1), depth + 1);
  if (!left || !right) return std::nullopt;
  return *left + (text[last] == '-' ? -*right : *right);
}

}  // namespace paracal::io
