#pragma once

// Private to io: the fields of a validation.

#include "paracal/calibration/validation.hpp"
#include "part_fields.hpp"

namespace paracal::io {

template <>
inline constexpr std::size_t kNames<Conformity> = 3;

inline constexpr std::string_view kValidationSchema = "validation.schema.json";

template <>
struct List<PoseCriteria> {
  static constexpr Place kPlace{kValidationSchema, "iso9283_pose", "Iso 9283 pose"};
  static void fields(auto&& field) {
    using Of = PoseCriteria;
    field("pose", &Of::pose, "its name");
    field("repeats", &Of::repeats, "visits", Form{.least = 2.0});
    field("AP_mm", &Of::AP, "positioning accuracy: from the commanded position to the barycentre of the repeats");
    field("RP_mm", &Of::RP,
          "positioning repeatability: mean distance from the barycentre and 3 standard deviations of it");
    field("AD_mm", &Of::AD, "distance accuracy: of the mean distance to home");
    field("RD_mm", &Of::RD, "distance repeatability: 3 standard deviations of that distance");
    field("AP_deg", &Of::AP_rotation, "the same of the rotation, where it was read", kAngleMayLack);
    field("RP_deg", &Of::RP_rotation, "3 standard deviations of the rotation", kAngleMayLack);
  }
};

template <>
struct List<Iso9283> {
  static constexpr Place kPlace{kValidationSchema, "iso9283", "Iso 9283",
                                "ISO 9283 of the uncompensated machine, from repeats."};
  static void fields(auto&& field) {
    field("max_AP_mm", &Iso9283::max_AP, "positioning accuracy, worst pose");
    field("max_RP_mm", &Iso9283::max_RP, "positioning repeatability, worst pose");
    field("max_AD_mm", &Iso9283::max_AD, "distance accuracy, worst pose");
    field("max_RD_mm", &Iso9283::max_RD, "distance repeatability, worst pose");
    field("poses", &Iso9283::poses, "poses read at least twice");
  }
};

template <>
struct List<LimitCheck> {
  static constexpr Place kPlace{kValidationSchema, "limit_check", "Limit check", "A limit, checked."};
  static void fields(auto&& field) {
    using Of = LimitCheck;
    field("quantity", &Of::quantity, "with its unit");
    field("error", &Of::error, "largest");
    field("U", &Of::uncertainty, "expanded uncertainty; the error is at most error + U");
    field("at_least", &Of::at_least, "lower bound of the error, from the noise of all poses together", kNotNegative);
    field("k", &Of::coverage, "coverage factor of U");
    field("limit", &Of::limit, "as set");
    field("conformity", &Of::conformity, "whether the limit is met, uncertainty included");
  }
};

/// Relative to home.
struct PoseErrorInFile {
  PoseError error;
  bool reads_rotation = false;
};

template <>
struct List<PoseErrorInFile> {
  static constexpr Place kPlace{kValidationSchema, "pose_error", "Pose error", "Error of a pose relative to home."};
  static void fields(auto&& field) {
    using Of = PoseErrorInFile;
    const auto rotation = [](const Of& of) {
      return of.reads_rotation ? std::optional(of.error.rotation) : std::nullopt;
    };
    field(
        "d_rho_mm", [](const Of& of) { return of.error.distance; }, "error of the distance to home");
    field(
        "d_v_mm", [](const Of& of) { return of.error.volumetric; }, "error of the position relative to home");
    field("d_phi_deg", rotation, "error of the rotation from home; null: not read", kAngle);
  }
};

/// A pose with the first of its series.
struct PoseInFile {
  const ValidatedPose& home;
  const ValidatedPose& pose;

  template <PosePair ValidatedPose::*kPair>
  PoseErrorInFile error() const {
    return {error_relative_to(home.*kPair, pose.*kPair), pose.rotation};
  }
  /// U of the prediction: of x, y, z, then of the rotation or of the tilts; empty without a covariance.
  std::optional<Eigen::Vector3d> position_U() const { return pose.covariance ? std::optional(U<3>(0)) : std::nullopt; }
  std::optional<double> rotation_U() const {
    return tilts() || !pose.covariance ? std::nullopt : std::optional(U<1>(3).value());
  }
  std::optional<Eigen::Vector3d> tilt_U() const { return tilts() ? std::optional(U<3>(3)) : std::nullopt; }

