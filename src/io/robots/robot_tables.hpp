#pragma once

// Private to io: a robot and its tolerances as tables, whatever kind of file these stand in.

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <vector>

#include "paracal/mechanism/robot.hpp"
#include "section.hpp"

namespace paracal::io {

/// A table that lists only some errors says what the others are, in `others`: "exact" or "generous". Drawing statements
/// are of the nominal sizes of that geometry, with what single limbs are intended to differ by.
/// @throws InputFileError where it does not, naming what is missing; for a negative half-width, for what no drawing
/// says
///         of an error, and unknown keys.
Tolerances tolerances_of(Section section, const Geometry& geometry, const SourceErrors& intended);

/// A robot file's document.
/// @throws InputFileError for missing, unknown or wrongly typed keys, and for geometry that Robot refuses.
Robot robot_of(const std::string& file, const toml::table& document);

/// What a [[limb]] table says under one key, in the units of files.
struct LimbValues {
  std::string key;
  std::vector<double> values;  ///< three of e_mm, else one
};

/// All errors of one limb.
std::vector<LimbValues> limb_values(const SourceErrors& errors, std::size_t limb, Actuator actuator);

/// What each limb is intended to differ by, without zeros; empty where all limbs are alike.
std::vector<std::vector<LimbValues>> intended_values(const Robot& robot);

/// "[1, 2.5]"
std::string array(const auto& values) {
  std::string text;
  for (const double value : values) fmt::format_to(std::back_inserter(text), "{}{}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

}  // namespace paracal::io
