#pragma once

// Private to io: the fields of a calibration.

#include <fmt/format.h>

#include <algorithm>

#include "estimate_fields.hpp"
#include "paracal/version.hpp"
#include "residual_fields.hpp"

namespace paracal::io {

template <>
inline constexpr std::size_t kNames<Verdict> = 4;
template <>
inline constexpr std::size_t kNames<ControllerEvidence> = 4;

template <>
struct List<ControllerModel> {
  static constexpr Place kPlace{
      kCalibrationSchema, "controller", "Commanding controller",
      "The controller that computed the joints of the commanded poses, as far as it is known."};
  static void fields(auto&& field) {
    using Of = ControllerModel;
    const auto source = [](const Of& of) { return of.source.empty() ? std::nullopt : std::optional(of.source); };
    const auto robot = [](const Of& of) { return of.robot ? std::optional(to_json(*of.robot)) : std::nullopt; };
    field("joints", &Of::evidence,
          "source of its dimensions: assumed, from readings with joints, from displayed joints, or stated");
    field("source", source, "file that confirmed or stated them");
    field("robot", robot, "the robot whose dimensions it uses; null: the nominal robot",
          Form{.refers = "robot.schema.json"});
  }
};

/// A calibration and the time of its file, seconds since 1970.
struct CalibrationInFile {
  const Calibration& of;
  std::int64_t time = 0;

  /// Sought parameters first, then the sources that the fit held where they were expected.
  std::vector<ParameterInFile> parameters() const;
  std::vector<CorrelationInFile> correlations() const;
  std::vector<SplineInFile> splines() const;
  std::vector<ResidualInFile> residuals() const;
  /// Of the parameters, or of the splines with all of them, in deg instead of rad.
  std::optional<Eigen::MatrixXd> in_file_units(const Eigen::MatrixXd& covariance) const;
  /// Empty where joints have the other unit.
  std::optional<Eigen::VectorXd> joints_in(Unit joint, const Eigen::VectorXd& std) const;

  template <LengthKind kKind>
  std::vector<SetUpInFile<kKind>> set_ups() const {
    std::vector<SetUpInFile<kKind>> found;
    for (const FoundSetUp& one : of.set_ups) {
      if (one.kind == kKind) found.push_back({one});
    }
    return found;
  }
};

template <>
struct List<CalibrationInFile> {
  static constexpr Place kPlace{kCalibrationSchema, "", "Calibration",
                                "What `calibrate --json` prints and `--out` saves. Angles are in deg."};
  using Of = CalibrationInFile;

  /// Keys that stand for each other.
  static Json one_of() {
    return {{{"required", {"joint_std_deg", "visit_std_deg"}}}, {{"required", {"joint_std_mm", "visit_std_mm"}}}};
  }

 private:
  template <auto kMember>
  static const auto& member(const Of& in_file) {
    return in_file.of.*kMember;
  }
  template <auto kMember>
  static auto covariance(const Of& in_file) {
    return in_file.in_file_units(in_file.of.*kMember);
  }
  template <Unit kUnit, auto kMember>
  static auto joints(const Of& in_file) {
    return in_file.joints_in(kUnit, in_file.of.*kMember);
  }

  static void of_file(auto&& field) {
    const auto format = [](const Of&) { return kCalibrationFormat; };
    const auto program = [](const Of&) { return fmt::format("paracal {}", version()); };
    const auto built = [](const Of&) { return build(); };
    const auto date = [](const Of& in_file) { return utc(in_file.time); };
    field("format", format, "of the file", Form{.only = kCalibrationFormat});
    field("program", program, "", Form{.refers = "common.schema.json#/$defs/program"});
    field("build", built, "", Form{.refers = "common.schema.json#/$defs/build"});
    field("date", date, "", Form{.refers = "common.schema.json#/$defs/date"});
  }

  static void of_verdict(auto&& field) {
    const auto accepted = [](const Of& in_file) { return in_file.of.accepted(); };
    field("accepted", accepted, "true: the calibration meets all criteria");
    field("verdict", &member<&Calibration::verdict>, "one word");
    field("reasons", &member<&Calibration::reasons>, "why it is not accepted; input mistakes first");
    field("use", &member<&Calibration::use>, "of any single visit of a pose; null: no covariance is available");
    field("use_mean", &member<&Calibration::use_mean>, "the same of the mean of many visits");
    field("notes", &member<&Calibration::notes>, "remarks on the result");
    field("assumed", &member<&Calibration::assumed>, "", Form{.refers = "common.schema.json#/$defs/assumed"});
    field("components", &member<&Calibration::components>,
          "causes of what noise, tolerances and geometry do not explain, most probable first; no uncertainty "
          "depends on them");
  }

