#include "manual_pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "help.hpp"
#include "io/files/letters.hpp"

namespace paracal::app {
namespace {

/// Text as roff prints it: every character as it stands, and no line taken for a request.
std::string roff(std::string_view text) {
  const std::string plain = escaped(
      text,
      {{'\\', "\\(rs"}, {'-', "\\-"}, {'\'', "\\(aq"}, {'"', "\\(dq"}, {'~', "\\(ti"}, {'^', "\\(ha"}, {'`', "\\(ga"}});
  return plain.starts_with('.') ? "\\&" + plain : plain;
}

std::string page_name(const CommandText& command) {
  std::string name = command.name;
  std::ranges::replace(name, ' ', '-');
  return name;
}

std::string option_entry(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names) {
    names += (names.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", roff(name));
  }
  if (names.empty()) names = fmt::format("\\fI{}\\fR", roff(option.positional));
  // Between two choices a line may end, and nowhere else.
  const std::string value = option.value.empty() ? "" : " \\%" + escaped(roff(option.value), {{'|', "|\\:\\%"}});
  return fmt::format(".TP\n.na\n{}{}\n.ad\n{}\n", names, value, roff(option.text));
}

std::string options_section(const CommandText& command) {
  std::string text;
  for (const std::string& group : headings(command.options)) {
    text += fmt::format("{}.SS {}\n", text.empty() ? ".SH OPTIONS\n" : "", roff(group));
    for (const OptionText& option : command.options) {
      if (option.group == group) text += option_entry(option);
    }
  }
  return text;
}

std::string commands_section(const CommandText& command) {
  std::string text = command.commands.empty() ? "" : ".SH COMMANDS\n";
  for (const std::string& group : headings(command.commands)) {
    text += fmt::format(".SS {}\n", roff(group));
    for (const CommandText& one : command.commands) {
      if (one.group == group) text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", roff(page_name(one)), roff(one.text));
    }
  }
  return text;
}

std::string synopsis(const CommandText& command) {
  return fmt::format(".SH SYNOPSIS\n.B {}\n", roff(usage_line(command)));
}

std::string examples_section(const CommandText& command) {
  std::string text = command.examples.empty() ? "" : ".SH EXAMPLES\n";
  for (const Example& one : command.examples) {
    text += fmt::format(".TP\n{}:\n.nf\n{}\n.fi\n", roff(one.purpose), roff(one.line));
  }
  return text;
}

/// @param above  the page of the command or program that it belongs to; empty: of the program itself.
std::string page_of(const CommandText& command, const std::string& above, const std::string& version) {
  const std::string text = command.text.substr(command.text.starts_with("paracal: ") ? 9 : 0);
  std::string page =
      fmt::format(".TH {} 1 \"\" \"paracal {}\" \"paracal\"\n", roff(io::upper_case(page_name(command))), version);
  page += fmt::format(".SH NAME\n{} \\- {}\n", roff(page_name(command)), roff(text));
  page += synopsis(command) + options_section(command) + commands_section(command) + examples_section(command);
  if (!command.footer.empty()) page += fmt::format(".SH EXIT STATUS\n{}\n", roff(command.footer));
  if (!above.empty()) page += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", roff(above));
  return page;
}

void add_pages(const CommandText& command, const std::string& above, const std::string& version,
               std::map<std::string, std::string>& pages) {
  pages[page_name(command) + ".1"] = page_of(command, above, version);
  for (const CommandText& one : command.commands) add_pages(one, page_name(command), version, pages);
}

}  // namespace

std::map<std::string, std::string> manual_pages(const CommandText& program, const std::string& version) {
  std::map<std::string, std::string> pages;
  add_pages(program, "", version, pages);
  return pages;
}

}  // namespace paracal::app
