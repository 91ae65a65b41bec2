#include <fmt/chrono.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "names.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"
#include "same_robot.hpp"

namespace paracal::io {
namespace {

constexpr const char* kFormat = "paracal calibration 1";

Json array(const auto& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(value);
  return json;
}

Json optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json optional_degrees(const std::optional<double>& value) { return value ? Json(to_degrees(*value)) : Json(nullptr); }

/// Factor from mm or rad to the unit of a parameter in files.
double file_factor(const ParameterEstimate& parameter, Actuator actuator) {
  return to_file_unit(unit(parameter.source, actuator), 1.0);
}

Json parameter_json(const ParameterEstimate& parameter, Actuator actuator, std::string_view status) {
  const Unit unit_inside = unit(parameter.source, actuator);
  const auto in_file_unit = [&](const std::optional<double>& value) {
    return value ? Json(to_file_unit(unit_inside, *value)) : Json(nullptr);
  };
  return {{"name", name(parameter.source)},
          {"limb", parameter.limb + 1},
          {"value", to_file_unit(unit_inside, parameter.value)},
          {"unit", file_unit(unit_inside)},
          {"std", in_file_unit(parameter.std)},
          {"U", parameter.std ? Json(to_file_unit(unit_inside, parameter.coverage() * *parameter.std)) : Json(nullptr)},
          {"k", parameter.std ? Json(parameter.coverage()) : Json(nullptr)},
          {"dof", std::isfinite(parameter.dof) ? Json(parameter.dof) : Json(nullptr)},
          {"status", status},
          {"prior_std", in_file_unit(parameter.prior_std)},
          {"expected", to_file_unit(unit_inside, parameter.expected)},
          {"data_share", parameter.data_share}};
}

/// Sought parameters first, then the sources that the fit held where they were expected.
Json parameters_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const ParameterEstimate& parameter : calibration.parameters) {
    json.push_back(
        parameter_json(parameter, calibration.robot.actuator(), parameter.identified() ? "identified" : "prior"));
  }
  const SourceErrors errors = calibration.errors();
  for (std::size_t limb = 0; limb < calibration.robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
      const auto same = [&](const ParameterEstimate& p) { return p.limb == limb && p.source == source; };
      if (std::ranges::any_of(calibration.parameters, same)) continue;
      const double value = errors(limb, source);
      const ParameterEstimate fixed{
          .limb = limb, .source = source, .value = value, .expected = value, .data_share = 0.0};
      json.push_back(parameter_json(fixed, calibration.robot.actuator(), "fixed"));
    }
  }
  return json;
}

/// A covariance of the parameters in file units: deg instead of rad.
Json covariance_json(const Calibration& calibration, const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return nullptr;
  Eigen::VectorXd factor(static_cast<Eigen::Index>(calibration.parameters.size()));
  std::ranges::transform(calibration.parameters, factor.begin(), [&](const ParameterEstimate& parameter) {
    return file_factor(parameter, calibration.robot.actuator());
  });
  return rows_json(factor.asDiagonal() * covariance * factor.asDiagonal());
}

Json correlations_json(const Calibration& calibration) {
  const auto named = [&](std::size_t k) {
    const ParameterEstimate& parameter = calibration.parameters[k];
    return fmt::format("{}{}", name(parameter.source), parameter.limb + 1);
  };
  Json json = Json::array();
  for (const Calibration::Correlation& pair : calibration.correlations()) {
    json.push_back({{"one", named(pair.one)}, {"other", named(pair.other)}, {"value", pair.value}});
  }
  return json;
}

/// {U, limit, verdict}, in mm or deg.
Json use_json(const UseQuantity& one, double unit) {
  return {{"U", one.U * unit},
          {"limit", one.limit ? Json(*one.limit * unit) : Json(nullptr)},
          {"verdict", one.limit ? Json(one.kept() ? "kept" : "not kept") : Json(nullptr)}};
}

Json use_json(const Use& use) {
  return {{"distance_mm", use_json(use.distance, 1.0)},
          {"aligned_mm", use_json(use.aligned, 1.0)},
          {"rotation_deg", use.rotation ? use_json(*use.rotation, to_degrees(1.0)) : Json(nullptr)}};
}

Json components_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const Component& one : calibration.components) {
    json.push_back({{"text", one.text}, {"drop", one.drop}, {"chance", one.chance}, {"told", one.told}});
  }
  return json;
}

Json null_space_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const NullDirection& direction : calibration.null_space) {
    json.push_back({{"text", direction.text}, {"direction", array(direction.direction)}});
  }
  return json;
}

Json stages_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const StageReport& stage : calibration.stages) {
    json.push_back({{"name", stage.name},
                    {"iterations", stage.iterations},
                    {"converged", stage.converged},
                    {"rank", stage.rank},
                    {"condition", stage.condition},
                    {"residual_rms_mm", stage.rms_distance}});
  }
  return json;
}

