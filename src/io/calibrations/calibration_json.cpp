#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/tables/names.hpp"
#include "io/tables/readings.hpp"
#include "json_parts.hpp"
#include "paracal/io/json.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

namespace paracal::io {
namespace {

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
  Json json = json_array(calibration.parameters, [&](const ParameterEstimate& one) {
    return parameter_json(one, calibration.robot.actuator(), one.identified() ? "identified" : "prior");
  });
  const SourceErrors errors = calibration.errors();
  for (std::size_t limb = 0; limb < calibration.robot.limb_count(); ++limb) {
    for (const Source source : sources_of(calibration.robot.nominal().limbs[limb].actuator)) {
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

/// Factors to file units of the parameters, then of the splines of drives.
Eigen::VectorXd file_factors(const Calibration& calibration) {
  std::vector<double> factors;
  const Actuator actuator = calibration.robot.actuator();
  for (const ParameterEstimate& one : calibration.parameters) factors.push_back(file_factor(one.source, actuator));
  for (const SoughtSource& one : calibration.drives) factors.push_back(file_factor(one.source, actuator));
  return Eigen::Map<const Eigen::VectorXd>(factors.data(), std::ssize(factors));
}

/// A covariance of the first or the last of them in file units: deg instead of rad.
Json covariance_json(const Calibration& calibration, const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return nullptr;
  const Eigen::VectorXd factors = file_factors(calibration);
  const bool of_drives = covariance.cols() > std::ssize(calibration.parameters);
  const Eigen::VectorXd rows = of_drives ? factors.tail(covariance.rows()) : factors.head(covariance.rows());
  return rows_json(rows.asDiagonal() * covariance * factors.head(covariance.cols()).asDiagonal());
}

Json spline_json(const SoughtSource& one, Unit unit) {
  return {{"limb", one.limb + 1},
          {"unit", file_unit(unit)},
          {"centre", to_file_unit(unit, one.knot->centre)},
          {"spacing", to_file_unit(unit, one.knot->spacing)}};
}

/// Standard deviations of the joints, by joint.
Json joints_json(const Eigen::VectorXd& std, Unit unit) {
  return json_array(Eigen::VectorXd(std * to_file_unit(unit, 1.0)));
}

Json correlations_json(const Calibration& calibration) {
  const auto named = [&](std::size_t k) {
    const ParameterEstimate& parameter = calibration.parameters[k];
    return fmt::format("{}{}", name(parameter.source), parameter.limb + 1);
  };
  return json_array(calibration.correlations(), [&](const Calibration::Correlation& pair) {
    return Json{{"one", named(pair.one)}, {"other", named(pair.other)}, {"value", pair.value}};
  });
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

const char* name_of(Cause cause) {
  switch (cause) {
    case Cause::visits:
      return "visits";
    case Cause::motion:
      return "motion";
    case Cause::parts:
      return "parts";
    case Cause::pose:
      return "pose";
    case Cause::noise:
      return "noise";
  }
  return "";
}

Json component_json(const Component& one) {
  return {{"cause", name_of(one.cause)}, {"text", one.text}, {"probability", one.probability}, {"told", one.told}};
}

Json direction_json(const NullDirection& direction) {
  return {{"text", direction.text}, {"direction", json_array(direction.direction)}};
}

Json stage_json(const StageReport& stage) {
  return {{"name", stage.name}, {"iterations", stage.iterations}, {"converged", stage.converged},
          {"rank", stage.rank}, {"condition", stage.condition},   {"residual_rms_mm", stage.rms_distance}};
}

Json degrees_json(const Eigen::Vector3d& radians) { return json_array(Eigen::Vector3d(radians * to_degrees(1.0))); }

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
  for (const LengthResidual& residual : calibration.lengths) {
    json.push_back({{"series", residual.series},
                    {"pose", residual.station},
                    {std::string(words(residual.kind).column), residual.length},
                    {"before_mm", residual.before},
                    {"after_mm", residual.after},
                    {"excluded", residual.excluded}});
  }
  for (const PointResidual& residual : calibration.points) {
    json.push_back({{"series", residual.series},
                    {"pose", residual.station},
                    {"before_mm", json_array(residual.before)},
                    {"after_mm", json_array(residual.after)},
                    {"excluded", residual.excluded}});
    if (residual.orientation_after) {
      json.back()["orientation_before_deg"] = degrees_json(*residual.orientation_before);
      json.back()["orientation_after_deg"] = degrees_json(*residual.orientation_after);
    }
    if (!residual.rotation_after) continue;
    json.back()["rotation_before_deg"] = optional_degrees(residual.rotation_before);
    json.back()["rotation_after_deg"] = optional_degrees(residual.rotation_after);
  }
  return json;
}

Json suspect_json(const Suspect& one) {
  return {{"reading", one.text}, {"statistic", one.statistic}, {"chance", one.chance}, {"excluded", one.excluded}};
}

Json motion_json(const RigidMotion& motion) {
  return {{"rotation", rows_json(motion.rotation)}, {"translation_mm", json_array(motion.translation)}};
}

Json frame_json(const SeriesFrame& one) {
  Json frame{{"series", one.name}};
  frame.update(motion_json(one.frame));
  frame["rotation_zero_deg"] = optional_degrees(one.rotation_zero);
  frame["second_reflector_mm"] = one.second ? json_array(*one.second) : Json(nullptr);
  frame["body"] = one.body ? motion_json(*one.body) : Json(nullptr);
  return frame;
}

/// What was found of the set-ups of lengths, a list a kind.
void add_set_ups(const Calibration& calibration, Json& json) {
  for (const LengthWords& kind : length_kinds()) {
    Json& list = json[std::string(kind.set_ups)] = Json::array();
    for (const FoundSetUp& one : calibration.set_ups) {
      if (one.kind != kind.kind) continue;
      list.push_back({{"series", one.name}});
      for (const auto& [name, value] : one.told) list.back()[std::string(name)] = value;
    }
  }
}

/// {joints, source, robot}
Json controller_json(const ControllerModel& controller) {
  return {{"joints", name(controller.evidence)},
          {"source", controller.source.empty() ? Json(nullptr) : Json(controller.source)},
          {"robot", controller.robot ? to_json(*controller.robot) : Json(nullptr)}};
}

}  // namespace

std::string utc(std::int64_t time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(time)));
}

Json to_json(const PoseErrorSummary& summary) {
  const auto read = [&](double value) { return summary.reads_distances ? Json(value) : Json(nullptr); };
  Json json{{"max_abs_distance_mm", read(summary.max_abs_distance)},
            {"rms_distance_mm", read(summary.rms_distance)},
            {"max_volumetric_mm", read(summary.max_volumetric)},
            {"max_volumetric_aligned_mm", read(summary.max_volumetric_aligned)}};
  for (const LengthWords& kind : length_kinds()) {
    const auto rms = summary.rms_lengths.find(kind.kind);
    json[fmt::format("rms_{}", kind.column)] = rms == summary.rms_lengths.end() ? Json(nullptr) : Json(rms->second);
  }
  if (summary.rms_joints) json["rms_joints_mm"] = *summary.rms_joints;
  json["max_abs_rotation_deg"] = optional_degrees(summary.max_abs_rotation);
  json["max_orientation_deg"] = optional_degrees(summary.max_orientation);
  return json;
}

Json to_json(const std::vector<InputFile>& files) {
  return json_array(files, [](const InputFile& file) {
    return Json{{"file", title_of(file.name)}, {"sha256", file.sha256}};  // folders name users and customers
  });
}

Json to_json(const Calibration& calibration, std::int64_t time) {
  const Unit joint = joint_unit(calibration.robot.actuator());
  Json json{
      {"format", kCalibrationFormat},
      {"program", fmt::format("paracal {}", version())},
      {"build", build()},
      {"date", utc(time)},
      {"accepted", calibration.accepted()},
      {"verdict", name(calibration.verdict)},
      {"reasons", calibration.reasons},
      {"use", calibration.use ? use_json(*calibration.use) : Json(nullptr)},
      {"use_mean", calibration.use_mean ? use_json(*calibration.use_mean) : Json(nullptr)},
      {"notes", calibration.notes},
      {"assumed", calibration.assumed},
      {"components", json_array(calibration.components, component_json)},
      {"robot", to_json(calibration.robot)},
      {"controller", controller_json(calibration.options.controller)},
      {"parameters", parameters_json(calibration)},
      {"covariance", covariance_json(calibration, calibration.covariance)},
      {"covariance_of_noise", covariance_json(calibration, calibration.noise_covariance)},
      {"noise_dof", std::isfinite(calibration.noise_dof) ? Json(calibration.noise_dof) : Json(nullptr)},
      {joint == Unit::mm ? "joint_std_mm" : "joint_std_deg", joints_json(calibration.joint_std, joint)},
      {joint == Unit::mm ? "visit_std_mm" : "visit_std_deg", joints_json(calibration.visit_std, joint)},
      {"drives", json_array(calibration.drives, [&](const SoughtSource& one) { return spline_json(one, joint); })},
      {"drive_covariance", covariance_json(calibration, calibration.drive_covariance)},
      {"correlations", correlations_json(calibration)},
      {"coverage_factor", kCoverageFactor},
      {"rank", calibration.rank},
      {"null_space", json_array(calibration.null_space, direction_json)},
      {"stages", json_array(calibration.stages, stage_json)},
      {"residual_rms_mm", calibration.after.reads_distances ? Json(calibration.after.rms_distance) : Json(nullptr)},
      {"readings", calibration.readings},
      {"noise_mm", calibration.noise},
      {"orientation_noise_deg", optional_degrees(calibration.orientation_noise)},
      {"degrees_of_freedom", calibration.degrees_of_freedom},
      {"unit_weight_std", optional(calibration.unit_weight_std)},
      {"fit_probability", optional(calibration.fit_probability)},
      {"chance", optional(calibration.chance)},
      {"before", to_json(calibration.before)},
      {"after", to_json(calibration.after)},
      {"residuals", residuals_json(calibration)},
      {"suspects", json_array(calibration.suspects, suspect_json)},
      {"frames", json_array(calibration.frames, frame_json)}};
  add_set_ups(calibration, json);
  json["distance_bias_mm"] = optional(calibration.distance_bias);
  json["distance_bias_std_mm"] = optional(calibration.distance_bias_std);
  json["options"] = to_json(calibration.options, calibration.robot.geometry());
  json["inputs"] = to_json(calibration.files);
  return json;
}

}  // namespace paracal::io
