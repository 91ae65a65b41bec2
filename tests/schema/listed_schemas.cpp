// The schemas of results whose fields are in lists: listed_schemas FOLDER writes them, listed_schemas FOLDER --check
// fails when they are not current. listed_schemas --keywords prints the keywords of Python's calls from the lists of
// settings, for keywords.py.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "io/calibrations/calibration_fields.hpp"
#include "io/calibrations/failure_fields.hpp"
#include "io/calibrations/validation_fields.hpp"
#include "io/fields/schema.hpp"

namespace {

using paracal::io::Json;
using paracal::io::SchemaFile;

std::map<std::string, Json> listed_schemas() {
  using namespace paracal;
  using namespace paracal::io;
  return {{"calibration.schema.json", SchemaFile("calibration.schema.json").of_result<CalibrationInFile>()},
          {"validation.schema.json", SchemaFile("validation.schema.json").of_result<Validation>()},
          {"parts.schema.json", SchemaFile("parts.schema.json")
                                    .of_parts<InputFile, NullDirection, PoseErrorSummary, TrackerModel, CommonError,
                                              OptionsInFile, Proportion, FailureShare>(
                                        "Parts", "Parts that several results share, with lists of fields.")}};
}

std::string in_one_line(const Json& json) {
  if (!json.is_structured()) return json.dump();
  std::vector<std::string> parts;
  for (const auto& item : json.items()) {
    parts.push_back((json.is_object() ? Json(item.key()).dump() + ": " : "") + in_one_line(item.value()));
  }
  return fmt::format("{}{}{}", json.is_object() ? '{' : '[', fmt::join(parts, ", "), json.is_object() ? '}' : ']');
}

/// A line for each key of the file, of each part and of each list of properties.
std::string in_lines(const Json& json, const std::string& indent, bool holds_parts = false) {
  std::vector<std::string> lines;
  for (const auto& item : json.items()) {
    const bool is_broken = holds_parts || item.key() == "properties" || item.key() == "$defs";
    const std::string value =
        is_broken ? in_lines(item.value(), indent + "  ", item.key() == "$defs") : in_one_line(item.value());
    lines.push_back(fmt::format("{}  {}: {}", indent, Json(item.key()).dump(), value));
  }
  return fmt::format("{{\n{}\n{}}}", fmt::join(lines, ",\n"), indent);
}

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Type and default of a keyword, as Python writes them.
template <typename T>
Json python_type(const paracal::io::Setting& setting, const T& value) {
  using namespace paracal;
  const bool has_default = setting.default_text.empty();
  if constexpr (std::same_as<T, bool>) {
    return {"bool", value == setting.flag_sets ? "True" : "False"};
  } else if constexpr (std::is_enum_v<T>) {
    return {"str", fmt::format("\"{}\"", io::word_of(value))};
  } else if constexpr (std::same_as<T, double>) {
    if (has_default) return {"float", fmt::format("{:.12g}", setting.python_factor() * value)};
    return {"float | None", "None"};
  } else if constexpr (std::same_as<T, std::optional<double>>) {
    return {"float | None", "None"};
  } else if constexpr (std::same_as<T, std::optional<TrackerModel>>) {
    return {"Iterable[float] | None", "None"};
  } else if constexpr (std::same_as<T, std::vector<SourceSelector>>) {
    return {"Iterable[str]", "()"};
  } else if constexpr (std::same_as<T, std::optional<Tolerances>>) {
    return {"Tolerances | None", "None"};
  } else {
    return nullptr;
  }
}

template <typename List, typename Options>
Json keywords() {
  Json all = Json::array();
  const Options defaults;
  List::list(defaults, 1.0, [&]<typename T>(const paracal::io::Setting& setting, const T& value, const auto&...) {
    if (setting.option.empty()) return;
    Json words = Json::array();
    if constexpr (std::is_enum_v<T>) words = paracal::io::words_of<T>();
    const Json type = python_type(setting, value);
    all.push_back({{"keyword", setting.python_keyword()},
                   {"type", type[0]},
                   {"default", type[1]},
                   {"words", words},
                   {"text", setting.text},
                   {"default_text", setting.default_text}});
  });
  return all;
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.empty()) return 2;
  if (words.front() == "--keywords") {
    using namespace paracal;
    fmt::print("{}\n", Json{{"calibrate", keywords<io::CalibrationSettings, CalibrationOptions>()},
                            {"validate", keywords<io::ValidationSettings, ValidationOptions>()}}
                           .dump());
    return 0;
  }
  const bool checks = words.back() == "--check";
  int differ = 0;
  for (const auto& [name, schema] : listed_schemas()) {
    const std::filesystem::path path = std::filesystem::path(words.front()) / name;
    const std::string text = in_lines(schema, "") + "\n";
    if (!checks) {
      std::ofstream(path) << text;
    } else if (content(path) != text) {
      fmt::print(stderr, "schema/{} is not what the lists of fields say: run tools/schemas.sh\n", name);
      ++differ;
    }
  }
  return differ == 0 ? 0 : 1;
}