Json residuals_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const DistanceResidual& residual : calibration.distances) {
    json.push_back({{"from", residual.from},
                    {"to", residual.to},
                    {"distance_mm", residual.distance},
                    {"before_mm", residual.distance_before},
                    {"after_mm", residual.distance_after},
                    {"excluded", residual.excluded}});
    if (!residual.rotation) continue;
    json.back()["rotation_deg"] = optional_degrees(residual.rotation);
    json.back()["rotation_before_deg"] = optional_degrees(residual.rotation_before);
    json.back()["rotation_after_deg"] = optional_degrees(residual.rotation_after);
  }
  for (const HeightResidual& residual : calibration.heights) {
    json.push_back({{"series", residual.series},
                    {"pose", residual.station},
                    {"height_mm", residual.height},
                    {"before_mm", residual.before},
                    {"after_mm", residual.after},
                    {"excluded", residual.excluded}});
  }
  for (const PointResidual& residual : calibration.points) {
    json.push_back({{"series", residual.series},
                    {"pose", residual.station},
                    {"before_mm", array(residual.before)},
                    {"after_mm", array(residual.after)},
                    {"excluded", residual.excluded}});
    if (!residual.rotation_after) continue;
    json.back()["rotation_before_deg"] = optional_degrees(residual.rotation_before);
    json.back()["rotation_after_deg"] = optional_degrees(residual.rotation_after);
  }
  return json;
}

Json suspects_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const Suspect& one : calibration.suspects) {
    json.push_back(
        {{"reading", one.text}, {"statistic", one.statistic}, {"chance", one.chance}, {"excluded", one.excluded}});
  }
  return json;
}

Json frames_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const SeriesFrame& one : calibration.frames) {
    Json frame{{"series", one.name},
               {"rotation", rows_json(one.frame.rotation)},
               {"translation_mm", array(one.frame.translation)},
               {"rotation_zero_deg", optional_degrees(one.rotation_zero)}};
    frame["second_reflector_mm"] = one.second ? array(*one.second) : Json(nullptr);
    json.push_back(std::move(frame));
  }
  return json;
}

Json planes_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const FoundPlane& one : calibration.planes) {
    json.push_back({{"series", one.name}, {"z_mm", one.height}, {"slope_x", one.slope_x}, {"slope_y", one.slope_y}});
  }
  return json;
}

Json common_json(const std::vector<CommonError>& errors) {
  Json json = Json::array();
  for (const CommonError& error : errors) json.push_back({{"text", error.text}, {"std_mm", error.std}});
  return json;
}

Json selectors_json(const std::vector<SourceSelector>& selectors) {
  Json json = Json::array();
  for (const SourceSelector& one : selectors) {
    json.push_back(std::string(name(one.source)) + (one.limb ? std::to_string(*one.limb + 1) : ""));
  }
  return json;
}

/// One entry of a calibration's "parameters"; calls refuse(complaint) for anything else.
ParameterEstimate read_parameter(const Json& parameter, const Robot& robot, const auto& refuse) {
  const auto source = source_named(parameter.at("name").get<std::string>());
  const Json &limb = parameter.at("limb"), &value = parameter.at("value"), &unit = parameter.at("unit");
  const bool known_limb = limb.is_number_unsigned() && limb >= 1 && limb <= robot.limb_count();
  if (!source || !known_limb) {
    refuse(fmt::format("expected a source error of limbs 1 to {}, got {}", robot.limb_count(), parameter.dump()));
  }
  const std::string_view expected_unit = file_unit(*source, robot.actuator());
  if (unit != expected_unit || !value.is_number() || !std::isfinite(value.get<double>())) {
    refuse(fmt::format("expected a number in {} for {}, got {} {}", expected_unit, name(*source), value.dump(),
                       unit.dump()));
  }
  return {.limb = limb.get<std::size_t>() - 1,
          .source = *source,
          .value = from_file_unit(paracal::unit(*source, robot.actuator()), value.get<double>())};
}

Eigen::MatrixXd read_covariance(const Json& rows, const std::vector<ParameterEstimate>& parameters, Actuator actuator,
                                const auto& refuse) {
  if (rows.is_null()) return {};
  const auto n = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd covariance(n, n);
  if (rows.size() != parameters.size()) refuse(fmt::format("expected a covariance of {} rows, got {}", n, rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != rows.size()) refuse(fmt::format("expected a square covariance, row {} is not", i + 1));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          rows[i][k].get<double>() / file_factor(parameters[i], actuator) / file_factor(parameters[k], actuator);
    }
  }
  return covariance;
}

/// A file that somebody wrote by hand need not say what it is.
void require_format(const Json& json, const auto& refuse) {
  const Json format = json.value("format", Json(kFormat));
  if (format == kFormat) return;
  refuse(fmt::format("expected the format \"{}\", got {}", kFormat, format.dump()));
}

