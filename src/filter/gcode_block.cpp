#include "gcode_block.hpp"

#include <charconv>
#include <optional>
#include <utility>

#include "io/files/letters.hpp"

namespace paracal::io {
namespace {

/// Takes a line apart from left to right; every step says whether it found what may stand there.
class BlockParser {
 public:
  BlockParser(std::string_view text, GcodeBlock& block) : text_(text), block_(block) {}

  bool parse() {
    for (skip_blanks(); at_ < text_.size() && !done_; skip_blanks()) {
      if (!item()) return false;
    }
    return true;
  }

 private:
  char next() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void skip_blanks() {
    while (is_blank(next())) ++at_;
  }

  bool stop() {
    done_ = true;
    return true;
  }

  bool item() {
    const bool is_first = block_.words.empty();
    switch (next()) {
      case ';':
        return stop();
      case '%':
        return is_first && stop();
      case '(':
        return skip_past(')');
      case '"':  // M32 "part.g"
        ++at_;
        return !is_first && skip_past('"');
      case '/':
        ++at_;
        block_.is_optional = true;
        return is_first;
      case '#':
        return leave_to_the_controller();
      default:
        return is_letter(next()) && word();
    }
  }

  bool skip_past(char end) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) return false;
    at_ = found + 1;
    return true;
  }

  bool skip_digits() {
    const std::size_t begin = at_;
    while (is_digit(next())) ++at_;
    return at_ > begin;
  }

  /// Nothing of the line is read any more.
  bool leave_to_the_controller() {
    block_.kind = GcodeBlock::Kind::programmed;
    return stop();
  }

  std::optional<double> number() {
    const std::size_t begin = at_;
    if (next() == '+' || next() == '-') ++at_;
    const std::size_t unsigned_begin = at_;
    while (is_digit(next())) ++at_;
    std::size_t digits = at_ - unsigned_begin;
    if (next() == '.') {
      ++at_;
      while (is_digit(next())) ++at_;
      digits = at_ - unsigned_begin - 1;
    }
    if (digits == 0) return std::nullopt;
    const std::size_t from = text_[begin] == '+' ? begin + 1 : begin;
    double value = 0.0;
    const auto result = std::from_chars(text_.data() + from, text_.data() + at_, value);
    return result.ec == std::errc{} ? std::optional(value) : std::nullopt;
  }

  /// The rest of the line is a text: RepRap's M117 and M118, messages, M486, the name of an object; and what M0 and M1
  /// ask the operator for, behind their words with numbers.
  bool takes_text(const GcodeWord& word) {
    constexpr std::array kTexts{117.0, 118.0, 486.0};
    if (word.letter == 'M' && word.is_number()) {
      if (std::ranges::find(kTexts, word.value) != kTexts.end()) return true;
      pauses_ |= word.is_whole(0.0, 1.0);
    }
    return pauses_ && begins_text();
  }

  /// "Change tool", "5 parts"; neither "G1 X5" nor a comment.
  bool begins_text() const {
    const std::string_view rest = without_blanks(text_.substr(at_));
    if (rest.empty() || !(is_letter(rest[0]) || is_digit(rest[0]))) return false;
    const std::string_view behind = without_blanks(rest.substr(1));
    constexpr std::string_view kNumbers = "+-.0123456789#[{\"";
    return is_digit(rest[0]) || behind.empty() || kNumbers.find(behind[0]) == std::string_view::npos;
  }

  static std::string_view without_blanks(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    return begin == std::string_view::npos ? std::string_view() : text.substr(begin);
  }

  /// F1e5: G-code has no exponents. E of an extruder may follow without a blank; it is written as the other letters
  /// are.
  bool skip_exponent(char letter) {
    const bool is_e = upper_case(next()) == 'E' && (next() == 'E') != (letter == upper_case(letter));
    if (!is_e) return false;
    const std::size_t e = at_++;
    if (next() == '+' || next() == '-') ++at_;
    if (skip_digits()) return true;
    at_ = e;
    return false;
  }

  /// O1001 alone names the program; other O words are subprograms, jumps and loops.
  bool program_name() {
    if (!std::ranges::all_of(block_.words, [](const GcodeWord& one) { return one.letter == 'N'; })) return false;
    ++at_;
    skip_blanks();
    const bool has_number = skip_digits();
    for (skip_blanks(); next() == '(' && skip_past(')'); skip_blanks()) {
    }
    const bool is_alone = has_number && (at_ == text_.size() || next() == ';' || next() == '(');
    block_.kind = is_alone ? GcodeBlock::Kind::name : GcodeBlock::Kind::programmed;
    return stop();
  }

