#include "code_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "io/files/letters.hpp"
#include "io/tables/columns.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/plausible.hpp"

namespace paracal::io {
namespace {

bool is_alphanumeric(char one) { return std::isalnum(static_cast<unsigned char>(one)) != 0; }

/// What stands behind a code in a line, before comment and checksum; empty where the code does not.
std::optional<std::string_view> behind(std::string_view line, std::string_view code) {
  line = line.substr(0, line.find_first_of(";*\r"));
  const auto same = [](char one, char other) { return upper_case(one) == other; };
  for (auto from = line.begin();;) {
    const auto found = std::search(from, line.end(), code.begin(), code.end(), same);
    if (found == line.end()) return std::nullopt;
    const auto first = static_cast<std::size_t>(found - line.begin()), end = first + code.size();
    const bool begins = first == 0 || !is_alphanumeric(line[first - 1]);
    const bool ends = end == line.size() || std::isdigit(static_cast<unsigned char>(line[end])) == 0;
    if (begins && ends) return line.substr(end);
    from = found + 1;
  }
}

/// Between blanks; where there are none after the code, from letter to letter.
std::vector<std::string_view> words_of(std::string_view text) {
  const bool glued = !text.empty() && text.front() != ' ' && text.front() != '\t';
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return words;
    text.remove_prefix(begin);
    std::size_t end = 1;
    const auto goes_on = [&](char one) {
      return one != ' ' && one != '\t' && !(glued && std::isalpha(static_cast<unsigned char>(one)) != 0);
    };
    while (end < text.size() && goes_on(text[end])) ++end;
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

}  // namespace

CodeWords::CodeWords(const TextFile& file, std::string_view name, std::string_view letters)
    : file_(file.name), name_(name) {
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    const auto rest = behind(line, name);
    if (!rest) continue;
    line_ = number;
    for (const std::string_view word : words_of(*rest)) {
      const char letter = upper_case(word.front());
      if (letters.find(letter) == std::string_view::npos) {
        fail(fmt::format("expected {} with words of {}, got \"{}\": check --firmware", name, letters, word));
      }
      words_[letter] = {std::string(word.substr(1)), number};
    }
  }
}

void CodeWords::fail(const std::string& complaint) const { throw InputFileError(file_, line_, complaint); }

void CodeWords::fail(char letter, const std::string& complaint) const {
  throw InputFileError(file_, words_.at(letter).line, complaint);
}

std::vector<double> CodeWords::numbers(char letter, std::string_view what) const {
  const auto found = words_.find(letter);
  if (found == words_.end()) fail(fmt::format("expected {} with {} ({}), got none", name_, letter, what));
  std::vector<double> values;
  std::string_view rest = found->second.text;
  while (true) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::optional<double> value = finite_number(rest.substr(0, end));
    if (!value) fail(letter, fmt::format("expected a number after {}, got \"{}\"", letter, rest.substr(0, end)));
    if (const auto complaint = plausible::complaint({&letter, 1}, *value, plausible::kPrinter))
      fail(letter, *complaint);
    values.push_back(*value);
    if (end == rest.size()) return values;
    rest.remove_prefix(end + 1);
  }
}

double CodeWords::number(char letter, std::string_view what) const {
  const std::vector<double> values = numbers(letter, what);
  if (values.size() != 1) fail(letter, fmt::format("expected one number after {}, got {}", letter, values.size()));
  return values[0];
}

double CodeWords::number_or(char letter, double otherwise) const {
  return words_.contains(letter) ? number(letter, {}) : otherwise;
}

std::array<double, 3> CodeWords::one_or_three(char letter, std::string_view what) const {
  const std::vector<double> values = numbers(letter, what);
  if (values.size() == 1) return {values[0], values[0], values[0]};
  if (values.size() == 3) return {values[0], values[1], values[2]};
  fail(letter, fmt::format("expected one number or three after {}, got {}", letter, values.size()));
}

}  // namespace paracal::io
