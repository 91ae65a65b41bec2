#pragma once

// Private to io: the fields of what a calibration states of each reading and each setup.

#include <algorithm>

#include "estimate_fields.hpp"

namespace paracal::io {

inline constexpr std::string_view kExcluded = "excluded from the fit", kByCalibrated = "by the calibrated machine";
inline constexpr std::string_view kRotationBefore =
    "where a rotation was read: measured minus predicted, by the nominal machine";
inline constexpr Form kAngleMayLack{.factor = kDegrees, .may_lack = true};

template <>
struct List<DistanceResidual> : OfCalibration {
  static constexpr std::string_view kName = "distance_residual", kTitle = "Distance residual",
                                    kMeaning = "Of a distance.";
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
struct List<PointResidual> : OfCalibration {
  static constexpr std::string_view kName = "point_residual", kTitle = "Point residual",
                                    kMeaning = "Of a point or a body.";
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

/// Names of a kind's structs in the schema.
template <LengthKind kKind>
struct LengthNames;
template <>
struct LengthNames<LengthKind::height> {
  static constexpr std::string_view kResidual = "height_residual", kResidualTitle = "Height residual",
                                    kColumn = "height_mm", kSetUp = "plane", kSetUpTitle = "Plane",
                                    kMeaning = "The plane below heights.";
};
template <>
struct LengthNames<LengthKind::ball_bar> {
  static constexpr std::string_view kResidual = "ball_bar_residual", kResidualTitle = "Ball bar residual",
                                    kColumn = "ball_bar_mm", kSetUp = "ball_bar", kSetUpTitle = "Ball bar",
                                    kMeaning = "A ball bar's fixed point.";
};
template <>
struct LengthNames<LengthKind::dial> {
  static constexpr std::string_view kResidual = "dial_residual", kResidualTitle = "Dial residual", kColumn = "dial_mm",
                                    kSetUp = "dial", kSetUpTitle = "Dial", kMeaning = "";
};

template <LengthKind kKind>
struct LengthInFile : LengthResidual {};

template <LengthKind kKind>
struct List<LengthInFile<kKind>> : OfCalibration {
  static constexpr std::string_view kName = LengthNames<kKind>::kResidual, kTitle = LengthNames<kKind>::kResidualTitle,
                                    kMeaning = "";
  static void fields(auto&& field) {
    using Of = LengthInFile<kKind>;
    field("series", &Of::series, "the file");
    field("pose", &Of::station, "its name");
    field(LengthNames<kKind>::kColumn, &Of::length, "as read");
    field("before_mm", &Of::before, "measured minus predicted by the nominal machine");
    field("after_mm", &Of::after, kByCalibrated);
    field("excluded", &Of::excluded, kExcluded);
  }
};

using ResidualInFile = std::variant<DistanceResidual, LengthInFile<LengthKind::height>,
                                    LengthInFile<LengthKind::ball_bar>, LengthInFile<LengthKind::dial>, PointResidual>;

template <>
struct List<Suspect> : OfCalibration {
  static constexpr std::string_view kName = "suspect", kTitle = "Suspect", kMeaning = "A possible outlier.";
  static void fields(auto&& field) {
    field("reading", &Suspect::text, "which");
    field("statistic", &Suspect::statistic, "F statistic of excluding it", kNotNegative);
    field("chance", &Suspect::chance,
          "p-value: probability that the worst of as many correct readings is at least as bad", kShare);
    field("excluded", &Suspect::excluded, kExcluded);
  }
};

template <>
struct List<RigidMotion> : OfCalibration {
  static constexpr std::string_view kName = "body_place", kTitle = "Body place", kMeaning = "";
  static void fields(auto&& field) {
    field("rotation", &RigidMotion::rotation, "rows; what carries it = rotation · body + translation");
    field("translation_mm", &RigidMotion::translation, "");
  }
};

template <>
struct List<SeriesFrame> : OfCalibration {
  static constexpr std::string_view kName = "frame", kTitle = "Series frame", kMeaning = "Position of an instrument.";
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
struct List<SetUpInFile<kKind>> : OfCalibration {
  static constexpr std::string_view kName = LengthNames<kKind>::kSetUp, kTitle = LengthNames<kKind>::kSetUpTitle,
                                    kMeaning = LengthNames<kKind>::kMeaning;
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