/// Of sought errors none is known exactly, and no combination of them better than that.
void require_covariance(const Eigen::MatrixXd& covariance, const char* key, const auto& refuse) {
  constexpr double kRounding = 1e-6;  // of correlations
  if (covariance.size() == 0) return;
  const Eigen::VectorXd std = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (std.array() > 0.0).select(std.cwiseInverse(), 0.0);
  const Eigen::MatrixXd correlations = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  const bool is_finite = covariance.allFinite();
  if (!is_finite || covariance.diagonal().minCoeff() < 0.0 || covariance.diagonal().maxCoeff() <= 0.0) {
    refuse(fmt::format("expected variances above 0 in {}, got others", key));
  }
  if ((correlations - correlations.transpose()).cwiseAbs().maxCoeff() > kRounding) {
    refuse(fmt::format("expected a symmetric {}, got one that is not", key));
  }
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlations).eigenvalues().minCoeff();
  const double hidden = (std.array() > 0.0).select(0.0, covariance.cwiseAbs().rowwise().maxCoeff().array()).maxCoeff();
  if (least < -kRounding || hidden > 0.0) {
    refuse(fmt::format("expected a positive semidefinite {}, got one that is not", key));
  }
}

/// Name, geometry and plate must be those that were calibrated; tolerances and workspace may change.
void require_same_robot(const Json& calibrated, const Robot& robot, const auto& refuse) {
  const std::optional<std::string> found = robot_difference(io::to_json(robot), calibrated);
  if (found) refuse(fmt::format("expected a calibration of the robot with {}", *found));
}

}  // namespace

std::string utc(std::int64_t time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(time)));
}

Json to_json(const PoseErrorSummary& summary) {
  const auto read = [&](double value) { return summary.reads_distances ? Json(value) : Json(nullptr); };
  return {{"max_abs_distance_mm", read(summary.max_abs_distance)},
          {"rms_distance_mm", read(summary.rms_distance)},
          {"max_volumetric_mm", read(summary.max_volumetric)},
          {"max_volumetric_aligned_mm", read(summary.max_volumetric_aligned)},
          {"rms_height_mm", optional(summary.rms_height)},
          {"max_abs_rotation_deg", optional_degrees(summary.max_abs_rotation)}};
}

Json to_json(const TrackerModel& tracker) {
  return {{"transverse_mm", tracker.transverse},
          {"transverse_mm_per_m", tracker.transverse_per_m},
          {"radial_mm", tracker.radial},
          {"radial_mm_per_m", tracker.radial_per_m}};
}

Json to_json(const CalibrationOptions& options, Actuator actuator) {
  Json json{{"method", options.method == Method::paper ? "paper" : "best"},
            {"stage", options.stage == Stage::rough  ? "rough"
                      : options.stage == Stage::fine ? "fine"
                                                     : "auto"},
            {"frame", options.frame == Frame::unknown ? "unknown" : "robot"},
            {"rotation", options.rotation_zero == RotationZero::unknown ? "relative" : "absolute"},
            {"reflectors", name(options.reflectors)},
            {"distance_sigma_mm", options.noise.distance},
            {"point_sigma_mm", options.noise.point},
            {"rotation_sigma_deg", tidy_degrees(options.noise.rotation)},
            {"height_sigma_mm", options.noise.height},
            {"distance_bias_sigma_mm", options.noise.distance_bias},
            {"plane_slope_sigma_rad", optional(options.plane_slope)},
            {"common", common_json(options.common)},
            {"noise_is_known", options.noise_is_known},
            {"fixed", selectors_json(options.fixed)},
            {"free", selectors_json(options.free)},
            {"exclude_outliers", options.exclude_outliers},
            {"scale_sigma_ppm", 1e6 * options.scale_std},
            {"limit_distance_mm", optional(options.limits.distance)},
            {"limit_aligned_mm", optional(options.limits.volumetric)},
            {"limit_rotation_deg", optional_degrees(options.limits.rotation)},
            {"outlier_chance", options.outlier_chance},
            {"largest_chance", options.largest_chance}};
  if (options.noise.tracker) json["tracker"] = to_json(*options.noise.tracker);
  if (options.tolerances) json["tolerances"] = to_json(*options.tolerances, actuator);
  return json;
}

Json to_json(const std::vector<InputFile>& files) {
  Json json = Json::array();
  for (const InputFile& file : files) json.push_back({{"file", file.name}, {"sha256", file.sha256}});
  return json;
}