  bool word() {
    GcodeWord word{.letter = upper_case(next()), .at = at_};
    if (word.letter == 'O') return program_name();
    ++at_;
    skip_blanks();
    word.begin = at_;
    const bool has_sign = next() == '-' || next() == '+';
    const char first = has_sign && at_ + 1 < text_.size() ? text_[at_ + 1] : next();
    if (first == '#' || first == '[' || first == '{') return leave_to_the_controller();
    if (first == '"') {
      ++at_;
      if (!skip_past('"')) return false;
      word.kind = GcodeWord::Kind::text;
    } else if (has_sign || is_digit(first) || first == '.') {
      const std::optional<double> value = number();
      if (!value) return false;
      word.kind = skip_exponent(text_[word.at]) ? GcodeWord::Kind::text : GcodeWord::Kind::number;
      word.value = *value;
    }
    word.end = at_;
    block_.words.push_back(word);
    return !takes_text(word) || stop();
  }

  std::string_view text_;
  GcodeBlock& block_;
  std::size_t at_ = 0;
  bool done_ = false, pauses_ = false;
};

/// Klipper's extended commands that move nothing and leave coordinates as they are  [klipper].
constexpr std::array<std::string_view, 18> kSettings{"EXCLUDE_OBJECT",
                                                     "EXCLUDE_OBJECT_DEFINE",
                                                     "EXCLUDE_OBJECT_END",
                                                     "EXCLUDE_OBJECT_START",
                                                     "RESPOND",
                                                     "SET_DISPLAY_TEXT",
                                                     "SET_FAN_SPEED",
                                                     "SET_FILAMENT_SENSOR",
                                                     "SET_GCODE_VARIABLE",
                                                     "SET_HEATER_TEMPERATURE",
                                                     "SET_IDLE_TIMEOUT",
                                                     "SET_LED",
                                                     "SET_PIN",
                                                     "SET_PRESSURE_ADVANCE",
                                                     "SET_PRINT_STATS_INFO",
                                                     "SET_RETRACTION",
                                                     "SET_VELOCITY_LIMIT",
                                                     "TEMPERATURE_WAIT"};

/// Fanuc's and RepRapFirmware's jumps, loops and variables.
constexpr std::array<std::string_view, 9> kFlow{"IF",    "ELIF",     "ELSE", "WHILE", "GOTO",
                                                "BREAK", "CONTINUE", "VAR",  "GLOBAL"};

/// PRINT_START, in upper case; empty where a line begins with something else.
std::string macro_at(std::string_view text) {
  const auto in_name = [](char c) { return is_letter(c) || is_digit(c) || c == '_'; };
  const auto begins_name = [](char c) { return is_letter(c) || c == '_'; };
  if (text.size() < 2 || !begins_name(text[0]) || !begins_name(text[1])) return {};  // as hardly any line
  const auto length = static_cast<std::size_t>(std::ranges::find_if_not(text, in_name) - text.begin());
  if (length < text.size() && !is_blank(text[length])) return {};
  return upper_case(text.substr(0, length));
}

bool is_among(std::string_view name, const auto& names) { return std::ranges::find(names, name) != names.end(); }

bool is_among(std::string_view text, std::size_t begin, std::size_t end, std::span<const std::string> names) {
  return !names.empty() && is_among(upper_case(text.substr(begin, end - begin)), names);
}

}  // namespace

void GcodeBlock::parse(std::string_view line, std::span<const std::string> harmless) {
  kind = Kind::words;
  text = line;
  words.clear();
  is_optional = false;
  const std::string macro = macro_at(line);
  if (!macro.empty()) {
    const bool moves_nothing = is_among(macro, kSettings) || is_among(macro, harmless);
    kind = moves_nothing ? Kind::setting : is_among(macro, kFlow) ? Kind::programmed : Kind::macro;
  } else if (!BlockParser(text, *this).parse()) {
    kind = Kind::malformed;
  }
  // A code of which somebody said that it moves nothing takes its line along, where it is the line's first.
  const auto code = std::ranges::find_if(words, [](const GcodeWord& one) { return one.letter != 'N'; });
  if (kind == Kind::words && code != words.end() && is_among(line, code->at, code->end, harmless)) kind = Kind::setting;
}

std::string_view foreign_language(std::string_view line) {
  static const std::vector<std::pair<std::string_view, std::vector<std::string_view>>> kSigns{
      {"KUKA's KRL", {"&ACCESS", "&REL", "DEF ", "DEFDAT ", "PTP ", "LIN ", "CIRC "}},
      {"ABB's RAPID", {"MODULE ", "PROC ", "%%%", "MOVEJ ", "MOVEL ", "MOVEC "}},
      {"Heidenhain's plain language", {"BEGIN PGM", "BLK FORM", "TOOL CALL", "TOOL DEF"}}};
  const std::size_t begin = line.find_first_not_of(" \t0123456789");  // Heidenhain numbers its blocks
  if (begin == std::string_view::npos) return {};
  const std::string text = upper_case(line.substr(begin, 16));
  for (const auto& [language, signs] : kSigns) {
    if (std::ranges::any_of(signs, [&](std::string_view sign) { return text.starts_with(sign); })) return language;
  }
  return {};
}

}  // namespace paracal::io