  static void of_machine(auto&& field) {
    const auto robot = [](const Of& in_file) { return to_json(in_file.of.robot); };
    const auto controller = [](const Of& in_file) { return in_file.of.options.controller; };
    const auto noise_dof = [](const Of& in_file) { return if_finite(in_file.of.noise_dof); };
    field("robot", robot, "the nominal robot", Form{.refers = "robot.schema.json"});
    field("controller", controller, "");
    field("parameters", &Of::parameters, "estimated parameters first");
    const auto identified = [](const Of& in_file) {
      return std::ranges::count_if(in_file.of.parameters, &ParameterEstimate::identified);
    };
    field("identified", identified, "number of parameters with at least half of their information from the readings",
          kCount);
    field("covariance", &covariance<&Calibration::covariance>,
          "covariance of the parameters that are not fixed, in their order and units; null: not available");
    field("covariance_of_noise", &covariance<&Calibration::noise_covariance>,
          "the part of the covariance that comes from the noise of the readings");
    field("noise_dof", noise_dof, "degrees of freedom of this noise; null: it is known");
    field("joint_std_deg", &joints<Unit::rad, &Calibration::joint_std>,
          "standard deviation of what each joint is off at each pose, the same at each visit; empty: not "
          "estimated",
          kNotNegativeMayLack);
    field("joint_std_mm", &joints<Unit::mm, &Calibration::joint_std>, "the same of linear actuators",
          kNotNegativeMayLack);
    field("visit_std_deg", &joints<Unit::rad, &Calibration::visit_std>,
          "standard deviation of what each joint is off anew at each visit: repeatability", kNotNegativeMayLack);
    field("visit_std_mm", &joints<Unit::mm, &Calibration::visit_std>, "the same of linear actuators",
          kNotNegativeMayLack);
    const auto uses_drives = [](const Of& in_file) { return in_file.of.drive_sizes.size() > 0; };
    field("uses_drives", uses_drives,
          "true: the splines of the drives belong to the machine, with their sizes and the errors `with_drives`; "
          "`value` is of a rigid machine");
    field("omitted_poses", &member<&Calibration::omitted_poses>,
          "by which that was decided; null: too little for it, or drives without visible errors");
    field("drives", &Of::splines, "cubic B-splines along each joint: how its drive may be uneven");
    field("drive_covariance", &covariance<&Calibration::drive_covariance>,
          "a row for each spline: mean squares with the parameters that are not fixed, then with the splines, in "
          "their units; null: not available");
    field("correlations", &Of::correlations, "pairs, strongest first");
  }

  static void of_fit(auto&& field) {
    const auto coverage = [](const Of&) { return kCoverageFactor; };
    const auto rms = [](const Of& in_file) {
      const PoseErrorSummary& after = in_file.of.after;
      return after.reads_distances ? std::optional(after.rms_distance) : std::nullopt;
    };
    field("coverage_factor", coverage, "2: k where a standard deviation is known", Form{.least = 1.0, .most = 1000.0});
    field("rank", &member<&Calibration::rank>, "how many parameters the readings determine", kCount);
    field("null_space", &member<&Calibration::null_space>, "directions that these measurements do not determine");
    field("stages", &member<&Calibration::stages>, "rough, then fine if the readings determine enough");
    field("residual_rms_mm", rms,
          "of the distances to home (points) or of the distances read, after calibration; null: neither was read",
          kSize);
    field("readings", &member<&Calibration::readings>, "number of readings; more than 20,000 are not listed one by one",
          kCount);
    const auto region = [](const Of& in_file) {
      const CalibratedRegion& known = in_file.of.region;
      return known.is_known() ? std::optional(known) : std::nullopt;
    };
    field("region", region, "of the poses whose readings count; null: there are none");
    field("noise_mm", &member<&Calibration::noise>,
          "standard deviation of a coordinate (of a distance where no points were read), root mean square over "
          "the readings",
          kSize);
    field("orientation_noise_deg", &member<&Calibration::orientation_noise>,
          "standard deviation of a body's orientation about each axis; null: none was read",
          Form{.factor = kDegrees, .least = 0.0, .most = kLargest});
    field("degrees_of_freedom", &member<&Calibration::degrees_of_freedom>, "redundancy of the readings", kCount);
    field("unit_weight_std", &member<&Calibration::unit_weight_std>,
          "ratio of the scatter of the residuals to the assumed noise", kSize);
    field("fit_probability", &member<&Calibration::fit_probability>,
          "p-value: probability that correct readings scatter more than these; null: not all sigmas are known", kShare);
    field("chance", &member<&Calibration::chance>, "probability that noise alone improves the fit this much", kShare);
  }

  static void of_readings(auto&& field) {
    const auto options = [](const Of& in_file) { return OptionsInFile{in_file.of.options, in_file.of.robot.limbs()}; };
    const auto printer = [](const Of&) { return std::optional<Json>(); };  // the command adds it
    field("before", &member<&Calibration::before>, "against the nominal machine");
    field("after", &member<&Calibration::after>, "against the calibrated machine");
    field("residuals", &Of::residuals, "one entry per reading", Form{.title = "Residual"});
    field("suspects", &member<&Calibration::suspects>, "worst first");
    field("frames", &member<&Calibration::frames>, "one entry per series");
    field("planes", &Of::set_ups<LengthKind::height>, "one entry per plane below heights");
    field("ball_bars", &Of::set_ups<LengthKind::ball_bar>, "one entry per fixed point");
    field("dials", &Of::set_ups<LengthKind::dial>, "one entry per dial");
    field("distance_bias_mm", &member<&Calibration::distance_bias>,
          "common error of all distances (positive: read too long); null: not estimated");
    field("distance_bias_std_mm", &member<&Calibration::distance_bias_std>, "its standard uncertainty", kSize);
    field("options", options, "");
    field("inputs", &member<&Calibration::files>, kInputs);
    field("printer", printer, "only from `calibrate --printer`",
          Form{.refers = "printer.schema.json", .may_lack = true});
  }

 public:
  static void fields(auto&& field) {
    of_file(field);
    of_verdict(field);
    of_machine(field);
    of_fit(field);
    of_readings(field);
  }
};

}  // namespace paracal::io
