#pragma once

// Private: the settings of calibrations and validations. Each is written here alone: the command line, Python's
// keywords, the options that a calibration records, and their schema come from these lists.

#include <span>

#include "io/fields/setting.hpp"
#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/mechanism/option_limits.hpp"
#include "paracal/units.hpp"

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

/// A tracker's noise from um, um/m, um, um/m: transverse and radial, each constant and per m.
/// @throws InvalidArgument, without the name of the setting, for a noise at 1 m that no instrument has.
TrackerModel tracker_of_um(std::span<const double> um);

// Each list: list(options, joint_factor, setting). The joint factor leads from rad or mm of a joint to the unit of
// files.

/// Noise of readings that state none.
struct NoiseSettings {
  static constexpr std::string_view kHeading = "Uncertainty of the instrument";

  static void list(auto& options, double /*joint_factor*/, auto&& setting) {
    auto& noise = options.noise;
    constexpr plausible::Range kNoise = plausible::kNoise, kStd = option_limits::kStd;
    setting(Setting{.option = "sigma-mm",
                    .text = "standard deviation of coordinates, distances and lengths without a stated sigma",
                    .heading = kHeading,
                    .default_text = "points 0.017, bodies 0.3, others 0.05",
                    .range = kNoise},
            noise.distance, noise.point, noise.body);
    setting(Setting{.key = "distance_sigma_mm", .text = "standard deviation of a distance", .range = kStd},
            noise.distance);
    setting(Setting{.key = "point_sigma_mm", .text = "of each coordinate of a point", .range = kStd}, noise.point);
    setting(Setting{.key = "body_sigma_mm", .text = "of each coordinate of a body's origin", .range = kStd},
            noise.body);
    setting(Setting{.option = "height-sigma-mm",
                    .key = "height_sigma_mm",
                    .text = "standard deviation of heights and dial readings without a stated sigma",
                    .heading = kHeading,
                    .default_text = "0.05",
                    .range = kNoise},
            noise.height);
    setting(Setting{.option = "dial-angle-deg",
                    .key = "dial_angle_sigma_deg",
                    .text = "standard deviation of the direction of a dial gauge",
                    .heading = kHeading,
                    .default_text = "0.5 deg, assumed",
                    .range = option_limits::kDialAngleDeg,
                    .factor = to_degrees(1.0),
                    .is_angle = true},
            noise.dial_angle);
    setting(Setting{.option = "sigma-deg",
                    .key = "rotation_sigma_deg",
                    .text = "standard deviation of rotations and orientations without a stated sigma",
                    .heading = kHeading,
                    .default_text = "0.3 deg",
                    .range = kNoise,
                    .factor = to_degrees(1.0),
                    .is_angle = true},
            noise.rotation);
    setting(
        Setting{.option = "tracker-um",
                .key = "tracker",
                .text = "laser tracker at the origin of its frame, instead of a sigma of points: standard deviation "
                        "transverse and radial, each constant and per m, such as 15,6,10,0.3",
                .heading = kHeading,
                .takes = "UM,UM/M,UM,UM/M",
                .range = kStd,
                .may_lack = true},
        noise.tracker);
  }
};

/// Frames in which points and bodies are read.
struct FrameSettings {
  static constexpr std::string_view kHeading = "Frames";

  static void list(auto& options, double /*joint_factor*/, auto&& setting) {
    setting(Setting{.option = "frame",
                    .key = "frame",
                    .text = "frame of the measured points: the robot's, or unknown and fitted",
                    .heading = kHeading},
            options.frame);
    setting(Setting{.option = "body",
                    .key = "body",
                    .text = "mounting of the measured body: in the plate's frame, or unknown and fitted",
                    .heading = kHeading},
            options.body);
  }
};

/// How the instrument reads, beside its noise.
struct ReadingSettings {
  static void list(auto& options, double /*joint_factor*/, auto&& setting) {
    setting(
        Setting{.option = "distance-bias-mm",
                .key = "distance_bias_sigma_mm",
                .text = "standard deviation of an error that all distances or all ball bar lengths share, such as a "
                        "zero error; 0: none",
                .heading = NoiseSettings::kHeading,
                .range = option_limits::kStd},
        options.noise.distance_bias);
    setting(Setting{.option = "scale-ppm",
                    .key = "scale_sigma_ppm",
                    .text = "standard deviation of the scale of the readings relative to the machine (1 K of steel: "
                            "11.5)",
                    .heading = NoiseSettings::kHeading,
                    .range = option_limits::kScalePpm,
                    .factor = 1e6},
            options.scale_std);
    setting(Setting{.option = "rotation",
                    .key = "rotation",
                    .text = "zero of the measured rotations: unknown and fitted (relative), or the robot's (absolute)",
                    .heading = FrameSettings::kHeading},
            options.rotation_zero);
    setting(Setting{.option = "reflectors",
                    .key = "reflectors",
                    .text = "where the second reflector or the measured body is mounted; reversed: it turns by -phi",
                    .heading = FrameSettings::kHeading},
            options.reflectors);
  }
};

struct LimitSettings {
  static constexpr std::string_view kHeading = "Limits";

