#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/filter/target_filter.hpp"

namespace paracal::test {

/// What a filter made of a text.
struct Filtered {
  std::string text;
  io::FilterSummary summary;

  std::vector<std::string> lines() const;
  /// How often something was passed through for a reason that holds these words.
  std::int64_t passed(std::string_view reason) const;
  bool has(std::string_view reason) const { return passed(reason) > 0; }
};

std::vector<std::string> lines_in(const std::string& text);

Filtered filtered_gcode(const std::string& text, const TargetCorrection& correction,
                        const io::GcodeOptions& options = {});
Filtered filtered_table(const std::string& text, const TargetCorrection& correction);

/// The number behind a letter of a line; nothing without one.
std::optional<double> word(std::string_view line, char letter);

}  // namespace paracal::test
