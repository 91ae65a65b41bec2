#pragma once

// Private to the filter: one line of G-code as words. RS-274/NGC and what RepRap firmware adds to it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace paracal::io {

/// No controller has as many tools.
inline constexpr double kMostTool = 1e6;

inline constexpr std::array kAxisLetters{'X', 'Y', 'Z', 'A', 'B', 'C'};

/// A letter and what follows it.
struct GcodeWord {
  enum class Kind : std::uint8_t {
    number,
    flag,  ///< the letter alone, as in RepRap's G28 X
    text,  ///< "start.g"
  };
  char letter = '\0';  ///< upper case
  Kind kind = Kind::flag;
  double value = 0.0;
  std::size_t at = 0;              ///< of the letter
  std::size_t begin = 0, end = 0;  ///< of the number

  bool is_number() const { return kind == Kind::number; }
  bool is_whole(double least, double most) const {
    return is_number() && value >= least && value <= most && value == std::floor(value);
  }
};

/// A line as the controller takes it apart; comments (...) and ;... are passed over.
struct GcodeBlock {
  enum class Kind : std::uint8_t {
    words,
    malformed,   ///< no controller takes it, or it has a checksum
    programmed,  ///< O words, parameters, expressions: what it does is known only to who runs it
    name,        ///< O1001, of the program
    setting,     ///< a command of Klipper's own that moves nothing, or a word of which that was said
    macro,       ///< another of Klipper's commands or the owner's
  };
  Kind kind = Kind::words;
  std::string_view text = {};  ///< as long as what was parsed lives
  std::vector<GcodeWord> words;
  bool is_optional = false;  ///< block delete: '/'

  /// The first word with this letter; null without one.
  const GcodeWord* word(char letter) const {
    const auto found = std::ranges::find(words, letter, &GcodeWord::letter);
    return found == words.end() ? nullptr : &*found;
  }
  bool has_letter(std::string_view letters) const {
    return std::ranges::any_of(
        words, [&](const GcodeWord& word) { return letters.find(word.letter) != std::string_view::npos; });
  }

  /// @param line  without its end. Vectors are reused.
  /// @param harmless  macros and codes that move nothing, in upper case: SNAP, G187, M905.
  void parse(std::string_view line, std::span<const std::string> harmless = {});
};

/// The language of a robot controller whose programs are often taken for G-code; empty where a line is of none.
std::string_view foreign_language(std::string_view line);

}  // namespace paracal::io
