#pragma once

// Private to io: what firmwares print and owners write, as the M-codes that say the same.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "paracal/io/file.hpp"

namespace paracal::io {

/// The text with these changes, line by line:
///
///   {global.NAME}                           the value of "global NAME = VALUE" (RepRapFirmware 3)
///   Diagonals L, delta radius R, homed ...  M665 L R H B X Y Z: answer of RepRapFirmware
///   Endstop adjustments X Y Z, tilt X Y     M666 X Y Z A B: likewise
///   M665 B, where a line of the file calls  removed: Marlin before 2.0.6
///   it B<calibration radius>
///
/// @throws InputFileError for the files of other firmwares, with what to do.
TextFile as_machine_codes(const TextFile& file);

/// Values of "NAME" in sums and differences of numbers and of other names, such as (A - B - 1.5).
class SumOfNames {
 public:
  void define(std::string_view name, std::string_view value);
  /// Empty for anything else than such a sum.
  std::optional<double> value_of(std::string_view text, int depth = 0) const;

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

}  // namespace paracal::io
