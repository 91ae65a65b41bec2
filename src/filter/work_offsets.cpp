// LinuxCNC's parameter file [linuxcnc, parameters]: 5220 is the system in force, 5221 to 5230 are G54's X, Y, Z, A, B,
// C, U, V, W and turn, 5241 to 5250 G55's, and so on; 5210 says whether G92 holds.

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "io/tables/columns.hpp"
#include "paracal/error.hpp"
#include "paracal/filter/target_filter.hpp"

namespace paracal::io {
namespace {

constexpr int kShifted = 5210, kActive = 5220, kFirstSystem = 5220, kBetweenSystems = 20, kTurn = 10;

using Parameters = std::map<int, double>;

Parameters parameters_in(const TextFile& file) {
  Parameters parameters;
  int line = 0;
  for (const std::string_view whole : lines_of(file.text)) {
    ++line;
    const std::string_view text = trimmed(whole);
    if (text.empty() || text.starts_with('#') || text.starts_with(';')) continue;
    const std::size_t gap = std::min(text.find_first_of(" \t"), text.size());
    const std::optional<double> number = finite_number(text.substr(0, gap)),
                                value = finite_number(trimmed(text.substr(gap)));
    if (!number || !value || *number != std::floor(*number) || std::abs(*number) > 1e6) {
      throw InputFileError(
          file.name, line,
          fmt::format("expected the number and the value of a parameter, got {}", quoted(std::string(text))));
    }
    if (!parameters.emplace(static_cast<int>(*number), *value).second) {
      throw InputFileError(file.name, line, fmt::format("expected each parameter once, got {} again", *number));
    }
  }
  return parameters;
}

}  // namespace

WorkOffsets read_work_offsets(const TextFile& file) {
  const Parameters parameters = parameters_in(file);
  const auto value = [&](int number) -> std::optional<double> {
    const auto found = parameters.find(number);
    return found == parameters.end() ? std::nullopt : std::optional(found->second);
  };
  WorkOffsets offsets{.is_shifted = value(kShifted) != 0.0};
  bool has_any = false;
  for (std::size_t k = 0; k < WorkOffsets::kSystems; ++k) {
    const int base = kFirstSystem + kBetweenSystems * static_cast<int>(k);
    ProgramAxes offset{};
    bool is_known = value(base + kTurn).value_or(0.0) == 0.0;
    for (std::size_t axis = 0; axis < offset.size(); ++axis) {
      const std::optional<double> stated = value(base + 1 + static_cast<int>(axis));
      is_known &= stated.has_value();
      has_any |= stated.has_value();
      offset[axis] = stated.value_or(0.0);
    }
    if (is_known) offsets.systems[k] = offset;
  }
  if (!has_any) {
    throw InputFileError(file.name, 0, "expected LinuxCNC's parameters from 5221 (origins of G54 to G59.3), got none");
  }
  const double active = value(kActive).value_or(0.0);
  if (active != std::floor(active) || active < 0.0 || active > WorkOffsets::kSystems) {
    throw InputFileError(file.name, 0,
                         fmt::format("parameter 5220: expected a coordinate system from 1 to 9, got {}", active));
  }
  offsets.active = static_cast<std::size_t>(active);
  return offsets;
}

}  // namespace paracal::io
