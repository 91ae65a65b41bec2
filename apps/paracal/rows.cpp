#include "rows.hpp"

#include <fmt/format.h>

#include "session.hpp"

namespace paracal::app {
namespace {

/// A value as it is printed at some depth of an object, all lines but the first indented.
std::string indented(const io::Json& json, std::string_view indent) {
  std::string text;
  for (const char c : json_text(json)) c == '\n' ? text.append("\n").append(indent) : text += c;
  return text.erase(text.size() - indent.size() - 1);  // the end of the last line
}

/// A value as it is printed within an array of an object.
std::string in_array(const io::Json& json) {
  constexpr std::string_view kIndent = "    ";
  return std::string(kIndent) + indented(json, kIndent);
}

}  // namespace

void add_json_lines_option(Command& command, bool& json_lines) {
  command.heading("Common");
  command.add_flag("--json-lines", json_lines, "print one JSON object per row, each on its own line")
      ->excludes(command.get_option("--json"));
}

RowOutput::RowOutput(Session& session, bool json_lines, const std::vector<JsonColumn>& columns)
    : format_(json_lines       ? Format::json_lines
              : session.json() ? Format::json
                               : Format::table),
      sink_(session.result_sink()) {
  for (const JsonColumn& column : columns) columns_.emplace_back(column);
}

void RowOutput::head(std::string_view text) {
  if (format_ != Format::table) return;
  has_head_ = true;
  write(text);
  waiting_.read([this](std::string_view rows) { write(rows); });
}

void RowOutput::add_line(std::string_view text) { has_head_ ? write(text) : waiting_.write(text); }

void RowOutput::add_object(const io::Json& row) {
  if (format_ == Format::json_lines) return write(json_line(row));
  for (auto& [column, spool] : columns_) {
    if (has_rows_) spool.write(",\n");
    spool.write(in_array(column.key.empty() ? row : row.at(column.key)));
  }
  has_rows_ = true;
}

void RowOutput::finish(const io::Json& rest) {
  if (format_ == Format::json) {
    std::string_view before = "{\n";
    for (const auto& [column, spool] : columns_) {
      write(fmt::format("{}  \"{}\": [\n", before, column.name));
      spool.read([this](std::string_view rows) { write(rows); });
      write("\n  ]");
      before = ",\n";
    }
    for (const auto& [key, value] : rest.items()) write(fmt::format(",\n  \"{}\": {}", key, indented(value, "  ")));
    write("\n}\n");
  }
  pass_on();
}

void RowOutput::write(std::string_view text) {
  constexpr std::size_t kPiece = 1 << 20;
  text_ += text;
  if (text_.size() >= kPiece) pass_on();
}

void RowOutput::pass_on() {
  sink_(text_);
  text_.clear();
}

}  // namespace paracal::app
