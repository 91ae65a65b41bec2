#include "paracal/io/json.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "names.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

namespace paracal::io {
namespace {

Json array(const auto& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(value);
  return json;
}

Json optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json optional_degrees(const std::optional<double>& value) { return value ? Json(to_degrees(*value)) : Json(nullptr); }

Json to_json(const Tolerances& tolerances) {
  Json json;
  for (const Source source : all_sources()) {
    if (source == Source::e_y || source == Source::e_z) continue;
    json[is_e(source) ? "e_mm" : file_key(source)] = tidy(to_file_unit(source, tolerances[source]));
  }
  json["distribution"] = distribution_name(tolerances.distribution);
  return json;
}

Json to_json(const ResidualSummary& summary) {
  return {{"max_abs_distance_mm", summary.max_abs_distance},
          {"rms_distance_mm", summary.rms_distance},
          {"max_abs_rotation_deg", optional_degrees(summary.max_abs_rotation)}};
}

Json to_json(const ParameterEstimate& parameter, std::string_view status) {
  Json json{{"name", name(parameter.source)},
            {"limb", parameter.limb + 1},
            {"value", to_file_unit(parameter.source, parameter.value)},
            {"unit", file_unit(parameter.source)}};
  json["std"] = parameter.std ? Json(to_file_unit(parameter.source, *parameter.std)) : Json(nullptr);
  json["status"] = status;
  return json;
}

/// Identified parameters first, then the sources that the fit held at zero.
Json parameters_json(const Calibration& calibration) {
  Json json = Json::array();
  for (const ParameterEstimate& parameter : calibration.parameters) json.push_back(to_json(parameter, "identified"));
  for (std::size_t limb = 0; limb < calibration.robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
      const auto same = [&](const ParameterEstimate& p) { return p.limb == limb && p.source == source; };
      if (std::ranges::any_of(calibration.parameters, same)) continue;
      json.push_back(to_json(ParameterEstimate{limb, source, 0.0, std::nullopt}, "fixed"));
    }
  }
  return json;
}

/// Covariance in file units: deg instead of rad.
Json covariance_json(const Calibration& calibration) {
  Eigen::VectorXd factor(static_cast<Eigen::Index>(calibration.parameters.size()));
  for (std::size_t k = 0; k < calibration.parameters.size(); ++k) {
    factor(static_cast<Eigen::Index>(k)) = to_file_unit(calibration.parameters[k].source, 1.0);
  }
  if (calibration.covariance.size() == 0) return nullptr;
  return rows_json(factor.asDiagonal() * calibration.covariance * factor.asDiagonal());
}

Json residual_json(const ReadingResidual& residual) {
  Json json{{"from", residual.from},
            {"to", residual.to},
            {"distance_mm", residual.distance},
            {"before_mm", residual.distance_before},
            {"after_mm", residual.distance_after}};
  if (residual.rotation) {
    json["rotation_deg"] = optional_degrees(residual.rotation);
    json["rotation_before_deg"] = optional_degrees(residual.rotation_before);
    json["rotation_after_deg"] = optional_degrees(residual.rotation_after);
  }
  return json;
}

/// One entry of a calibration's "parameters" into `errors`; calls refuse(complaint) for anything else.
void read_parameter(const Json& parameter, const Robot& robot, SourceErrors& errors, const auto& refuse) {
  const auto source = source_named(parameter.at("name").get<std::string>());
  const Json &limb = parameter.at("limb"), &value = parameter.at("value"), &unit = parameter.at("unit");
  const bool known_limb = limb.is_number_unsigned() && limb >= 1 && limb <= robot.limb_count();
  if (!source || !known_limb) {
    refuse(fmt::format("expected a source error of limbs 1 to {}, got {}", robot.limb_count(), parameter.dump()));
  }
  if (unit != file_unit(*source) || !value.is_number() || !std::isfinite(value.get<double>())) {
    refuse(fmt::format("expected a number in {} for {}, got {} {}", file_unit(*source), name(*source), value.dump(),
                       unit.dump()));
  }
  errors(limb.get<std::size_t>() - 1, *source) = from_file_unit(*source, value.get<double>());
}

/// Name, geometry and plate must be those that were calibrated; tolerances and workspace may change.
void require_same_robot(const Json& calibrated, const Robot& robot, const auto& refuse) {
  const Json nominal = io::to_json(robot);
  for (const char* part : {"name", "geometry", "plate"}) {
    const Json expected = nominal.value(part, Json()), got = calibrated.value(part, Json());
    if (expected != got) {
      refuse(fmt::format("expected a calibration of the robot with {} {}, got {}", part, expected.dump(), got.dump()));
    }
  }
}

/// Line of a byte of a text, from 1.
int line_of(std::string_view text, std::size_t byte) {
  return static_cast<int>(1 + std::ranges::count(text.substr(0, byte), '\n'));
}

}  // namespace

