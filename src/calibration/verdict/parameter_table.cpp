#include "parameter_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace paracal::detail {
namespace {

std::vector<std::string> distinct(const std::vector<ParameterCell>& cells, std::string ParameterCell::*of) {
  std::vector<std::string> names;
  for (const ParameterCell& one : cells) {
    if (std::ranges::find(names, one.*of) == names.end()) names.push_back(one.*of);
  }
  return names;
}

}  // namespace

std::string parameter_table(const std::vector<ParameterCell>& cells) {
  constexpr std::size_t kWidest = 120, kGap = 2;
  const std::vector<std::string> rows = distinct(cells, &ParameterCell::row);
  std::size_t label = 0;
  for (const std::string& row : rows) label = std::max(label, row.size() + kGap);
  std::string text;
  std::vector<std::string> lines;
  const auto begin = [&] {
    for (const std::string& line : lines) text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
    lines.assign(1, std::string(label, ' '));
    for (const std::string& row : rows) lines.push_back(fmt::format("  {:<{}}", row, label - kGap));
  };
  begin();
  for (const std::string& column : distinct(cells, &ParameterCell::column)) {
    std::vector<std::string> shown{column};
    for (const std::string& row : rows) {
      const auto cell =
          std::ranges::find_if(cells, [&](const ParameterCell& one) { return one.row == row && one.column == column; });
      shown.push_back(cell == cells.end() ? "fixed " : cell->text);
    }
    const std::size_t width = std::ranges::max(shown, {}, &std::string::size).size() + kGap;
    if (lines.front().size() + width > kWidest) begin();
    for (std::size_t k = 0; k < lines.size(); ++k) lines[k] += fmt::format("{:>{}}", shown[k], width);
  }
  begin();
  return text;
}

std::string limb_row(std::size_t limb) { return fmt::format("limb {}", limb + 1); }

std::string two_digits(double value) {
  return value < 100.0 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

int decimals_of(double uncertainty) {
  constexpr int kMost = 6;
  if (!(uncertainty > 0.0)) return 3;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(uncertainty))), 0, kMost);
}

}  // namespace paracal::detail
