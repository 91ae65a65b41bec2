// A calibration that was written before, as what a machine is known to be.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <set>
#include <utility>

#include "names.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "same_robot.hpp"

namespace paracal::io {
namespace {

/// One entry of a calibration's "parameters"; calls refuse(complaint) for anything else.
ParameterEstimate read_parameter(const Json& parameter, const Robot& robot, const auto& refuse) {
  const auto source = source_named(parameter.at("name").get<std::string>(), robot.actuator());
  const Json &limb = parameter.at("limb"), &value = parameter.at("value"), &unit = parameter.at("unit");
  const bool known_limb = limb.is_number_unsigned() && limb >= 1 && limb <= robot.limb_count();
  if (!source || !known_limb) {
    refuse(fmt::format("expected a source error of limbs 1 to {}, got {}", robot.limb_count(), parameter.dump()));
  }
  const std::string_view expected_unit = file_unit(*source, robot.actuator());
  if (unit != expected_unit || !value.is_number() || !std::isfinite(value.get<double>())) {
    refuse(fmt::format("expected a number in {} for {}, got {} {}", expected_unit, name(*source, robot.actuator()),
                       value.dump(), unit.dump()));
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
          rows[i][k].get<double>() / file_factor(parameters[i].source, actuator) /
          file_factor(parameters[k].source, actuator);
    }
  }
  return covariance;
}

/// A file that somebody wrote by hand need not say what it is.
void require_format(const Json& json, const auto& refuse) {
  const Json format = json.value("format", Json(kCalibrationFormat));
  if (format == kCalibrationFormat) return;
  refuse(fmt::format("expected the format \"{}\", got {}", kCalibrationFormat, format.dump()));
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
        refuse(fmt::format("expected every source error once, got {} of limb {} again",
                           name(parameter.source, robot.actuator()), parameter.limb + 1));
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
    const char* joint = joint_unit(robot.actuator()) == Unit::mm ? "joint_std_mm" : "joint_std_deg";
    machine.joint_std = from_file_unit(joint_unit(robot.actuator()), json.value(joint, 0.0));
  } catch (const Json::exception&) {
    refuse("expected a calibration with its robot, verdict and parameters, got JSON without one of them");
  }
  return machine;
}

}  // namespace paracal::io
