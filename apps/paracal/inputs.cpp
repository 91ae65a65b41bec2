#include "inputs.hpp"

#include <filesystem>
#include <map>

#include "io/files/letters.hpp"

namespace paracal::app {
namespace {

/// Looked into, and not taken yet.
std::map<std::string, io::TextFile>& waiting() {
  static std::map<std::string, io::TextFile> files;
  return files;
}

}  // namespace

const io::TextFile& look_into(const std::string& name) {
  const auto found = waiting().find(name);
  return found != waiting().end() ? found->second : waiting().emplace(name, io::read_file(name)).first->second;
}

io::TextFile input_table(const std::string& name, const io::TableStyle& style) {
  auto taken = waiting().extract(name);
  io::TextFile file = taken ? std::move(taken.mapped()) : io::read_file(name);
  file.style = style;
  return file;
}

void add_table_options(Command& command, io::TableStyle& style) {
  command.heading("Tables (CSV)");
  command.add_flag("--decimal-comma", style.decimal_comma,
                   "read 1,5 as one and a half; needed only where a table does not show it");
  command.add_option("--ignore-columns", style.ignored_columns, "ignore the columns with these headings")
      ->lists("NAME,...");
}

bool is_calibration(const std::string& errors_file) {
  return io::lower_case(std::filesystem::path(errors_file).extension().string()) == ".json";
}

namespace {

RobotSources with_calibration(const std::string& errors_file, RobotSources sources) {
  if (is_calibration(errors_file)) sources.calibrations = {errors_file};
  return sources;
}

}  // namespace

RobotSources sources_of(const std::string& errors_file, std::string table) {
  return with_calibration(errors_file, {.tables = {std::move(table)}});
}

RobotSources sources_of(const std::string& errors_file, io::CsvStream& rows) {
  return with_calibration(errors_file, {.rows = &rows});
}

}  // namespace paracal::app
