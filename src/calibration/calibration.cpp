#include "paracal/calibration/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "paracal/units.hpp"

namespace paracal {

std::string_view name(ReflectorMount mount) {
  switch (mount) {
    case ReflectorMount::plate:
      return "plate";
    case ReflectorMount::end_effector:
      return "end-effector";
    case ReflectorMount::end_effector_reversed:
      return "end-effector-reversed";
  }
  return "";
}

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
  SourceErrors errors = options.expected.value_or(SourceErrors{});
  for (const ParameterEstimate& parameter : parameters) errors(parameter.limb, parameter.source) = parameter.value;
  return errors;
}

std::vector<Calibration::Correlation> Calibration::correlations(double threshold) const {
  std::vector<Correlation> strong;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index k = 0; k < i; ++k) {
      const double value = covariance(i, k) / std::sqrt(covariance(i, i) * covariance(k, k));
      if (std::abs(value) >= threshold)
        strong.push_back({static_cast<std::size_t>(k), static_cast<std::size_t>(i), value});
    }
  }
  std::ranges::sort(strong, std::greater{}, [](const Correlation& pair) { return std::abs(pair.value); });
  return strong;
}

namespace {

/// "limb 1  theta_offset   0.206 deg, U 0.026 (k = 2.1)"
std::string line_of(const ParameterEstimate& parameter, Actuator actuator) {
  const Unit inside = unit(parameter.source, actuator);
  const auto shown = [&](double value) { return to_file_unit(inside, value); };
  std::string text = fmt::format("  limb {}  {:<17}{:>8.3f} {}", parameter.limb + 1, name(parameter.source, actuator),
                                 shown(parameter.value), file_unit(inside));
  if (parameter.std) {
    text += fmt::format(", U {:.3f} (k = {:.1f})", shown(parameter.coverage() * *parameter.std), parameter.coverage());
  }
  if (parameter.prior_std) {
    text += fmt::format(", {:.0f} % from the readings", 100.0 * parameter.data_share);
  }
  return text + '\n';
}

std::string use_text(const char* what, const UseQuantity& one, double unit, const char* name) {
  std::string text = fmt::format("{} within {:.2g} {}", what, one.U * unit, name);
  if (one.limit) text += fmt::format(" (limit {:.3g}: {})", *one.limit * unit, one.kept() ? "kept" : "not kept");
  return text;
}

std::string use_line(const Use& use) {
  std::string text = fmt::format("  in use, anywhere in the workspace (95 %): {}, {}",
                                 use_text("distances to home", use.distance, 1.0, "mm"),
                                 use_text("positions after alignment", use.aligned, 1.0, "mm"));
  if (use.rotation) text += ", " + use_text("rotations", *use.rotation, to_degrees(1.0), "deg");
  return text + '\n';
}

/// Residuals of what was read, and of nothing else.
std::string residual_lines(const Calibration& calibration) {
  const PoseErrorSummary &before = calibration.before, &after = calibration.after;
  std::string text;
  const auto out = std::back_inserter(text);
  if (after.reads_distances) {
    fmt::format_to(out, "  residuals of distances, rms: {:.3f} mm before, {:.3f} mm after ({} readings, {} to spare)\n",
                   before.rms_distance, after.rms_distance, calibration.readings, calibration.degrees_of_freedom);
  }
  for (const auto& [kind, rms] : after.rms_lengths) {
    const auto was = before.rms_lengths.find(kind);
    fmt::format_to(out, "  residuals of {}, rms: {:.3f} mm before, {:.3f} mm after ({} readings, {} to spare)\n",
                   words(kind).plural, was == before.rms_lengths.end() ? 0.0 : was->second, rms, calibration.readings,
                   calibration.degrees_of_freedom);
  }
  if (calibration.distance_bias) {
    fmt::format_to(out, "  all distances were read {:+.3f} mm too long\n", *calibration.distance_bias);
  }
  if (!calibration.points.empty()) {
    fmt::format_to(
        out, "  residuals of points, largest after alignment: {:.3f} mm before, {:.3f} mm after; noise {:.3f} mm\n",
        before.max_volumetric_aligned, after.max_volumetric_aligned, calibration.noise);
  }
  if (after.max_abs_rotation) {
    fmt::format_to(out, "  residuals of rotations, largest: {:.2f} deg before, {:.2f} deg after\n",
                   to_degrees(*before.max_abs_rotation), to_degrees(*after.max_abs_rotation));
  }
  if (after.max_orientation) {
    fmt::format_to(
        out, "  residuals of orientations, largest: {:.2f} deg before, {:.2f} deg after; noise {:.3f} deg an axis\n",
        to_degrees(before.max_orientation.value_or(0.0)), to_degrees(*after.max_orientation),
        to_degrees(calibration.orientation_noise.value_or(0.0)));
  }
  return text;
}

}  // namespace

std::string Calibration::brief() const {
  std::string text = fmt::format("calibration of {}: {}\n", robot.name(), paracal::name(verdict));
  const auto out = std::back_inserter(text);
  if (use) text += use_line(*use);
  for (const std::string& reason : reasons) fmt::format_to(out, "  because {}\n", reason);
  for (const std::string& note : notes) fmt::format_to(out, "  note: {}\n", note);
  for (const std::string& one : assumed) fmt::format_to(out, "  assumed: {}\n", one);
  for (const ParameterEstimate& parameter : parameters) {
    if (!parameter.held && (!tilts_plate(parameter.source, robot.actuator()) || parameter.identified())) {
      text += line_of(parameter, robot.actuator());
    }
  }
  for (const NullDirection& direction : null_space) fmt::format_to(out, "  not seen: {}\n", direction.text);
  return readings == 0 ? text : text + residual_lines(*this);
}

}  // namespace paracal