Json to_json(const Calibration& calibration, std::int64_t time) {
  return {{"format", kFormat},
          {"program", fmt::format("paracal {}", version())},
          {"build", build()},
          {"date", utc(time)},
          {"accepted", calibration.accepted()},
          {"verdict", name(calibration.verdict)},
          {"reasons", calibration.reasons},
          {"use", calibration.use ? use_json(*calibration.use) : Json(nullptr)},
          {"notes", calibration.notes},
          {"assumed", calibration.assumed},
          {"components", components_json(calibration)},
          {"robot", to_json(calibration.robot)},
          {"parameters", parameters_json(calibration)},
          {"covariance", covariance_json(calibration, calibration.covariance)},
          {"covariance_of_noise", covariance_json(calibration, calibration.noise_covariance)},
          {"noise_dof", std::isfinite(calibration.noise_dof) ? Json(calibration.noise_dof) : Json(nullptr)},
          {calibration.robot.actuator() == Actuator::linear ? "joint_std_mm" : "joint_std_deg",
           to_file_unit(joint_unit(calibration.robot.actuator()), calibration.joint_std)},
          {"correlations", correlations_json(calibration)},
          {"coverage_factor", kCoverageFactor},
          {"rank", calibration.rank},
          {"null_space", null_space_json(calibration)},
          {"stages", stages_json(calibration)},
          {"residual_rms_mm", calibration.after.reads_distances ? Json(calibration.after.rms_distance) : Json(nullptr)},
          {"readings", calibration.readings},
          {"noise_mm", calibration.noise},
          {"degrees_of_freedom", calibration.degrees_of_freedom},
          {"unit_weight_std", optional(calibration.unit_weight_std)},
          {"fit_probability", optional(calibration.fit_probability)},
          {"chance", optional(calibration.chance)},
          {"before", to_json(calibration.before)},
          {"after", to_json(calibration.after)},
          {"residuals", residuals_json(calibration)},
          {"suspects", suspects_json(calibration)},
          {"frames", frames_json(calibration)},
          {"planes", planes_json(calibration)},
          {"distance_bias_mm", optional(calibration.distance_bias)},
          {"distance_bias_std_mm", optional(calibration.distance_bias_std)},
          {"options", to_json(calibration.options, calibration.robot.actuator())},
          {"inputs", to_json(calibration.files)}};
}

KnownErrors CalibratedMachine::known() const {
  KnownErrors known{errors, {}, covariance, noise_covariance, noise_dof, joint_std};
  if (covariance.size() == 0) return known;
  known.parameters.reserve(parameters.size());
  for (const ParameterEstimate& one : parameters) known.parameters.push_back({one.limb, one.source});
  return known;
}

CalibratedMachine read_calibration(const TextFile& file, const Robot& robot) {
  const auto refuse = [&](const std::string& complaint) { throw InputFileError(file.name, 0, complaint); };
  CalibratedMachine machine;
  try {
    const Json json = parse_json(file);
    require_format(json, refuse);
    require_same_robot(json.at("robot"), robot, [&](const std::string& complaint) {
      throw InputFileError(file.name, line_of_key(file.text, "robot"), complaint);
    });
    if (!json.at("accepted").get<bool>()) {
      refuse(fmt::format("expected an accepted calibration, got one whose verdict is: {}",
                         json.at("verdict").get<std::string>()));
    }
    for (const Json& input : json.value("inputs", Json::array())) {
      machine.inputs.push_back({input.at("file"), input.at("sha256")});
    }
    std::set<std::pair<std::size_t, Source>> seen;
    for (const Json& entry : json.at("parameters")) {
      const ParameterEstimate parameter = read_parameter(entry, robot, refuse);
      if (!seen.insert({parameter.limb, parameter.source}).second) {
        refuse(fmt::format("expected every source error once, got {} of limb {} again", name(parameter.source),
                           parameter.limb + 1));
      }
      machine.errors(parameter.limb, parameter.source) = parameter.value;
      if (entry.value("status", "") != "fixed") machine.parameters.push_back(parameter);
    }
    if (const auto complaint = implausible(robot, machine.errors)) refuse(*complaint);
    const auto covariance_named = [&](const char* key) {
      Eigen::MatrixXd covariance =
          read_covariance(json.value(key, Json()), machine.parameters, robot.actuator(), refuse);
      require_covariance(covariance, key, refuse);
      return covariance;
    };
    machine.covariance = covariance_named("covariance");
    machine.noise_covariance = covariance_named("covariance_of_noise");
    if (const Json dof = json.value("noise_dof", Json()); dof.is_number()) machine.noise_dof = dof.get<double>();
    const char* joint = robot.actuator() == Actuator::linear ? "joint_std_mm" : "joint_std_deg";
    machine.joint_std = from_file_unit(joint_unit(robot.actuator()), json.value(joint, 0.0));
  } catch (const Json::exception&) {
    refuse("expected a calibration with its robot, verdict and parameters, got JSON without one of them");
  }
  return machine;
}

}  // namespace paracal::io
