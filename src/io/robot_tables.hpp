#pragma once

// Private to io: a robot and its tolerances as tables, whatever kind of file these stand in.

#include <fmt/format.h>

#include <iterator>
#include <string>

#include "paracal/mechanism/robot.hpp"
#include "section.hpp"

namespace paracal::io {

/// A table that lists only some errors says what the others are, in `others`: "exact" or "generous".
/// @throws InputFileError where it does not, naming what is missing; for a negative half-width and unknown keys.
Tolerances tolerances_of(Section section, const Geometry& geometry);

/// A robot file's document.
/// @throws InputFileError for missing, unknown or wrongly typed keys, and for geometry that Robot refuses.
Robot robot_of(const std::string& file, const toml::table& document);

/// "[1, 2.5]"
std::string array(const auto& values) {
  std::string text;
  for (const double value : values) fmt::format_to(std::back_inserter(text), "{}{}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

}  // namespace paracal::io
