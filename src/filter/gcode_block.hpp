#pragma once

// Private to io: one line of G-code as words. RS-274/NGC and what RepRap firmware adds to it.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace paracal::io {

inline constexpr std::array kAxisLetters{'X', 'Y', 'Z', 'C'};

/// A letter and what follows it.
struct GcodeWord {
  enum class Kind : std::uint8_t {
    number,
    flag,        ///< the letter alone, as in RepRap's G28 X
    expression,  ///< #1, #<name>, [...]
  };
  char letter = '\0';  ///< upper case
  Kind kind = Kind::flag;
  double value = 0.0;
  std::size_t at = 0;              ///< of the letter
  std::size_t begin = 0, end = 0;  ///< of the number

  bool is_number() const { return kind == Kind::number; }
};

/// A line as the controller takes it apart; comments (...) and ;... are passed over.
struct GcodeBlock {
  enum class Kind : std::uint8_t {
    words,
    malformed,  ///< no controller takes it, or its checksum is wrong
    flow,       ///< an O word: subprograms, jumps, loops
    setting,    ///< a command of Klipper's own that moves nothing, or a macro of which that was said
    macro,      ///< another of Klipper's commands or the owner's
  };
  Kind kind = Kind::words;
  std::string_view text = {};  ///< as long as what was parsed lives
  std::vector<GcodeWord> words;
  std::vector<std::pair<std::string_view, std::string_view>> assignments;  ///< #1 and 5 of #1 = 5
  bool is_optional = false;                                                ///< block delete: '/'
  std::size_t checksum_at = 0;                                             ///< of RepRap's '*'; 0: none

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
  /// @param harmless  macros that move nothing, in upper case.
  void parse(std::string_view line, std::span<const std::string> harmless = {});
};

/// RepRap: exclusive or of the bytes before '*'.
unsigned gcode_checksum(std::string_view text);

}  // namespace paracal::io
