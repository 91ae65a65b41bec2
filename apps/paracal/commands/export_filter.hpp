#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/compensation/export.hpp"
#include "paracal/compensation/target_correction.hpp"
#include "paracal/filter/target_filter.hpp"
#include "session.hpp"

namespace paracal::app {

/// Names of dialects, as options state them.
inline constexpr std::array<std::pair<std::string_view, io::GcodeDialect>, 5> kDialects{
    {{"linuxcnc", io::GcodeDialect::linuxcnc},
     {"klipper", io::GcodeDialect::klipper},
     {"marlin", io::GcodeDialect::marlin},
     {"rrf", io::GcodeDialect::reprapfirmware},
     {"fanuc-like", io::GcodeDialect::fanuc_like}}};

/// Options of targets that rewrite a file, `gcode` and `csv`.
struct FilterOptions {
  std::string input;                ///< empty or "-": standard input
  std::vector<double> origin = {};  ///< x, y, z, mm
  std::vector<double> start = {};   ///< x, y, z and phi or three tilts, mm and deg
  bool header = false;
  bool partial = false;  ///< what cannot be corrected stays as it is; without it the whole file is refused
  bool check = false;    ///< nothing is written but what would happen
  std::optional<double> chord_mm = {};
  bool in_place = false;                   ///< the file is replaced by its corrected text
  std::vector<std::string> harmless = {};  ///< macros and codes
  std::string harmless_words = {};         ///< a file of them
  std::optional<io::GcodeDialect> dialect = {};
  std::string work_offsets = {};  ///< LinuxCNC's parameter file
  std::string tools = {};         ///< LinuxCNC's tool table

  /// Whether none of them speaks of programs alone.
  bool is_of_tables() const {
    return origin.empty() && start.empty() && !chord_mm && harmless.empty() && harmless_words.empty() &&
           work_offsets.empty() && tools.empty() && !dialect;
  }
  bool is_empty() const { return input.empty() && !header && !partial && !check && !in_place && is_of_tables(); }
};

/// Corrects the targets of a file on its way to --out or standard output, and says what it did.
/// @throws InputFileError where some cannot be corrected, before anything is written, unless options take parts.
void filter_file(const std::string& target, const FilterOptions& options, const TargetCorrection& correction,
                 const ExportOrigin& origin, Session& session);

}  // namespace paracal::app
