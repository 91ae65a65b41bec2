#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/spool.hpp"

namespace paracal::app {

class Session;

/// --json-lines, beside --json.
void add_json_lines_option(Command& command, bool& json_lines);

/// What all rows have under one key, as an array of the one JSON object.
struct JsonColumn {
  std::string name;      ///< of the array
  std::string key = {};  ///< of a row; empty: the array is of the rows themselves
};

/// The rows of a result on their way to --out or standard output, as they are computed: as a table, as JSON lines or as
/// one JSON object. Memory does not grow with them; what must wait for others waits in a Spool. Standard output has
/// nothing of a result shorter than 1 MiB before all of it is there.
class RowOutput {
 public:
  /// @param columns  of the one JSON object, in its order.
  RowOutput(Session& session, bool json_lines, const std::vector<JsonColumn>& columns);

  /// What stands above the rows of a table. Those that came before it have waited for it.
  void head(std::string_view text);

  /// @param line    its call gives the row as a line of the table,
  /// @param object  and that of this as a JSON object; only what is wanted is called.
  void add(const auto& line, const auto& object) { format_ == Format::table ? add_line(line()) : add_object(object()); }

  /// Behind the last row.
  /// @param rest  what the one JSON object has behind its columns.
  void finish(const io::Json& rest = io::Json::object());

 private:
  enum class Format : std::uint8_t { table, json, json_lines } format_;
  /// An array so far.
  struct Column {
    explicit Column(JsonColumn of) : column(std::move(of)) {}
    JsonColumn column;
    io::Spool spool = {};
  };

  void add_line(std::string_view text);
  void add_object(const io::Json& row);
  void write(std::string_view text);
  void pass_on();

  io::TextSink sink_;
  std::string text_ = {};  ///< not passed on yet
  bool has_head_ = false, has_rows_ = false;
  io::Spool waiting_ = {};
  std::deque<Column> columns_ = {};
};

}  // namespace paracal::app
