#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>

#include "calibration_fields.hpp"
#include "paracal/io/json.hpp"
#include "paracal/units.hpp"

namespace paracal::io {

std::vector<ParameterInFile> CalibrationInFile::parameters() const {
  const Actuator actuator = of.robot.actuator();
  std::vector<ParameterInFile> all;
  for (const ParameterEstimate& one : of.parameters) {
    all.push_back({one, actuator, one.identified() ? ParameterStatus::identified : ParameterStatus::prior});
  }
  const SourceErrors errors = of.errors();
  for (std::size_t limb = 0; limb < of.robot.limb_count(); ++limb) {
    for (const Source source : sources_of(of.robot.nominal().limbs[limb].actuator)) {
      const auto same = [&](const ParameterEstimate& p) { return p.limb == limb && p.source == source; };
      if (std::ranges::any_of(of.parameters, same)) continue;
      const double value = errors(limb, source);
      const ParameterEstimate fixed{
          .limb = limb, .source = source, .value = value, .expected = value, .data_share = 0.0};
      all.push_back({fixed, actuator, ParameterStatus::fixed});
    }
  }
  return all;
}

std::optional<Eigen::MatrixXd> CalibrationInFile::in_file_units(const Eigen::MatrixXd& covariance) const {
  if (covariance.size() == 0) return std::nullopt;
  std::vector<double> factors;  // of the parameters, then of the splines
  const Actuator actuator = of.robot.actuator();
  for (const ParameterEstimate& one : of.parameters) factors.push_back(file_factor(one.source, actuator));
  for (const SoughtSource& one : of.drives) factors.push_back(file_factor(one.source, actuator));
  const Eigen::Map<const Eigen::VectorXd> all(factors.data(), std::ssize(factors));
  const bool of_drives = covariance.cols() > std::ssize(of.parameters);
  const Eigen::VectorXd rows = of_drives ? all.tail(covariance.rows()) : all.head(covariance.rows());
  return rows.asDiagonal() * covariance * all.head(covariance.cols()).asDiagonal();
}

std::vector<SplineInFile> CalibrationInFile::splines() const {
  std::vector<SplineInFile> all;
  const Unit unit = joint_unit(of.robot.actuator());
  for (std::size_t k = 0; k < of.drives.size(); ++k) {
    all.push_back({of.drives[k], unit});
    if (of.drive_sizes.size() > 0) all.back().size = of.drive_sizes(static_cast<Eigen::Index>(k));
  }
  return all;
}

std::optional<Eigen::VectorXd> CalibrationInFile::joints_in(Unit joint, const Eigen::VectorXd& std) const {
  if (joint != joint_unit(of.robot.actuator())) return std::nullopt;
  return std * to_file_unit(joint, 1.0);
}

std::vector<CorrelationInFile> CalibrationInFile::correlations() const {
  const auto named = [&](std::size_t k) {
    const ParameterEstimate& parameter = of.parameters[k];
    return fmt::format("{}{}", name(parameter.source), parameter.limb + 1);
  };
  std::vector<CorrelationInFile> all;
  for (const auto& [one, other, value] : of.correlations()) all.push_back({named(one), named(other), value});
  return all;
}

std::vector<ResidualInFile> CalibrationInFile::residuals() const {
  std::vector<ResidualInFile> all(of.distances.begin(), of.distances.end());
  for (const LengthResidual& one : of.lengths) {
    switch (one.kind) {
      case LengthKind::height:
        all.emplace_back(LengthInFile<LengthKind::height>{one});
        break;
      case LengthKind::ball_bar:
        all.emplace_back(LengthInFile<LengthKind::ball_bar>{one});
        break;
      case LengthKind::dial:
        all.emplace_back(LengthInFile<LengthKind::dial>{one});
        break;
    }
  }
  all.insert(all.end(), of.points.begin(), of.points.end());
  return all;
}

std::string utc(std::int64_t time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(time)));
}

Json to_json(const PoseErrorSummary& summary) { return stored(summary); }

Json to_json(const std::vector<InputFile>& files) { return stored(files); }

Json to_json(const TrackerModel& tracker) { return stored(tracker); }

Json to_json(const CalibrationOptions& options, const Limbs& limbs) { return stored(OptionsInFile{options, limbs}); }

Json to_json(const Calibration& calibration, std::int64_t time) { return stored(CalibrationInFile{calibration, time}); }

}  // namespace paracal::io
