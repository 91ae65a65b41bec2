#pragma once

// Private to io: the fields of what several results have in common.

#include <cmath>

#include "calibration_settings.hpp"
#include "io/fields/field.hpp"
#include "io/tables/names.hpp"
#include "io/tables/readings.hpp"
#include "paracal/calibration/calibration.hpp"

namespace paracal::io {

inline std::optional<double> if_finite(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

inline constexpr std::string_view kParts = "parts.schema.json";

template <>
struct List<InputFile> {
  static constexpr Place kPlace{kParts, "input_file", "Input file", "A file that was read."};
  static void fields(auto&& field) {
    const auto title = [](const InputFile& file) { return title_of(file.name); };  // folders name users and customers
    field("file", title, "name of the file");
    field("sha256", &InputFile::sha256, "SHA-256 of its bytes", Form{.pattern = "^[0-9a-f]{64}$"});
  }
};

inline constexpr std::string_view kInputs = "files that were read, with the SHA-256 of their bytes";

template <>
struct List<NullDirection> {
  static constexpr Place kPlace{kParts, "null_direction", "Null direction",
                                "A direction of the parameters that the readings do not determine."};
  static void fields(auto&& field) {
    field("text", &NullDirection::text, "the direction in words");
    field("direction", &NullDirection::direction, "components along the estimated parameters, in their units");
  }
};

template <>
struct List<PoseErrorSummary> {
  static constexpr Place kPlace{kParts, "error_summary", "Error summary", "Residuals, the largest over all series."};

  /// Empty where lengths alone were read.
  template <double PoseErrorSummary::*kMember>
  static std::optional<double> of_distances(const PoseErrorSummary& summary) {
    return summary.reads_distances ? std::optional(summary.*kMember) : std::nullopt;
  }
  template <LengthKind kKind>
  static std::optional<double> of_lengths(const PoseErrorSummary& summary) {
    const auto rms = summary.rms_lengths.find(kKind);
    return rms == summary.rms_lengths.end() ? std::nullopt : std::optional(rms->second);
  }

  static void fields(auto&& field) {
    using Of = PoseErrorSummary;
    field("max_abs_distance_mm", &of_distances<&Of::max_abs_distance>,
          "largest error of a distance; null, as the next three, if no points and no distances were measured",
          kNotNegative);
    field("rms_distance_mm", &of_distances<&Of::rms_distance>, "root mean square of the errors of distances",
          kNotNegative);
    field("max_volumetric_mm", &of_distances<&Of::max_volumetric>, "largest error of a position relative to home",
          kNotNegative);
    field("max_volumetric_aligned_mm", &of_distances<&Of::max_volumetric_aligned>,
          "largest error of a position after the best rigid motion", kNotNegative);
    field("rms_height_mm", &of_lengths<LengthKind::height>,
          "root mean square of the errors of heights; null: not measured", kNotNegative);
    field("rms_ball_bar_mm", &of_lengths<LengthKind::ball_bar>,
          "root mean square of the errors of ball-bar lengths; null: not measured", kNotNegative);
    field("rms_dial_mm", &of_lengths<LengthKind::dial>,
          "root mean square of the errors of dial readings; null: not measured", kNotNegative);
    field("rms_joints_mm", &Of::rms_joints,
          "root mean square of the disagreement of joints, where limbs are more than degrees of freedom and "
          "joints are readings",
          kNotNegativeMayLack);
    field("max_abs_rotation_deg", &Of::max_abs_rotation, "largest error of a rotation from home; null: not measured",
          kAngleNotNegative);
    field("max_orientation_deg", &Of::max_orientation,
          "largest orientation error of a body after its setup has been fitted; null: not measured", kAngleNotNegative);
  }
};

template <>
struct List<TrackerModel> {
  static constexpr Place kPlace{kParts, "tracker_noise", "Tracker noise",
                                "Standard deviations of a laser tracker at the origin of its frame."};
  static void fields(auto&& field) {
    field("transverse_mm", &TrackerModel::transverse, "across the beam", kNotNegative);
    field("transverse_mm_per_m", &TrackerModel::transverse_per_m, "increase with the range", kNotNegative);
    field("radial_mm", &TrackerModel::radial, "along the beam", kNotNegative);
    field("radial_mm_per_m", &TrackerModel::radial_per_m, "increase with the range", kNotNegative);
  }
};

template <>
struct List<CommonError> {
  static constexpr Place kPlace{kParts, "common_error", "Common error", "An error that limbs share."};
  static void fields(auto&& field) {
    field("text", &CommonError::text, "in words");
    field("std_mm", &CommonError::std, "its standard deviation");
  }
};

/// The options of a calibration of a robot with these actuators.
struct OptionsInFile {
  const CalibrationOptions& options;
  const Limbs& limbs;
};

template <>
struct List<OptionsInFile> {
  static constexpr Place kPlace{kParts, "calibration_options", "Calibration options", "Options of a calibration."};

  /// Calls field(key, value, meaning, form) for each.
  static void values(const OptionsInFile& of, auto&& field) {
    const double joint_factor = to_file_unit(joint_unit(actuator_of(of.limbs)), 1.0);
    CalibrationSettings::list(
        of.options, joint_factor, [&](const Setting& setting, const auto& value, const auto&... /*other*/) {
          if (setting.key.empty()) return;
          const std::string_view meaning = setting.recorded.empty() ? setting.text : setting.recorded;
          field(setting.key, in_file(setting, value, of), meaning, form_of(setting, value));
        });
  }
  /// Whose types the schema describes.
  static OptionsInFile example() {
    static const CalibrationOptions kOptions;
    static const Limbs kLimbs(1);
    return {kOptions, kLimbs};
  }

 private:
  template <typename T>
  static auto in_file(const Setting& setting, const T& value, const OptionsInFile& of) {
    if constexpr (std::same_as<T, std::vector<SourceSelector>>) {
      return selectors(value);
    } else if constexpr (std::same_as<T, std::optional<Tolerances>>) {
      return value ? std::optional(to_json(*value, of.limbs)) : std::nullopt;
    } else if constexpr (std::same_as<T, double>) {
      return setting.factor == 1.0 ? value : tidy(setting.factor * value);
    } else if constexpr (std::same_as<T, std::optional<double>>) {
      return value ? std::optional(setting.factor == 1.0 ? *value : tidy(setting.factor * *value)) : std::nullopt;
    } else {
      return value;
    }
  }
  template <typename T>
  static Form form_of(const Setting& setting, const T& /*value*/) {
    Form form{.may_lack = setting.may_lack};
    if (setting.range.least >= 0.0) form.least = 0.0;
    if (setting.range.most < plausible::kFinite.most) form.most = setting.range.most;
    if (std::same_as<T, std::optional<Tolerances>>) form.refers = "common.schema.json#/$defs/half_widths";
    return form;
  }
  static std::vector<std::string> selectors(const std::vector<SourceSelector>& selected) {
    std::vector<std::string> words;
    words.reserve(selected.size());
    for (const SourceSelector& one : selected) {
      words.push_back(std::string(name(one.source)) + (one.limb ? std::to_string(*one.limb + 1) : ""));
    }
    return words;
  }
};

}  // namespace paracal::io
