#pragma once

// Private: one list of settings for each struct of options. Options of the command line, keywords of Python, recorded
// options and their schema come from the list.

#include <cstdint>
#include <string>
#include <string_view>

#include "paracal/mechanism/plausible.hpp"
#include "words.hpp"

namespace paracal::io {

/// Who can set it.
enum class SetBy : std::uint8_t { all, python };

/// One setting. The list calls setting(form, value) for it, or setting(form, value, other...) where it sets several
/// values of one type. Types of values: double, optional<double>, bool, an enumeration with words, and those that a
/// list's own readers know. A value without a unit in its name, that is in the unit of the robot's joints, is an angle
/// as one with -deg is.
struct Setting {
  std::string_view option = {};        ///< of the program, without dashes: "limit-deg"; empty: it is only recorded
  std::string_view key = {};           ///< of recorded options; empty: it is not recorded
  std::string_view text = {};          ///< what it is: in --help, docs, docstrings and schema
  std::string_view recorded = {};      ///< what its key says, if not that
  std::string_view heading = {};       ///< above it in --help
  std::string_view keyword = {};       ///< of Python, if it is not "limit_rad", from the option's name
  std::string_view takes = {};         ///< what --help calls its value, if its name has no unit
  std::string_view default_text = {};  ///< where the default is not one value
  plausible::Range range = plausible::kFinite;  ///< in the unit of the option
  double factor = 1.0;                          ///< from mm and rad to the unit of option and key
  bool is_angle = false;                        ///< Python takes and gives it in rad
  bool flag_sets = true;                        ///< what a flag makes of a bool
  bool may_lack = false;                        ///< an empty value is not recorded; else it is null
  SetBy set_by = SetBy::all;

  /// "limit_rad" of "limit-deg".
  std::string python_keyword() const {
    if (!keyword.empty()) return std::string(keyword);
    std::string name(option);
    if (is_angle && name.ends_with("-deg")) name.replace(name.size() - 3, 3, "rad");
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
  }
  /// From mm and rad to the unit of Python's keyword.
  double python_factor() const { return is_angle ? 1.0 : factor; }
  plausible::Range python_range() const {
    const double ratio = python_factor() / factor;
    return {range.least * ratio, range.most * ratio, is_angle ? "" : range.unit, range.why};
  }
};

}  // namespace paracal::io