Json rows_json(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(array(matrix.row(i)));
  return rows;
}

Json to_json(const Robot& robot) {
  const Geometry& geometry = robot.geometry();
  Json azimuth = Json::array();
  for (const double angle : geometry.limb_azimuth) azimuth.push_back(tidy_degrees(angle));
  Json json{{"name", robot.name()},
            {"geometry",
             {{"base_radius_mm", geometry.base_radius},
              {"plate_radius_mm", geometry.plate_radius},
              {"arm_mm", geometry.arm},
              {"rod_mm", geometry.rod},
              {"parallelogram_width_mm", geometry.parallelogram_width},
              {"limb_azimuth_deg", azimuth},
              {"actuator", "revolute"}}}};
  if (const std::optional<Slide>& slide = robot.slide()) {
    json["plate"] = {{"slide_axis", array(slide->axis)},
                     {"slide_sign", array(slide->sign)},
                     {"pinion_radius_mm", slide->pinion_radius}};
  }
  const Workspace& workspace = robot.workspace();
  json["workspace"] = {{"radius_mm", workspace.radius},
                       {"height_mm", workspace.height},
                       {"top_z_mm", workspace.top_z},
                       {"rotation_deg", {tidy_degrees(workspace.min_rotation), tidy_degrees(workspace.max_rotation)}}};
  if (robot.tolerances()) json["tolerances"] = to_json(*robot.tolerances());
  return json;
}

Json to_json(const Calibration& calibration, std::int64_t time) {
  Json json{{"format", "paracal calibration 1"},
            {"program", fmt::format("paracal {}", version())},
            {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(time)))},
            {"accepted", calibration.accepted()},
            {"verdict", name(calibration.verdict)},
            {"reasons", calibration.reasons},
            {"robot", to_json(calibration.robot)},
            {"parameters", parameters_json(calibration)},
            {"covariance", covariance_json(calibration)},
            {"rank", calibration.rank}};
  Json& null_space = json["null_space"] = Json::array();
  for (const NullDirection& direction : calibration.null_space) {
    null_space.push_back({{"text", direction.text}, {"direction", array(direction.direction)}});
  }
  Json& stages = json["stages"] = Json::array();
  for (const StageReport& stage : calibration.stages) {
    stages.push_back({{"name", stage.name},
                      {"iterations", stage.iterations},
                      {"converged", stage.converged},
                      {"rank", stage.rank},
                      {"condition", stage.condition},
                      {"residual_rms_mm", stage.rms_distance}});
  }
  json["residual_rms_mm"] = calibration.after.rms_distance;
  json["degrees_of_freedom"] = calibration.degrees_of_freedom;
  json["unit_weight_std"] = optional(calibration.unit_weight_std);
  json["chance"] = optional(calibration.chance);
  json["before"] = to_json(calibration.before);
  json["after"] = to_json(calibration.after);
  Json& residuals = json["residuals"] = Json::array();
  for (const ReadingResidual& residual : calibration.residuals) residuals.push_back(residual_json(residual));
  json["options"] = {{"distance_sigma_mm", calibration.options.distance_sigma},
                     {"rotation_sigma_deg", tidy_degrees(calibration.options.rotation_sigma)},
                     {"largest_chance", calibration.options.largest_chance}};
  Json& inputs = json["inputs"] = Json::array();
  for (const InputFile& file : calibration.files) inputs.push_back({{"file", file.name}, {"sha256", file.sha256}});
  return json;
}

SourceErrors read_calibrated_errors(const TextFile& file, const Robot& robot) {
  const auto refuse = [&](const std::string& complaint) { throw InputFileError(file.name, 0, complaint); };
  SourceErrors errors;
  try {
    const Json json = Json::parse(file.text);
    require_same_robot(json.at("robot"), robot, refuse);
    if (!json.at("accepted").get<bool>()) {
      refuse(fmt::format("expected an accepted calibration, got one whose verdict is: {}",
                         json.at("verdict").get<std::string>()));
    }
    for (const Json& parameter : json.at("parameters")) read_parameter(parameter, robot, errors, refuse);
  } catch (const Json::parse_error& error) {
    throw InputFileError(file.name, line_of(file.text, error.byte), "expected JSON, got something else");
  } catch (const Json::exception&) {
    refuse("expected a calibration with its robot, verdict and parameters, got JSON without one of them");
  }
  return errors;
}

}  // namespace paracal::io