  static void list(auto& options, double /*joint_factor*/, auto&& setting) {
    setting(Setting{.option = "limit-mm",
                    .key = "limit_distance_mm",
                    .text = "largest allowed distance error",
                    .heading = kHeading,
                    .range = plausible::kLimit},
            options.limits.distance);
    setting(Setting{.option = "limit-aligned-mm",
                    .key = "limit_aligned_mm",
                    .text = "largest allowed position error after the best alignment of both frames",
                    .heading = kHeading,
                    .range = plausible::kLimit},
            options.limits.volumetric);
    setting(Setting{.option = "limit-deg",
                    .key = "limit_rotation_deg",
                    .text = "largest allowed rotation error",
                    .heading = kHeading,
                    .range = plausible::kLimitDeg,
                    .factor = to_degrees(1.0),
                    .is_angle = true},
            options.limits.rotation);
  }
};

/// What a calibration estimates, and how.
struct FitSettings {
  static constexpr std::string_view kHeading = "Fit";

  static void list(auto& options, double joint_factor, auto&& setting) {
    setting(Setting{.option = "joint-sigma",
                    .key = "joint_sigma",
                    .text = "standard deviation of each joint of the readings, in their unit, of a robot with more "
                            "limbs than degrees of freedom: its joints are readings, too; 0: they only say where the "
                            "plate is",
                    .heading = NoiseSettings::kHeading,
                    .range = option_limits::kStd,
                    .factor = joint_factor,
                    .is_angle = true,
                    .may_lack = true},
            options.noise.joint);
    setting(Setting{.option = "stage",
                    .key = "stage",
                    .text = "rough: encoder offsets only; fine: all errors; auto: as much as the measurements support",
                    .heading = kHeading},
            options.stage);
    setting(Setting{.option = "method",
                    .key = "method",
                    .text = "best: exact model with priors and full covariance; paper: Eqs. 19 and 21 of Huang et al. "
                            "(2016)",
                    .heading = kHeading},
            options.method);
    setting(Setting{.option = "tolerances",
                    .key = "tolerances",
                    .text = "tolerances used as priors",
                    .heading = kHeading,
                    .takes = "FILE",
                    .default_text = "the robot's",
                    .may_lack = true},
            options.tolerances);
    setting(Setting{.option = "fix",
                    .key = "fixed",
                    .text = "errors fixed at zero, of one limb or of all, such as alpha0,e_x2",
                    .heading = kHeading,
                    .keyword = "fixed",
                    .takes = "NAME,..."},
            options.fixed);
    setting(Setting{.option = "free",
                    .key = "free",
                    .text = "errors estimated without a prior",
                    .heading = kHeading,
                    .takes = "NAME,..."},
            options.free);
    setting(Setting{.option = "sigma-known",
                    .key = "noise_is_known",
                    .text = "the standard deviations of readings are known: do not correct them by the residuals",
                    .heading = kHeading},
            options.noise_is_known);
    setting(Setting{.option = "keep-outliers",
                    .key = "exclude_outliers",
                    .text = "report outliers, but do not exclude them",
                    .recorded = "outliers are excluded from the fit",
                    .heading = kHeading,
                    .flag_sets = false},
            options.exclude_outliers);
    setting(Setting{.option = "outlier-chance",
                    .key = "outlier_chance",
                    .text = "p-value below which the worst reading is an outlier; 0: none is",
                    .heading = kHeading,
                    .range = {0.0, 1.0}},
            options.outlier_chance);
  }
  /// What only callers of the library and other commands set.
  static void recorded(auto& options, auto&& setting) {
    setting(
        Setting{.key = "largest_chance", .text = "largest accepted p-value of the improvement", .range = {0.0, 1.0}},
        options.largest_chance);
    setting(Setting{.key = "plane_slope_sigma_rad",
                    .text = "standard deviation of the slopes of a plane; null: not stated",
                    .range = {0.0, plausible::kFinite.most}},
            options.plane_slope);
    setting(Setting{.key = "plane_curvature_sigma_per_mm",
                    .text = "standard deviation of the curvature of the surface below the heights; null: a plane",
                    .range = {0.0, plausible::kFinite.most}},
            options.plane_curvature);
    setting(Setting{.key = "common", .text = "errors that limbs share"}, options.common);
  }
};

/// What calibrate and validate both ask for.
struct CommonSettings {
  static void list(auto& options, double joint_factor, auto&& setting) {
    NoiseSettings::list(options, joint_factor, setting);
    ReadingSettings::list(options, joint_factor, setting);
    FrameSettings::list(options, joint_factor, setting);
    LimitSettings::list(options, joint_factor, setting);
  }
};

/// All settings of calibrate.
struct CalibrationSettings {
  static void list(auto& options, double joint_factor, auto&& setting) {
    CommonSettings::list(options, joint_factor, setting);
    FitSettings::list(options, joint_factor, setting);
    FitSettings::recorded(options, setting);
  }
};

/// All settings of validate.
struct ValidationSettings {
  static void list(auto& options, double joint_factor, auto&& setting) {
    CommonSettings::list(options, joint_factor, setting);
    setting(Setting{.option = "sigma-known",
                    .text = "the given standard deviations are known, as the program takes them if they are given",
                    .set_by = SetBy::python},
            options.noise_is_known);
  }
};

/// Settings of plans: of identifiability, and of the choice of poses.
struct PlanSettings {
  static void list(auto& options, double joint_factor, auto&& setting) {
    FrameSettings::list(options, joint_factor, setting);
    NoiseSettings::list(options, joint_factor, setting);
  }
};

}  // namespace paracal::io
