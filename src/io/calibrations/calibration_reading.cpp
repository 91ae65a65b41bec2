// A calibration that was written before, as what a machine is known to be.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "io/robots/same_robot.hpp"
#include "io/tables/names.hpp"
#include "json_node.hpp"
#include "numerics/dense.hpp"
#include "paracal/io/measurement_files.hpp"
#include "paracal/units.hpp"
#include "schema_check.hpp"

namespace paracal::io {
namespace {

/// mm, deg, or their share.
constexpr plausible::Range kStd{0.0, plausible::kLimit.most};
constexpr plausible::Range kFreedoms{plausible::kNothing, 1e12};

/// An error that the calibration holds, and whether it was sought.
struct ReadParameter {
  ParameterEstimate estimate;  ///< limb, source, value, std
  bool is_sought = true;
};

/// What a status says of how a value came about; a file that somebody wrote by hand need not say.
bool is_sought(const JsonNode& parameter) {
  const auto status = parameter.find("status");
  if (!status) return true;
  const std::string text = status->text();
  if (text != "identified" && text != "prior" && text != "fixed") {
    status->refuse_as("\"identified\", \"prior\" or \"fixed\"");
  }
  return text != "fixed";
}

/// One entry of a calibration's "parameters".
ReadParameter read_parameter(const JsonNode& parameter, const Robot& robot) {
  const Actuator actuator = robot.actuator();
  const Json& limb = parameter.at("limb").json();
  const bool known_limb = limb.is_number_unsigned() && limb >= 1 && limb <= robot.limb_count();
  const std::string name_in_file = parameter.at("name").text();
  const auto source = known_limb
                          ? source_named(name_in_file, robot.nominal().limbs[limb.get<std::size_t>() - 1].actuator)
                          : std::nullopt;
  if (!source) {
    parameter.refuse(fmt::format("expected the name of an error and a limb from 1 to {}, got {}", robot.limb_count(),
                                 parameter.json().dump()));
  }
  const JsonNode value = parameter.at("value"), unit = parameter.at("unit");
  const std::string_view expected_unit = file_unit(*source, actuator);
  if (unit.json() != expected_unit || !value.json().is_number()) {
    value.refuse(fmt::format("expected a number in {} for {}, got {} {}", expected_unit, name(*source),
                             value.json().dump(), unit.json().dump()));
  }
  const Unit inside = paracal::unit(*source, actuator);
  ParameterEstimate estimate{
      .limb = limb.get<std::size_t>() - 1, .source = *source, .value = from_file_unit(inside, value.number())};
  if (const auto std = parameter.find("std")) estimate.std = from_file_unit(inside, std->number(kStd));
  if (const auto with = parameter.find("with_drives")) estimate.with_drives = from_file_unit(inside, with->number());
  return {estimate, is_sought(parameter)};
}

/// Every source error once, within what a part can be off.
void read_parameters(const JsonNode& entries, const Robot& robot, CalibratedMachine& machine) {
  std::set<std::pair<std::size_t, std::string_view>> seen;
  for (const JsonNode& entry : entries.entries()) {
    const auto [estimate, is_sought] = read_parameter(entry, robot);
    if (!seen.insert({estimate.limb, name(estimate.source)}).second) {
      entry.refuse(
          fmt::format("expected every error once, got {} of limb {} again", name(estimate.source), estimate.limb + 1));
    }
    machine.errors(estimate.limb, estimate.source) = estimate.value;
    if (is_sought) machine.parameters.push_back(estimate);
  }
  if (const auto complaint = implausible(robot, machine.errors)) entries.refuse(*complaint);
}

/// Of sought errors none is known exactly, and no combination of them better than that.
void require_covariance(const Eigen::MatrixXd& covariance, const JsonNode& node, const char* key) {
  constexpr double kRounding = 1e-6;  // of correlations
  const Eigen::VectorXd std = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (std.array() > 0.0).select(std.cwiseInverse(), 0.0);
  const Eigen::MatrixXd correlations = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  if (covariance.diagonal().minCoeff() < 0.0 || covariance.diagonal().maxCoeff() <= 0.0) {
    node.refuse(fmt::format("expected variances above 0 in {}, got other values", key));
  }
  if ((correlations - correlations.transpose()).cwiseAbs().maxCoeff() > kRounding) {
    node.refuse(fmt::format("expected a symmetric {}, got an asymmetric one", key));
  }
  const double least = detail::symmetric_eigenvalues(correlations).minCoeff();
  const double hidden = (std.array() > 0.0).select(0.0, covariance.cwiseAbs().rowwise().maxCoeff().array()).maxCoeff();
  if (least < -kRounding || hidden > 0.0) {
    node.refuse(fmt::format("expected a positive semidefinite {}, got an indefinite one: calibrate again", key));
  }
}

/// mm and rad; nothing where none was stated.
Eigen::MatrixXd read_covariance(const JsonNode& calibration, const char* key,
                                const std::vector<ParameterEstimate>& parameters, Actuator actuator) {
  const auto node = calibration.find(key);
  if (!node) return {};
  const auto n = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd covariance(n, n);
  const std::vector<JsonNode> rows = node->entries();
  if (rows.size() != parameters.size()) {
    node->refuse(fmt::format("expected a {} of {} rows, got {}", key, n, rows.size()));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<double> row = rows[i].numbers();
    if (row.size() != rows.size()) {
      rows[i].refuse(fmt::format("expected a square {}, got {} entries in row {}", key, row.size(), i + 1));
    }
    for (std::size_t k = 0; k < row.size(); ++k) {
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          row[k] / file_factor(parameters[i].source, actuator) / file_factor(parameters[k].source, actuator);
    }
  }
  if (n > 0) require_covariance(covariance, *node, key);
  return covariance;
}

/// Standard deviations of the joints; nothing where none was stated. Files of before have one for all.
Eigen::VectorXd read_joints(const JsonNode& calibration, const char* key, const Robot& robot) {
  if (!calibration.json().contains(key)) return {};
  const JsonNode node = calibration.at(key);  // null, too: without them U would be too small
  const auto joints = static_cast<Eigen::Index>(robot.limb_count());
  const Unit unit = joint_unit(robot.actuator());
  if (node.json().is_number()) {
    const double std = from_file_unit(unit, node.number(kStd));
    return std > 0.0 ? Eigen::VectorXd(Eigen::VectorXd::Constant(joints, std)) : Eigen::VectorXd();
  }
  const std::vector<JsonNode> entries = node.entries();
  if (!entries.empty() && std::ssize(entries) != joints) {
    node.refuse(fmt::format("{}: expected {} numbers, one for each joint, got {}", key, joints, entries.size()));
  }
  Eigen::VectorXd std(std::ssize(entries));
  std::ranges::transform(entries, std.begin(),
                         [&](const JsonNode& one) { return from_file_unit(unit, one.number(kStd)); });
  return std;
}

SoughtSource read_spline(const JsonNode& node, const Robot& robot) {
  const Unit unit = joint_unit(robot.actuator());
  const std::size_t place = node.at("limb").whole_number(1, robot.limb_count()) - 1;
  if (node.at("unit").json() != file_unit(unit)) node.at("unit").refuse_as(fmt::format("\"{}\"", file_unit(unit)));
  return {place,
          joint_zero(robot.nominal().limbs[place].actuator),
          {},
          SplineKnot{from_file_unit(unit, node.at("centre").number()),
                     from_file_unit(unit, node.at("spacing").number({plausible::kNothing, plausible::kLimit.most}))}};
}

/// The splines of the drives with the rows of their mean squares, as they stand behind the parameters.
void read_drives(const JsonNode& calibration, const Robot& robot, CalibratedMachine& machine) {
  const auto splines = calibration.find("drives"), node = calibration.find("drive_covariance");
  if (!splines || machine.covariance.size() == 0) return;
  for (const JsonNode& one : splines->entries()) machine.drives.push_back(read_spline(one, robot));
  if (machine.drives.empty()) return;
  if (!node) splines->refuse("drives: expected drive_covariance with them, got none. Calibrate again");
  const std::vector<JsonNode> rows = node->entries();
  const std::size_t count = machine.parameters.size() + machine.drives.size();
  if (rows.size() != machine.drives.size()) {
    node->refuse(fmt::format("drive_covariance: expected {} rows, one for each spline, got {}", machine.drives.size(),
                             rows.size()));
  }
  machine.drive_covariance.resize(std::ssize(rows), static_cast<Eigen::Index>(count));
  const Actuator actuator = robot.actuator();
  const auto factor = [&](std::size_t k) {
    const std::size_t n = machine.parameters.size();
    return file_factor(k < n ? machine.parameters[k].source : machine.drives[k - n].source, actuator);
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<double> row = rows[i].numbers();
    if (row.size() != count) {
      rows[i].refuse(fmt::format("drive_covariance: expected {} numbers in each row, got {}", count, row.size()));
    }
    for (std::size_t k = 0; k < count; ++k) {
      machine.drive_covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          row[k] / factor(machine.parameters.size() + i) / factor(k);
    }
  }
  KnownErrors all{.errors = {}, .parameters = {}, .covariance = machine.covariance};
  add_drives(machine.drives, machine.drive_covariance, all);
  require_covariance(all.covariance, *node, "drive_covariance");
}

void read_region(const JsonNode& calibration, CalibratedRegion& region) {
  const auto node = calibration.find("region");
  if (!node || node->json().is_null()) return;
  region.low = node->at("low_mm").numbers();
  region.high = node->at("high_mm").numbers();
  const std::size_t count = CalibratedRegion::directions().size();
  if (region.low.size() != count || region.high.size() != count ||
      !std::ranges::equal(region.low, region.high, std::less_equal())) {
    node->refuse(
        fmt::format("region: expected {} numbers in low_mm, and as many in high_mm that are not below them", count));
  }
}

/// Where the drives belong to the machine every spline has a size, and every sought error its value with them.
void read_drive_sizes(const JsonNode& calibration, const Robot& robot, CalibratedMachine& machine) {
  const auto uses = calibration.find("uses_drives");
  if (!uses || !uses->flag()) return;
  if (machine.drives.empty()) uses->refuse("uses_drives: expected the splines in \"drives\" with it, got none");
  machine.drive_sizes.resize(std::ssize(machine.drives));
  Eigen::Index next = 0;
  for (const JsonNode& one : calibration.at("drives").entries()) {
    const JsonNode size = one.at("size");
    const double number = size.number({-plausible::kLimit.most, plausible::kLimit.most});
    machine.drive_sizes(next++) = from_file_unit(joint_unit(robot.actuator()), number);
  }
  if (const auto complaint = DriveCurves::complaint(machine.drives, machine.drive_sizes)) {
    calibration.at("drives").refuse("drives: " + *complaint);
  }
  const JsonNode omitted_poses = calibration.object_at("omitted_poses");
  machine.omitted_poses.with_drives = omitted_poses.at("with_drives_mm").number(kStd);
  machine.omitted_poses.rigid = omitted_poses.at("rigid_mm").number({plausible::kNothing, plausible::kLimit.most});
  if (machine.omitted_poses.gain() <= 0.0) {
    omitted_poses.refuse(
        "omitted_poses: expected with_drives_mm below rigid_mm where the drives belong to the machine");
  }
  SourceErrors errors = machine.errors;
  for (const ParameterEstimate& one : machine.parameters) {
    if (!one.with_drives) {
      uses->refuse(fmt::format("uses_drives: expected every estimated error \"with_drives\", got {} of limb {} without",
                               name(one.source), one.limb + 1));
    }
    errors(one.limb, one.source) = *one.with_drives;
  }
  if (const auto complaint = implausible(robot, errors)) uses->refuse("with_drives: " + *complaint);
  const KnownErrors known = machine.known();
  require_covariance(known.covariance, *uses, "covariance of the machine with its drives");
}

/// What the readings' noise makes uncertain is a part of what is uncertain.
void require_within(const Eigen::MatrixXd& noise, const Eigen::MatrixXd& covariance, const JsonNode& node) {
  constexpr double kRounding = 1e-6;
  if (noise.size() == 0 || noise.rows() != covariance.rows()) return;
  if ((noise.diagonal().array() <= (1.0 + kRounding) * covariance.diagonal().array()).all()) return;
  node.refuse("expected covariance_of_noise below covariance, got larger variances; calibrate again");
}

/// Who changes one of two numbers that say the same has changed neither.
void require_stated_stds(const CalibratedMachine& machine, Actuator actuator, const JsonNode& node) {
  constexpr double kRounding = 0.01;  // of what somebody wrote by hand
  if (machine.covariance.size() == 0) return;
  for (std::size_t k = 0; k < machine.parameters.size(); ++k) {
    const ParameterEstimate& one = machine.parameters[k];
    const auto at = static_cast<Eigen::Index>(k);
    const double expected = std::sqrt(machine.covariance(at, at));
    if (!one.std || std::abs(*one.std - expected) <= kRounding * expected) continue;
    const Unit unit = paracal::unit(one.source, actuator);
    node.refuse(fmt::format("expected the std of {2} of limb {3} as in the covariance ({0:.4g} {1}), got {4:.4g}",
                            to_file_unit(unit, expected), file_unit(unit), name(one.source), one.limb + 1,
                            to_file_unit(unit, *one.std)));
  }
}

/// A file that somebody wrote by hand need not say what it is.
void require_format(const JsonNode& calibration) {
  const auto format = calibration.find("format");
  if (!format || format->json() == kCalibrationFormat) return;
  format->refuse(fmt::format("expected the format \"{}\", got {}", kCalibrationFormat, format->json().dump()));
}

/// `accepted` and `verdict` say the same; the latter may be left out by hand.
void require_accepted(const JsonNode& calibration) {
  const JsonNode accepted = calibration.at("accepted");
  const auto verdict = calibration.find("verdict");
  const std::string yes(name(Verdict::accepted)), text = verdict ? verdict->text() : yes;
  if (!accepted.flag()) {
    accepted.refuse(verdict
                        ? fmt::format("expected an accepted calibration, got the verdict \"{}\": calibrate again", text)
                        : "expected an accepted calibration, got accepted = false: calibrate again");
  }
  if (text != yes) {
    verdict->refuse(fmt::format("expected the verdict \"{}\" with accepted = true, got \"{}\"", yes, text));
  }
}

/// "2016-10-05T12:00:00Z", and such a day and time.
bool is_date(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00T00:00:00Z";
  const auto fits = [](char form, char c) { return form == '0' ? c >= '0' && c <= '9' : c == form; };
  if (text.size() != kForm.size() || !std::ranges::equal(kForm, text, fits)) return false;
  const auto number = [&](std::size_t from, std::size_t count) {
    unsigned value = 0;
    for (const char digit : text.substr(from, count)) value = 10 * value + static_cast<unsigned>(digit - '0');
    return value;
  };
  const std::chrono::year_month_day day(std::chrono::year(static_cast<int>(number(0, 4))),
                                        std::chrono::month(number(5, 2)), std::chrono::day(number(8, 2)));
  return day.ok() && number(11, 2) < 24 && number(14, 2) < 60 && number(17, 2) < 60;
}

/// What people and other programs read of it. A key that a hand left out nobody misses.
void check_statements(const JsonNode& calibration) {
  // Read above, also in the forms of before.
  constexpr std::array<std::string_view, 8> kRead{"covariance",    "covariance_of_noise", "drive_covariance",
                                                  "noise_dof",     "joint_std_deg",       "joint_std_mm",
                                                  "visit_std_deg", "visit_std_mm"};
  require_schema(calibration, "calibration.schema.json", kRead);
  const auto date = calibration.find("date");
  if (date && !is_date(date->text())) date->refuse_as("a date like 2016-10-05T12:00:00Z");
}

/// Name, geometry and plate must be those that were calibrated; tolerances and workspace may change.
void require_same_robot(const JsonNode& calibrated, const Robot& robot) {
  const std::optional<std::string> found = robot_difference(io::to_json(robot), calibrated.json());
  if (found) calibrated.refuse(fmt::format("expected a calibration of the robot with {}", *found));
}

/// What turned poses into joints. Files of before say nothing of it, and it was assumed.
ControllerModel read_controller(const JsonNode& calibration, const std::string& file) {
  const auto node = calibration.find("controller");
  if (!node) return {};
  const JsonNode joints = node->at("joints");
  const auto evidence = controller_evidence(joints.text());
  if (!evidence) joints.refuse_as("\"assumed\", \"readings\", \"confirmed\" or \"stated\"");
  ControllerModel controller{.evidence = *evidence};
  if (const auto source = node->find("source")) controller.source = source->text();
  if (const auto robot = node->find("robot")) controller.robot = robot_in(*robot, file);
  return controller;
}

}  // namespace

void require_inputs(const JsonFile& calibration) {
  (void)JsonNode(calibration.text, calibration.json, "a calibration").at("inputs");
}

KnownErrors CalibratedMachine::known() const {
  if (drive_sizes.size() == 0) return rigid();
  Eigen::VectorXd values(std::ssize(parameters));
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    values(k) = parameters[static_cast<std::size_t>(k)].with_drives.value();
  }
  return with_drives(rigid(), values, drive_sizes, omitted_poses.gain());
}