 private:
  bool tilts() const { return pose.covariance && pose.covariance->rows() > 4; }
  template <int kCount>
  Eigen::Vector<double, kCount> U(Eigen::Index from) const {
    return kCoverageFactor * pose.covariance->diagonal().segment<kCount>(from).cwiseSqrt();
  }
};

template <>
struct List<PoseInFile> {
  static constexpr Place kPlace{kValidationSchema, "validated_pose", "Validated pose"};
  static void fields(auto&& field) {
    using Of = PoseInFile;
    field(
        "series", [](const Of& of) { return of.pose.series; }, "the file");
    field(
        "pose", [](const Of& of) { return of.pose.pose; }, "its name");
    field("before", &Of::error<&ValidatedPose::before>, "");
    field("after", &Of::error<&ValidatedPose::after>, "");
    field("predicted_U_mm", &Of::position_U, "U of the prediction, in the robot's frame", Form{.may_lack = true});
    field("predicted_U_deg", &Of::rotation_U, "of the rotation", kAngleMayLack);
    field("predicted_U_tilt_deg", &Of::tilt_U, "of the tilts, for plates with six degrees of freedom", kAngleMayLack);
  }
};

template <>
struct List<CheckedReading> {
  static constexpr Place kPlace{kValidationSchema, "checked_reading", "Checked reading", "A distance or a length."};
  static void fields(auto&& field) {
    using Of = CheckedReading;
    field("reading", &Of::text, "which");
    field("before_mm", &Of::before, "measured minus predicted by the nominal machine");
    field("after_mm", &Of::after, "by the calibrated machine");
    field("sigma_mm", &Of::sigma, "standard deviation of the reading");
    field("U_mm", &Of::U,
          "expanded uncertainty of after_mm (k = 2), from reading and calibration, after fitting the setup");
  }
};

template <>
struct List<Agreement> {
  static constexpr Place kPlace{kValidationSchema, "agreement", "Agreement"};
  static void fields(auto&& field) {
    using Of = Agreement;
    field("chi_square", &Of::chi_square, "of the residuals, with the uncertainty of the calibration and the noise");
    field("dof", &Of::freedom, "degrees of freedom");
    field(
        "noise_dof", [](const Of& of) { return if_finite(of.noise_dof); },
        "degrees of freedom of the noise; null: it is known");
    field("chance", &Of::chance, "p-value: probability of such residuals if the stated uncertainty is correct");
    field("contradicts", &Of::contradicts, "true: p-value below 0.001");
  }
};

template <>
struct List<Validation> {
  static constexpr Place kPlace{kValidationSchema, "", "Validation", "What `validate --json` prints."};
  using Of = Validation;

  /// Each relative to the first pose of its series.
  static std::vector<PoseInFile> poses(const Of& of) {
    std::vector<PoseInFile> all;
    const ValidatedPose* home = nullptr;
    for (const ValidatedPose& one : of.poses) {
      if (!home || home->series != one.series) home = &one;
      all.push_back({*home, one});
    }
    return all;
  }

  static void fields(auto&& field) {
    field("accepted", &Of::accepted, "true: all limits are met, uncertainty included; null: no limit is set");
    field("reasons", &Of::reasons, "why it is not accepted; without a limit: what speaks against the calibration");
    field("before", &Of::before, "measured against commanded");
    field("after", &Of::after, "measured against what the calibrated model predicts");
    field("iso9283", &Of::iso9283, "");
    field("checks", &Of::checks, "one entry per limit");
    field("poses", &poses, "each relative to the first pose of its series");
    field("readings", &Of::readings, "distances and lengths");
    field("agreement", &Of::agreement,
          "whether the readings agree with the uncertainty of the calibration; null: these readings cannot check it");
    field("notes", &Of::notes, "remarks on the result");
    field("assumed", &Of::assumed, "", Form{.refers = "common.schema.json#/$defs/assumed"});
  }
};

}  // namespace paracal::io
