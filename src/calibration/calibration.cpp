#include "paracal/calibration/calibration.hpp"

#include <fmt/format.h>

#include <iterator>

#include "paracal/units.hpp"

namespace paracal {

std::string_view name(Verdict verdict) {
  switch (verdict) {
    case Verdict::accepted:
      return "accepted";
    case Verdict::rejected:
      return "rejected";
    case Verdict::not_identifiable:
      return "not identifiable";
    case Verdict::not_converged:
      return "not converged";
  }
  return "";
}

SourceErrors Calibration::errors() const {
  SourceErrors errors;
  for (const ParameterEstimate& parameter : parameters) errors(parameter.limb, parameter.source) = parameter.value;
  return errors;
}

std::string Calibration::brief() const {
  std::string text = fmt::format("calibration of {}: {}\n", robot.name(), paracal::name(verdict));
  const auto out = std::back_inserter(text);
  for (const std::string& reason : reasons) fmt::format_to(out, "  because {}\n", reason);
  for (const ParameterEstimate& parameter : parameters) {
    const bool angle = unit(parameter.source) == Unit::rad;
    const auto shown = [&](double value) { return angle ? to_degrees(value) : value; };
    fmt::format_to(out, "  limb {}  {:<14}{:>9.3f} {}", parameter.limb + 1, paracal::name(parameter.source),
                   shown(parameter.value), angle ? "deg" : "mm");
    if (parameter.std) fmt::format_to(out, ", standard deviation {:.3f}", shown(*parameter.std));
    text += '\n';
  }
  for (const NullDirection& direction : null_space) fmt::format_to(out, "  not seen: {}\n", direction.text);
  if (residuals.empty()) return text;
  fmt::format_to(out, "  distances, rms: {:.3f} mm before, {:.3f} mm after ({} readings, {} to spare)\n",
                 before.rms_distance, after.rms_distance, residuals.size(), degrees_of_freedom);
  if (after.max_abs_rotation) {
    fmt::format_to(out, "  rotations, largest: {:.2f} deg before, {:.2f} deg after\n",
                   to_degrees(*before.max_abs_rotation), to_degrees(*after.max_abs_rotation));
  }
  return text;
}

}  // namespace paracal
