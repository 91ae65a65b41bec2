#pragma once

// Private to io: the fields of what a calibration states of the machine: parameters, uncertainty, causes.

#include "part_fields.hpp"

namespace paracal::io {

inline constexpr std::string_view kCalibrationSchema = "calibration.schema.json";

template <>
inline constexpr std::array<std::string_view, 8> kWords<Cause>{"visits", "motion",    "parts", "pose",
                                                               "noise",  "reflector", "drift", "backlash"};
enum class ParameterStatus : std::uint8_t { identified, prior, fixed };
template <>
inline constexpr std::array<std::string_view, 3> kWords<ParameterStatus>{"identified", "prior", "fixed"};

/// An estimate in the units of files.
struct ParameterInFile {
  ParameterEstimate estimate;
  Actuator actuator;
  ParameterStatus status;

  double in_file_unit(double value) const { return to_file_unit(unit(estimate.source, actuator), value); }
  std::optional<double> in_file_unit(const std::optional<double>& value) const {
    return value ? std::optional(in_file_unit(*value)) : std::nullopt;
  }
};

template <>
struct List<ParameterInFile> {
  static constexpr Place kPlace{kCalibrationSchema, "parameter", "Parameter", "An estimated source error."};
  using Of = ParameterInFile;
  template <auto kMember>
  static auto in_file_unit(const Of& of) {
    return of.in_file_unit(of.estimate.*kMember);
  }
  static std::optional<double> expanded(const Of& of) {
    const auto& std = of.estimate.std;
    return of.in_file_unit(std ? std::optional(of.estimate.coverage() * *std) : std::nullopt);
  }
  static std::optional<double> coverage(const Of& of) {
    return of.estimate.std ? std::optional(of.estimate.coverage()) : std::nullopt;
  }

