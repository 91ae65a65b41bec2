#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace paracal::app {

/// An option as --help shows it, in pieces.
struct OptionText {
  std::vector<std::string> names;  ///< "-h", "--help"; a positional one has none
  std::string positional;          ///< what a positional one is called
  std::string value;               ///< what --help says between name and text: kind, default, what it needs
  std::string text;
  std::string group;                      ///< its heading
  std::vector<std::string> choices = {};  ///< what its value may be, where that is a short list
  bool takes_others = false;              ///< files, too
  bool takes_value = false;
};

/// A command, or the program, with all that belongs to it; hidden ones are left out.
struct CommandText {
  std::string name;  ///< whole: "paracal tolerance allocate"
  std::string text;
  std::string group;
  std::string footer;
  std::vector<OptionText> options = {};
  std::vector<CommandText> commands = {};
};

/// Its last word.
std::string word_of(const CommandText& command);

/// The text with some characters written otherwise.
std::string escaped(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> others);

}  // namespace paracal::app
