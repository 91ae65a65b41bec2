#include "paracal/calibration/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

#include "calibration/fit/null_space.hpp"
#include "paracal/units.hpp"
#include "parameter_table.hpp"

namespace paracal {

std::string_view name(ReflectorMount mount) {
  constexpr std::array kNames{"plate", "end-effector", "end-effector-reversed"};
  return kNames.at(static_cast<std::size_t>(mount));
}

std::string_view name(Verdict verdict) {
  constexpr std::array kNames{"accepted", "rejected", "not identifiable", "not converged"};
  return kNames.at(static_cast<std::size_t>(verdict));
}

SourceErrors Posterior::errors() const {
  SourceErrors all = expected;
  for (const ParameterEstimate& parameter : parameters) all(parameter.limb, parameter.source) = parameter.value;
  return all;
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

/// The tilt group only where something of it was identified.
bool is_shown(const Calibration& calibration, Source source) {
  return std::ranges::any_of(calibration.parameters, [&](const ParameterEstimate& one) {
    return one.source == source && !one.held && (one.identified() || !tilts_plate(source));
  });
}

/// "0.206 +-0.026", and a mark where it is mostly from the prior.
std::string cell_of(const ParameterEstimate& parameter, Unit inside) {
  if (parameter.held) return "fixed ";
  const auto shown = [&](double value) { return to_file_unit(inside, value); };
  const char* mark = parameter.identified() ? " " : "*";
  if (!parameter.std) return fmt::format("{:.3f}{}", shown(parameter.value), mark);
  const double U = shown(parameter.coverage() * *parameter.std);
  const int decimals = detail::decimals_of(U);
  return fmt::format("{:.{}f} +-{:.{}f}{}", shown(parameter.value), decimals, U, decimals, mark);
}

/// Their values, a row a limb, with a legend.
std::string parameter_lines(const Calibration& calibration) {
  std::vector<detail::ParameterCell> cells;
  double smallest = std::numeric_limits<double>::infinity(), largest = 0.0;  // k
  for (const ParameterEstimate& one : calibration.parameters) {
    if (!is_shown(calibration, one.source)) continue;
    const Unit inside = calibration.robot.parameter(one.limb, one.source).unit;
    cells.push_back(
        {detail::limb_row(one.limb), fmt::format("{} {} ", name(one.source), file_unit(inside)), cell_of(one, inside)});
    if (one.held || !one.std) continue;
    smallest = std::min(smallest, one.coverage());
    largest = std::max(largest, one.coverage());
  }
  if (cells.empty()) return {};
  std::string text = "  errors (actual minus nominal)";
  if (largest > 0.0) {
    const std::string from = fmt::format("{:.1f}", smallest), to = fmt::format("{:.1f}", largest);
    text += fmt::format(" +- expanded uncertainty U (k = {}{}, 95 %)", from, from == to ? "" : " to " + to);
  }
  text += '\n' + detail::parameter_table(cells);
  if (text.find('*') != std::string::npos) text += "  * mostly from the prior: the measurements give less than 50 %\n";
  if (text.find("fixed") != std::string::npos) text += "  fixed: at nominal, not estimated\n";
  return text;
}

std::string use_text(const char* what, const UseQuantity& one, double unit, const char* name) {
  std::string text = fmt::format("{} below {:.2g} {}", what, one.U * unit, name);
  if (one.limit) text += fmt::format(" (limit {:.3g}: {})", *one.limit * unit, one.kept() ? "met" : "not met");
  return text;
}

/// Of the mean of many visits where that is better.
std::string mean_text(const Use& any, const std::optional<Use>& mean) {
  constexpr double kBetter = 0.95;
  if (!mean || mean->distance.U > kBetter * any.distance.U) return {};
  return fmt::format("; mean of many visits: distances to home below {:.2g} mm", mean->distance.U);
}

std::string use_line(const Use& use, const std::optional<Use>& mean) {
  std::string text = fmt::format("  uncertainty over the workspace (95 % of such machines): {}, {}",
                                 use_text("distances to home", use.distance, 1.0, "mm"),
                                 use_text("aligned positions", use.aligned, 1.0, "mm"));
  if (use.rotation) text += ", " + use_text("rotations", *use.rotation, to_degrees(1.0), "deg");
  return text + mean_text(use, mean) + '\n';
}

/// What the smooth errors of drives are worth, where they belong to the machine.
std::string drives_line(const OmittedPoses& omitted_poses) {
  return fmt::format(
      "  uneven drives: with their smooth errors, {} poses omitted one by one are predicted within {:.2g} mm (rms), "
      "rigid {:.2g} mm; compensate uses them\n",
      omitted_poses.poses, omitted_poses.with_drives, omitted_poses.rigid);
}

/// Residuals of what was read, and of nothing else.
std::string residual_lines(const Calibration& calibration) {
  const PoseErrorSummary &before = calibration.before, &after = calibration.after;
  std::string text;
  const auto out = std::back_inserter(text);
  if (after.reads_distances) {
    fmt::format_to(
        out, "  residuals of distances, rms: {:.3f} mm before, {:.3f} mm after ({} readings, {} degrees of freedom)\n",
        before.rms_distance, after.rms_distance, calibration.readings, calibration.degrees_of_freedom);
  }
  for (const auto& [kind, rms] : after.rms_lengths) {
    const auto was = before.rms_lengths.find(kind);
    fmt::format_to(out,
                   "  residuals of {}, rms: {:.3f} mm before, {:.3f} mm after ({} readings, {} degrees of freedom)\n",
                   words(kind).plural, was == before.rms_lengths.end() ? 0.0 : was->second, rms, calibration.readings,
                   calibration.degrees_of_freedom);
  }
  if (after.rms_joints) {
    fmt::format_to(out, "  joints of spare limbs disagree, rms: {:.4f} mm before, {:.4f} mm after\n",
                   before.rms_joints.value_or(0.0), *after.rms_joints);
  }
  if (calibration.distance_bias) {
    fmt::format_to(out, "  every distance reads {:+.3f} mm too long\n", *calibration.distance_bias);
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
        out, "  residuals of orientations, largest: {:.2f} deg before, {:.2f} deg after; noise {:.3f} deg per axis\n",
        to_degrees(before.max_orientation.value_or(0.0)), to_degrees(*after.max_orientation),
        to_degrees(calibration.orientation_noise.value_or(0.0)));
  }
  return text;
}

}  // namespace

std::string Calibration::brief() const {
  std::string text = fmt::format("calibration of {}: {}\n", robot.name(), paracal::name(verdict));
  const auto out = std::back_inserter(text);
  if (use) text += use_line(*use, use_mean);
  if (drive_sizes.size() > 0) text += drives_line(omitted_poses.value());
  for (const std::string& reason : reasons) fmt::format_to(out, "  because {}\n", reason);
  for (const std::string& note : notes) fmt::format_to(out, "  note: {}\n", note);
  for (const std::string& one : assumed) fmt::format_to(out, "  assumed: {}\n", one);
  text += parameter_lines(*this) + detail::undetermined_lines(null_space);
  return readings == 0 ? text : text + residual_lines(*this);
}

}  // namespace paracal
