#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace paracal::app {

/// An option as --help shows it, in pieces.
struct OptionText {
  std::vector<std::string> names;         ///< "-h", "--help"; a positional one has none
  std::string positional;                 ///< what a positional one is called
  std::string value;                      ///< what it takes: MM, FILE ..., rough|fine
  std::string text;                       ///< with its default
  std::string group;                      ///< its heading
  std::vector<std::string> choices = {};  ///< what its value may be, where that is a short list
  bool takes_others = false;              ///< files, too
  bool takes_value = false;
  bool is_required = false;
};

/// A command line that runs beside the samples, and what it is for.
struct Example {
  std::string purpose, line;
};

/// A command, or the program, with all that belongs to it except hidden commands and options.
struct CommandText {
  std::string name;  ///< whole: "paracal tolerance allocate"
  std::string text;
  std::string group;
  std::string footer;
  std::vector<OptionText> options = {};
  std::vector<CommandText> commands = {};
  std::vector<Example> examples = {};
};

/// Its last word.
std::string word_of(const CommandText& command);

/// Headings of options or commands in the order of their first item; "Common" is the last one.
template <typename Item>
std::vector<std::string> headings(const std::vector<Item>& items) {
  std::vector<std::string> found;
  for (const bool common : {false, true}) {
    for (const Item& item : items) {
      if ((item.group == "Common") == common && std::ranges::find(found, item.group) == found.end())
        found.push_back(item.group);
    }
  }
  return found;
}

/// The text with some characters written otherwise.
std::string escaped(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> others);

}  // namespace paracal::app
