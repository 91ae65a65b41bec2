#pragma once

// Private to io: the fields of what several results have in common.

#include <cmath>

#include "io/fields/field.hpp"
#include "io/tables/names.hpp"
#include "io/tables/readings.hpp"
#include "paracal/calibration/calibration.hpp"

namespace paracal::io {

template <>
inline constexpr std::array<std::string_view, 2> kWords<Method>{"paper", "best"};
template <>
inline constexpr std::array<std::string_view, 3> kWords<Stage>{"rough", "fine", "auto"};
template <>
inline constexpr std::array<std::string_view, 2> kWords<Frame>{"unknown", "robot"};
template <>
inline constexpr std::array<std::string_view, 2> kWords<BodyPlace>{"unknown", "plate"};
template <>
inline constexpr std::array<std::string_view, 2> kWords<RotationZero>{"relative", "absolute"};
template <>
inline constexpr std::size_t kNames<ReflectorMount> = 3;

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
  const Geometry& geometry;
};

template <>
struct List<OptionsInFile> {
  static constexpr Place kPlace{kParts, "calibration_options", "Calibration options", "Options of a calibration."};
  using Of = OptionsInFile;

  static std::vector<std::string> selectors(const std::vector<SourceSelector>& selected) {
    std::vector<std::string> words;
    words.reserve(selected.size());
    for (const SourceSelector& one : selected) {
      words.push_back(std::string(name(one.source)) + (one.limb ? std::to_string(*one.limb + 1) : ""));
    }
    return words;
  }
  static std::optional<double> joint_sigma(const Of& of) {
    const double sigma = of.options.noise.joint;
    return sigma > 0.0 ? std::optional(tidy(to_file_unit(joint_unit(of.geometry.actuator), sigma))) : std::nullopt;
  }
  static std::optional<Json> tolerances(const Of& of) {
    return of.options.tolerances ? std::optional(to_json(*of.options.tolerances, of.geometry)) : std::nullopt;
  }

 private:
  template <auto kMember>
  static auto option(const Of& of) {
    return of.options.*kMember;
  }
  template <auto kMember>
  static auto noise(const Of& of) {
    return of.options.noise.*kMember;
  }
  template <auto kMember>
  static auto limit(const Of& of) {
    return of.options.limits.*kMember;
  }

  static void choices(auto&& field) {
    using Options = CalibrationOptions;
    field("method", &option<&Options::method>, "best: weighted, with priors; paper: as published [huang2016]");
    field("stage", &option<&Options::stage>, "stage as requested");
    field("frame", &option<&Options::frame>, "whether the instrument's frame is estimated or known");
    field("body", &option<&Options::body>, "where the measured body is mounted");
    field("rotation", &option<&Options::rotation_zero>, "whether the zero of phi is estimated");
    field("reflectors", &option<&Options::reflectors>, "what carries the reflectors; reversed: rotated by -phi");
  }
  static void sigmas(auto&& field) {
    const auto rotation = [](const Of& of) { return tidy_degrees(of.options.noise.rotation); };
    field("distance_sigma_mm", &noise<&NoiseModel::distance>, "standard deviation of a distance", kNotNegative);
    field("point_sigma_mm", &noise<&NoiseModel::point>, "of each coordinate of a point", kNotNegative);
    field("body_sigma_mm", &noise<&NoiseModel::body>, "of each coordinate of a body's origin", kNotNegative);
    field("rotation_sigma_deg", rotation, "of a rotation", kNotNegative);
    field("height_sigma_mm", &noise<&NoiseModel::height>, "standard deviation of a length measured at one pose",
          kNotNegative);
    field("distance_bias_sigma_mm", &noise<&NoiseModel::distance_bias>,
          "standard deviation of a common offset of all distances; 0: not estimated", kNotNegative);
    field("dial_angle_sigma_deg", &noise<&NoiseModel::dial_angle>,
          "standard deviation of a dial's direction; null: not stated, 0.5", kAngleNotNegative);
    field("plane_slope_sigma_rad", &option<&CalibrationOptions::plane_slope>,
          "standard deviation of the slopes of a plane; null: not stated", kNotNegative);
    field("plane_curvature_sigma_per_mm", &option<&CalibrationOptions::plane_curvature>,
          "standard deviation of the curvature of the surface below the heights; null: a plane", kNotNegative);
  }
  static void rest(auto&& field) {
    using Options = CalibrationOptions;
    const auto fixed = [](const Of& of) { return selectors(of.options.fixed); };
    const auto free = [](const Of& of) { return selectors(of.options.free); };
    const auto scale = [](const Of& of) { return 1e6 * of.options.scale_std; };
    field("common", &option<&Options::common>, "errors that limbs share");
    field("noise_is_known", &option<&Options::noise_is_known>,
          "the standard deviations are known and are not estimated");
    field("fixed", fixed, "geometric errors fixed at zero, of one limb or of all");
    field("free", free, "geometric errors estimated without a prior");
    field("exclude_outliers", &option<&Options::exclude_outliers>, "outliers are excluded from the fit");
    field("scale_sigma_ppm", scale, "standard deviation of the instrument's scale", kNotNegative);
    field("limit_distance_mm", &limit<&AcceptanceLimits::distance>,
          "limit of distances to home; null, as in the next two: none stated", kNotNegative);
    field("limit_aligned_mm", &limit<&AcceptanceLimits::volumetric>, "limit of the position after the best alignment",
          kNotNegative);
    field("limit_rotation_deg", &limit<&AcceptanceLimits::rotation>, "limit of the rotation from home",
          kAngleNotNegative);
    field("outlier_chance", &option<&Options::outlier_chance>, "p-value below which the worst reading is an outlier",
          kShare);
    field("largest_chance", &option<&Options::largest_chance>, "largest accepted p-value of the improvement", kShare);
    field("joint_sigma", &joint_sigma,
          "standard deviation of a joint in its unit (deg for arms, mm for rails and struts), where joints are "
          "readings",
          kNotNegativeMayLack);
    field("tracker", &noise<&NoiseModel::tracker>, "", Form{.may_lack = true});
    field("tolerances", &tolerances, "tolerances, if not the robot's",
          Form{.refers = "common.schema.json#/$defs/half_widths", .may_lack = true});
  }

 public:
  static void fields(auto&& field) {
    choices(field);
    sigmas(field);
    rest(field);
  }
};

}  // namespace paracal::io
