#pragma once

// Private to io: the fields of what a calibration states of each reading and each setup.

#include <algorithm>

#include "estimate_fields.hpp"

namespace paracal::io {

inline constexpr std::string_view kExcluded = "excluded from the fit", kByCalibrated = "by the calibrated machine";
inline constexpr std::string_view kRotationBefore =
    "where a rotation was read: measured minus predicted, by the nominal machine";

template <>
struct List<DistanceResidual> {
  static constexpr Place kPlace{kCalibrationSchema, "distance_residual", "Distance residual", "Of a distance."};
  static void fields(auto&& field) {
    using Of = DistanceResidual;
    field("from", &Of::from, "a pose");
    field("to", &Of::to, "another pose");
    field("distance_mm", &Of::distance, "", Form{.refers = "common.schema.json#/$defs/distance_mm"});
    field("before_mm", &Of::distance_before, "measured minus predicted by the nominal machine");
    field("after_mm", &Of::distance_after, kByCalibrated);
    field("excluded", &Of::excluded, kExcluded);
    field("rotation_deg", &Of::rotation, "read, of to relative to from", kAngleMayLack);
    field("rotation_before_deg", &Of::rotation_before, kRotationBefore, kAngleMayLack);
    field("rotation_after_deg", &Of::rotation_after, kByCalibrated, kAngleMayLack);
  }
};

template <>
struct List<PointResidual> {
  static constexpr Place kPlace{kCalibrationSchema, "point_residual", "Point residual", "Of a point or a body."};
  static void fields(auto&& field) {
    using Of = PointResidual;
    field("series", &Of::series, "the file");
    field("pose", &Of::station, "its name");
    field("before_mm", &Of::before, "measured minus predicted by the nominal machine, in the robot's frame");
    field("after_mm", &Of::after, kByCalibrated);
    field("excluded", &Of::excluded, kExcluded);
    field("orientation_before_deg", &Of::orientation_before, "of a body: rotation vector in the robot's frame",
          kAngleMayLack);
    field("orientation_after_deg", &Of::orientation_after, kByCalibrated, kAngleMayLack);
    field("rotation_before_deg", &Of::rotation_before, kRotationBefore, kAngleMayLack);
    field("rotation_after_deg", &Of::rotation_after, kByCalibrated, kAngleMayLack);
  }
};

/// A kind's key of readings, and its structs.
template <LengthKind kKind>
struct LengthPlaces;
template <>
struct LengthPlaces<LengthKind::height> {
  static constexpr std::string_view kColumn = "height_mm";
  static constexpr Place kResidual{kCalibrationSchema, "height_residual", "Height residual"};
  static constexpr Place kSetUp{kCalibrationSchema, "plane", "Plane", "The plane below heights."};
};
template <>
struct LengthPlaces<LengthKind::ball_bar> {
  static constexpr std::string_view kColumn = "ball_bar_mm";
  static constexpr Place kResidual{kCalibrationSchema, "ball_bar_residual", "Ball bar residual"};
  static constexpr Place kSetUp{kCalibrationSchema, "ball_bar", "Ball bar", "A ball bar's fixed point."};
};
template <>
struct LengthPlaces<LengthKind::dial> {
  static constexpr std::string_view kColumn = "dial_mm";
  static constexpr Place kResidual{kCalibrationSchema, "dial_residual", "Dial residual"};
  static constexpr Place kSetUp{kCalibrationSchema, "dial", "Dial"};
};

template <LengthKind kKind>
struct LengthInFile : LengthResidual {};

template <LengthKind kKind>
struct List<LengthInFile<kKind>> {
  static constexpr Place kPlace = LengthPlaces<kKind>::kResidual;
  static void fields(auto&& field) {
    using Of = LengthInFile<kKind>;
    field("series", &Of::series, "the file");
    field("pose", &Of::station, "its name");
    field(LengthPlaces<kKind>::kColumn, &Of::length, "as read");
    field("before_mm", &Of::before, "measured minus predicted by the nominal machine");
    field("after_mm", &Of::after, kByCalibrated);
    field("excluded", &Of::excluded, kExcluded);
  }
};

using ResidualInFile = std::variant<DistanceResidual, LengthInFile<LengthKind::height>,
                                    LengthInFile<LengthKind::ball_bar>, LengthInFile<LengthKind::dial>, PointResidual>;

template <>
struct List<Suspect> {
  static constexpr Place kPlace{kCalibrationSchema, "suspect", "Suspect", "A possible outlier."};
  static void fields(auto&& field) {
    field("reading", &Suspect::text, "which");
    field("statistic", &Suspect::statistic, "F statistic of excluding it", kNotNegative);
    field("chance", &Suspect::chance,
          "p-value: probability that the worst of as many correct readings is at least as bad", kShare);
    field("excluded", &Suspect::excluded, kExcluded);
  }
};

template <>
struct List<RigidMotion> {
  static constexpr Place kPlace{kCalibrationSchema, "body_place", "Body place"};
  static void fields(auto&& field) {
    field("rotation", &RigidMotion::rotation, "rows; what carries it = rotation · body + translation");
    field("translation_mm", &RigidMotion::translation, "");
  }
};

template <>
struct List<SeriesFrame> {
  static constexpr Place kPlace{kCalibrationSchema, "frame", "Series frame", "Position of an instrument."};
  static void fields(auto&& field) {
    using Of = SeriesFrame;
    const auto rotation = [](const Of& of) { return of.frame.rotation; };
    const auto translation = [](const Of& of) { return of.frame.translation; };
    field("series", &Of::name, "the file");
    field("rotation", rotation, "rows; instrument = rotation · robot + translation");
    field("translation_mm", translation, "");
    field("rotation_zero_deg", &Of::rotation_zero, "reading = phi - zero; null: not estimated", kAngle);
    field("second_reflector_mm", &Of::second, "from the first, in the frame of what carries it; null: none");
    field("body", &Of::body, "position of a body on its mount; null: none");
  }
};

/// What was found of the setup of lengths of a kind.
template <LengthKind kKind>
struct SetUpInFile : FoundSetUp {};

template <LengthKind kKind>
struct List<SetUpInFile<kKind>> {
  static constexpr Place kPlace = LengthPlaces<kKind>::kSetUp;
  using Of = SetUpInFile<kKind>;

  /// A number that the setup's own model states under this key.
  static std::optional<double> number(const Of& of, std::string_view key) {
    const auto found = std::ranges::find(of.told, key, &std::pair<std::string_view, double>::first);
    return found == of.told.end() ? std::nullopt : std::optional(found->second);
  }
  static void fields(auto&& field) {
    const auto told = [&](std::string_view key, std::string_view meaning) {
      field(
          key, [key](const Of& of) { return number(of, key).value(); }, meaning);
    };
    field("series", &Of::name, "the file");
    if constexpr (kKind == LengthKind::height) {
      told("z_mm", "z = z_mm + slope_x x + slope_y y in the robot's frame");
      told("slope_x", "along x");
      told("slope_y", "along y");
    } else if constexpr (kKind == LengthKind::ball_bar) {
      for (const char* key : {"x_mm", "y_mm", "z_mm"}) told(key, "in the robot's frame");
      field(
          "zero_mm", [](const Of& of) { return number(of, "zero_mm"); },
          "common error of its lengths (positive: too long), with --distance-bias-mm", Form{.may_lack = true});
    } else {
      told("zero_mm", "position of its zero along its direction");
      told("direction_x", "estimated direction of measurement");
      told("direction_y", "y of that direction");
      told("direction_z", "z of that direction");
    }
  }
};

}  // namespace paracal::io
