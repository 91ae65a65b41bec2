#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// Words of IEC 61131-3 Structured Text, as strictly as the strictest of CODESYS, TwinCAT and matiec takes them.

namespace paracal::test {

/// What a controller would not take, or not survive, with its line.
class StructuredTextError : public std::runtime_error {
 public:
  StructuredTextError(int line, const std::string& what);
};

struct Token {
  enum class Kind { word, keyword, integer, real, sign, end } kind;
  std::string text;  ///< words and keywords in capitals: the language does not tell them apart
  int line;
};

/// Comments left out; ends with a token of kind end.
/// @throws StructuredTextError for what is no word: also names that some tool refuses (longer than 32 characters, with
/// two underscores together or one at an end), numbers like 1. or .5 or 1e5, // comments and comments within comments.
std::vector<Token> tokens_of(std::string_view text);

}  // namespace paracal::test
