#include "paracal/mechanism/plausible.hpp"

#include <fmt/format.h>

#include "numerics/median.hpp"

namespace paracal::plausible {

std::optional<std::string> complaint(std::string_view quantity, double value, const Range& range) {
  if (range.contains(value)) return std::nullopt;
  const std::string unit = range.unit.empty() ? "" : fmt::format(" {}", range.unit);
  const std::string why = range.why.empty() ? "" : fmt::format(" ({})", range.why);
  const std::string from = range.least == kNothing ? "above 0 and up" : fmt::format("from {:g}", range.least);
  return fmt::format("expected {} {} to {:g}{}{}, got {:g}", quantity, from, range.most, unit, why, value);
}

Range dimension(std::vector<double> all) {
  constexpr double kSmallest = 1e-6, kLargest = 100.0;
  const double middle = detail::median(std::move(all));
  return {kSmallest * middle, kLargest * middle, "mm", "compared with the other dimensions"};
}

}  // namespace paracal::plausible
