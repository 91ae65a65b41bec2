#pragma once

// Private to io: the words of M-codes.

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/file.hpp"

namespace paracal::io {

/// The words of one code by their letters, each the last of its letter in a file. Codes may stand behind anything that
/// ends before them, in lower case, without blanks between their words; comments and checksums do not count.
class CodeWords {
 public:
  /// @param letters  that the code has.
  /// @throws InputFileError for others.
  CodeWords(const TextFile& file, std::string_view name, std::string_view letters);

  [[noreturn]] void fail(const std::string& complaint) const;
  /// Of what stands after a letter.
  [[noreturn]] void fail(char letter, const std::string& complaint) const;

  /// The numbers after a letter, between colons.
  /// @param what  that letter stands for.
  /// @throws InputFileError without it, and for anything but numbers.
  std::vector<double> numbers(char letter, std::string_view what) const;
  double number(char letter, std::string_view what) const;
  double number_or(char letter, double otherwise) const;
  /// One number for all towers, or three.
  std::array<double, 3> one_or_three(char letter, std::string_view what) const;

 private:
  struct Word {
    std::string text;
    int line = 0;
  };

  std::string file_;
  std::string_view name_;
  std::map<char, Word> words_;
  int line_ = 0;
};

}  // namespace paracal::io