KnownErrors CalibratedMachine::rigid() const {
  KnownErrors known{errors, {}, covariance, noise_covariance, noise_dof, joint_std, visit_std};
  known.region = region;
  if (covariance.size() == 0) return known;
  known.parameters.reserve(parameters.size());
  for (const ParameterEstimate& one : parameters) known.parameters.push_back({one.limb, one.source});
  add_drives(drives, drive_covariance, known);
  return known;
}

CalibratedMachine read_calibration(const JsonFile& file, const Robot& robot) {
  const JsonNode calibration(file.text, file.json, "a calibration");
  const Actuator actuator = robot.actuator();
  CalibratedMachine machine;
  require_format(calibration);
  require_same_robot(calibration.object_at("robot"), robot);
  require_accepted(calibration);
  if (const auto inputs = calibration.find("inputs")) {
    for (const JsonNode& input : inputs->entries()) {
      machine.inputs.push_back({input.at("file").text(), input.at("sha256").text()});
    }
  }
  machine.controller = read_controller(calibration, file.text.name);
  read_parameters(calibration.at("parameters"), robot, machine);
  machine.covariance = read_covariance(calibration, "covariance", machine.parameters, actuator);
  machine.noise_covariance = read_covariance(calibration, "covariance_of_noise", machine.parameters, actuator);
  require_within(machine.noise_covariance, machine.covariance, calibration);
  require_stated_stds(machine, actuator, calibration.at("parameters"));
  if (const auto dof = calibration.find("noise_dof")) {
    machine.noise_dof = dof->number(kFreedoms);
  }
  const bool slides = joint_unit(actuator) == Unit::mm;
  machine.joint_std = read_joints(calibration, slides ? "joint_std_mm" : "joint_std_deg", robot);
  machine.visit_std = read_joints(calibration, slides ? "visit_std_mm" : "visit_std_deg", robot);
  read_region(calibration, machine.region);
  read_drives(calibration, robot, machine);
  read_drive_sizes(calibration, robot, machine);
  check_statements(calibration);
  return machine;
}

}  // namespace paracal::io
