#pragma once

// Private to io: a robot and its tolerances as tables, whatever kind of file these stand in.

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <vector>

#include "paracal/io/json.hpp"
#include "paracal/mechanism/robot.hpp"
#include "section.hpp"

namespace paracal::io {

/// A table that lists only some errors says what the others are, in `others`: "exact" or "generous". Drawing statements
/// are of the nominal sizes of these limbs.
/// @throws InputFileError where it does not, naming what is missing; for a negative half-width, for what no drawing
/// says
///         of an error, and unknown keys.
Tolerances tolerances_of(Section section, const Limbs& limbs);

/// A robot file's document.
/// @throws InputFileError for missing, unknown or wrongly typed keys, and for geometry that Robot refuses.
Robot robot_of(const std::string& file, const toml::table& document);

/// What a table says under one key, in the units of files.
struct KeyValues {
  std::string key;
  std::vector<double> values;  ///< one that is alone is a number, more are a list
};

/// A table in TOML and in JSON.
std::string values_toml(const std::vector<KeyValues>& values);
Json values_json(const std::vector<KeyValues>& values);

/// What [workspace] says: in the shape that was read.
std::vector<KeyValues> workspace_values(const Workspace& workspace);

/// All errors of one limb.
std::vector<KeyValues> limb_values(const SourceErrors& errors, std::size_t limb, Actuator actuator);

/// What each limb differs in from the shared dimensions of the short form, without zeros; empty where all are alike, or
/// limbs state their own dimensions.
std::vector<std::vector<KeyValues>> differences(const Robot& robot);

/// "[1, 2.5]"
std::string array(const auto& values) {
  std::string text;
  for (const double value : values) fmt::format_to(std::back_inserter(text), "{}{}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

}  // namespace paracal::io