  static void fields(auto&& field) {
    const auto source = [](const Of& of) { return name(of.estimate.source); };
    const auto limb = [](const Of& of) { return of.estimate.limb + 1; };
    const auto unit_in_file = [](const Of& of) { return file_unit(unit(of.estimate.source, of.actuator)); };
    const auto dof = [](const Of& of) { return if_finite(of.estimate.dof); };
    const auto data_share = [](const Of& of) { return of.estimate.data_share; };
    field("name", source, "", Form{.refers = "common.schema.json#/$defs/parameter_name"});
    field("limb", limb, "", Form{.refers = "common.schema.json#/$defs/limb_number"});
    field("value", &in_file_unit<&ParameterEstimate::value>, "estimate, actual - nominal");
    field("unit", unit_in_file, "", Form{.refers = "common.schema.json#/$defs/unit"});
    field("std", &in_file_unit<&ParameterEstimate::std>, "standard uncertainty; null: not available", kSize);
    field("U", &expanded, "expanded uncertainty k std, about 95 %", kSize);
    field("k", &coverage, "coverage factor from Student's t with dof degrees of freedom", kNotNegative);
    field("dof", dof, "degrees of freedom of std; null: many", kNotNegative);
    field("status", &Of::status,
          "identified: the readings give at least half of the information; prior: less, or not estimated (its "
          "tolerance counts); fixed: known exactly");
    field("prior_std", &in_file_unit<&ParameterEstimate::prior_std>,
          "standard deviation of its tolerance; null: no prior", kSize);
    field("expected", &in_file_unit<&ParameterEstimate::expected>,
          "centre of the tolerance: zero, except for printers, whose nominal robot has the dimensions of the "
          "firmware");
    field("with_drives", &in_file_unit<&ParameterEstimate::with_drives>,
          "the same error where the drives' splines belong to the machine", Form{.may_lack = true});
    field("data_share", data_share, "1 - std²/prior_std²");
  }
};

enum class Kept : std::uint8_t { yes, no };
template <>
inline constexpr std::array<std::string_view, 2> kWords<Kept>{"kept", "not kept"};

/// A quantity in mm or deg.
struct UseInFile {
  UseQuantity quantity;
  double factor = 1.0;
};

template <>
struct List<UseInFile> {
  static constexpr Place kPlace{kCalibrationSchema, "use_quantity", "Use quantity",
                                "U of one quantity anywhere in the workspace, against its limit."};
  static void fields(auto&& field) {
    const auto U = [](const UseInFile& of) { return of.quantity.U * of.factor; };
    const auto limit = [](const UseInFile& of) {
      return of.quantity.limit ? std::optional(*of.quantity.limit * of.factor) : std::nullopt;
    };
    const auto verdict = [](const UseInFile& of) {
      return of.quantity.limit ? std::optional(of.quantity.kept() ? Kept::yes : Kept::no) : std::nullopt;
    };
    field("U", U, "95 % of such machines have smaller errors everywhere in the workspace", kSize);
    field("limit", limit, "null: none was set", kNotNegative);
    field("verdict", verdict, "null: no limit was set");
  }
};

template <>
struct List<Use> {
  static constexpr Place kPlace{kCalibrationSchema, "use", "Use", "Uncertainty over the workspace."};
  static void fields(auto&& field) {
    const auto distance = [](const Use& use) { return UseInFile{use.distance}; };
    const auto aligned = [](const Use& use) { return UseInFile{use.aligned}; };
    const auto rotation = [](const Use& use) {
      return use.rotation ? std::optional(UseInFile{*use.rotation, kDegrees}) : std::nullopt;
    };
    field("distance_mm", distance, "of the distance to home");
    field("aligned_mm", aligned, "of the position after the best alignment");
    field("rotation_deg", rotation, "rotation from home; null: a plate that does not rotate");
  }
};

template <>
struct List<Component> {
  static constexpr Place kPlace{kCalibrationSchema, "component", "Cause"};
  static void fields(auto&& field) {
    field("cause", &Component::cause,
          "joints that do not repeat, joints or drives that are off, parts, a pose, the noise of "
          "an instrument, the place of a reflector, drift, or backlash");
    field("text", &Component::text, "in words");
    field("probability", &Component::probability, "after the readings", kShare);
    field("told", &Component::told, "true: the notes contain it");
  }
};

enum class JointUnit : std::uint8_t { deg, mm };
template <>
inline constexpr std::array<std::string_view, 2> kWords<JointUnit>{"deg", "mm"};

/// A spline in the unit of the joint.
struct SplineInFile {
  SoughtSource spline;
  Unit unit;
  std::optional<double> size = {};
};

template <>
struct List<SplineInFile> {
  static constexpr Place kPlace{kCalibrationSchema, "drive_spline", "Spline of a drive"};
  static void fields(auto&& field) {
    using Of = SplineInFile;
    const auto limb = [](const Of& of) { return of.spline.limb + 1; };
    const auto unit = [](const Of& of) { return of.unit == Unit::mm ? JointUnit::mm : JointUnit::deg; };
    const auto centre = [](const Of& of) { return to_file_unit(of.unit, of.spline.knot->centre); };
    const auto spacing = [](const Of& of) { return to_file_unit(of.unit, of.spline.knot->spacing); };
    field("limb", limb, "its limb", Form{.least = 1.0});
    field("unit", unit, "of the joint");
    field("centre", centre, "joint coordinate where the spline is largest (2/3)");
    const auto size = [](const Of& of) {
      return of.size ? std::optional(to_file_unit(of.unit, *of.size)) : std::nullopt;
    };
    field("spacing", spacing, "to the next one; it is 0 beyond two of them", kNotNegative);
    field("size", size, "its factor, where it belongs to the machine", Form{.may_lack = true});
  }
};

template <>
struct List<OmittedPoses> {
  static constexpr Place kPlace{kCalibrationSchema, "omitted_poses", "Omitted poses",
                                "How well readings of a pose are predicted from those of all others."};
  static void fields(auto&& field) {
    field("poses", &OmittedPoses::poses, "that were omitted, one by one", kCount);
    field("rigid_mm", &OmittedPoses::rigid, "root mean square without the splines of the drives", kSize);
    field("with_drives_mm", &OmittedPoses::with_drives, "the same with them", kSize);
  }
};

template <>
struct List<CalibratedRegion> {
  static constexpr Place kPlace{kCalibrationSchema, "region", "Region", "Where the poses of a calibration are."};
  static void fields(auto&& field) {
    field("low_mm", &CalibratedRegion::low,
          "least of u . r over the poses, r in {O}, for the unit vectors u along z, y - z, y, y + z, x - y - z, x - y, "
          "x - y + z, x - z, x, x + z, x + y - z, x + y, x + y + z");
    field("high_mm", &CalibratedRegion::high, "the largest of each");
  }
};

/// A pair of parameters by their names.
struct CorrelationInFile {
  std::string one, other;
  double value;
};

template <>
struct List<CorrelationInFile> {
  static constexpr Place kPlace{kCalibrationSchema, "correlation", "Correlation"};
  static void fields(auto&& field) {
    using Of = CorrelationInFile;
    field("one", &Of::one, "parameter name with the limb at its end: alpha01 is alpha0 of limb 1");
    field("other", &Of::other, "the same");
    field("value", &Of::value, "at least 0.9 in size");
  }
};

enum class StageDone : std::uint8_t { rough, fine };
template <>
inline constexpr std::array<std::string_view, 2> kWords<StageDone>{"rough", "fine"};

template <>
struct List<StageReport> {
  static constexpr Place kPlace{kCalibrationSchema, "stage", "Stage report"};
  static void fields(auto&& field) {
    const auto stage = [](const StageReport& of) { return of.name == "fine" ? StageDone::fine : StageDone::rough; };
    const auto condition = [](const StageReport& of) { return if_finite(of.condition); };
    field("name", stage, "of the stage");
    field("iterations", &StageReport::iterations, "of least squares", kNotNegative);
    field("converged", &StageReport::converged, "least squares converged");
    field("rank", &StageReport::rank, "rank for the estimated parameters", kCount);
    field("condition", condition,
          "largest over smallest singular value of the column-scaled Jacobian; null: the stage is not determined",
          kNotNegative);
    field("residual_rms_mm", &StageReport::rms_distance, "after it", kNotNegative);
  }
};

}  // namespace paracal::io
