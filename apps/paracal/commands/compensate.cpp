#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "paracal/compensation/parameters.hpp"
#include "paracal/units.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal {

// The library's, built for speed. One built here, for a short build, would take its place in the whole program.
extern template CompensationStatus compensate(const CompensatorParameters<double>& parameters, CompensationWay way,
                                              const CompensatorPose<double>& pose, CompensatorJoints<double>& joints,
                                              CompensatorTilt<double>* tilt) noexcept;

}  // namespace paracal

namespace paracal::app {
namespace {

const std::map<std::string, CompensationWay> kWays{{"exact", CompensationWay::exact},
                                                   {"tilt-aware", CompensationWay::tilt_aware},
                                                   {"linear", CompensationWay::linear}};

struct Options {
  std::string poses;
  std::string calibration, errors;
  std::string way = "exact";
  bool targets = false;
};

struct Compensated {
  std::string name;
  Joints joints;
  Pose target;
  CompensatorTilt<double> tilt;
  std::optional<CompensatorUncertainty<double>> uncertainty = {};  ///< where a covariance is known
};

io::CalibratedMachine known_machine(const Options& options, const Robot& robot) {
  if (options.calibration.empty() == options.errors.empty()) {
    throw WrongUsage("expected either --calibration or --errors");
  }
  if (!options.errors.empty()) return {.errors = read_errors(robot, options.errors)};
  return io::read_calibration(input_file(options.calibration), robot);
}

[[noreturn]] void refuse(const Station& station, const char* why) {
  throw MathematicsSaysNo(fmt::format("{}: {}", pose_text(station.name, station.commanded), why));
}

Compensated compensated(const Robot& robot, const Compensator<double>& compensator, const Station& station) {
  CompensatorJoints<double> joints{};
  CompensatorTilt<double> tilt;
  const CompensationStatus status = compensator.compensate(compensator_pose(station.commanded), joints, &tilt);
  if (status == CompensationStatus::unreachable) {
    const bool turned = !robot.slide() && station.commanded.rotation != 0.0;
    refuse(station, turned ? "a rigid plate does not turn: expected phi = 0 deg" : "out of reach of the machine");
  }
  if (status != CompensationStatus::ok) refuse(station, "the machine is singular there");
  const Joints corrected = compensated_joints(robot, joints);
  const std::optional<Pose> target = corrected_target(robot, corrected, station.commanded);
  if (!target) refuse(station, "no target of the nominal robot has the corrected joints");
  return {station.name, corrected, *target, tilt};
}

io::Json uncertainty_json(const std::optional<CompensatorUncertainty<double>>& stated) {
  if (!stated) return nullptr;
  return {{"U_mm", {stated->x, stated->y, stated->z}}, {"U_deg", to_degrees(stated->phi)}};
}

io::Json json_of(const Options& options, Actuator actuator, const std::vector<Compensated>& rows) {
  std::vector<io::NamedJoints> joints;
  joints.reserve(rows.size());
  for (const Compensated& row : rows) joints.push_back({row.name, row.joints});
  io::Json targets = io::Json::array(), tilts = io::Json::array(), uncertainties = io::Json::array();
  for (const Compensated& row : rows) {
    targets.push_back(io::to_json(row.target));
    tilts.push_back({{"tilt_x_rad", row.tilt.eps_x}, {"tilt_y_rad", row.tilt.eps_y}});
    uncertainties.push_back(uncertainty_json(row.uncertainty));
  }
  io::Json json = joints_json(joints, actuator);
  json["targets"] = std::move(targets);
  json["remaining_tilt"] = std::move(tilts);
  json["uncertainty"] = std::move(uncertainties);
  json["way"] = options.way;
  return json;
}

/// "# U of these poses in the robot's frame (95 %), largest: x 2.4, y 2.4, z 0.1 mm, phi 4.8 deg": a comment of the
/// table.
std::string uncertainty_line(const std::vector<Compensated>& rows) {
  CompensatorUncertainty<double> largest;
  for (const Compensated& row : rows) {
    if (!row.uncertainty) return "# U of these poses is not known: the errors have no covariance\n";
    largest.x = std::max(largest.x, row.uncertainty->x);
    largest.y = std::max(largest.y, row.uncertainty->y);
    largest.z = std::max(largest.z, row.uncertainty->z);
    largest.phi = std::max(largest.phi, row.uncertainty->phi);
  }
  return fmt::format(
      "# U of these poses in the robot's frame (95 %), largest: x {:.2g}, y {:.2g}, z {:.2g} mm, phi {:.2g} deg\n",
      largest.x, largest.y, largest.z, to_degrees(largest.phi));
}

std::string text_of(const Options& options, Actuator actuator, const std::vector<Compensated>& rows) {
  std::vector<io::NamedJoints> joints;
  std::vector<io::NamedPose> targets;
  for (const Compensated& row : rows) {
    joints.push_back({row.name, row.joints});
    targets.push_back({row.name, row.target});
  }
  return uncertainty_line(rows) + (options.targets ? io::pose_table(targets) : io::joint_table(joints, actuator));
}

/// Adds U to rows that were compensated.
void state_uncertainty(const Robot& robot, const io::CalibratedMachine& machine,
                       const CompensatorParameters<double>& parameters, const std::vector<Station>& stations,
                       std::vector<Compensated>& rows) {
  if (machine.covariance.size() == 0) return;
  const auto covariance = compensator_covariance(robot, machine.parameters, machine.known().pose_covariance());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    CompensatorUncertainty<double> stated;
    const CompensatorPose<double> pose = compensator_pose(stations[k].commanded);
    if (stated_uncertainty(parameters, covariance, pose, stated) == CompensationStatus::ok)
      rows[k].uncertainty = stated;
  }
}

void run(const Options& options, Session& session) {
  RobotSources sources = sources_of(options.errors, {options.poses});
  if (!options.calibration.empty()) sources.calibrations.push_back(options.calibration);
  const Robot robot = session.robot(sources);
  const io::CalibratedMachine machine = known_machine(options, robot);
  const Compensator<double> compensator(compensator_parameters(robot, machine.errors), kWays.at(options.way));
  const std::vector<Station> stations = io::read_poses(input_file(options.poses), robot.joint_space());
  std::vector<Compensated> rows;
  rows.reserve(stations.size());
  for (const Station& station : stations) rows.push_back(compensated(robot, compensator, station));
  state_uncertainty(robot, machine, compensator.parameters(), stations, rows);
  if (!session.json()) return session.print(text_of(options, robot.actuator(), rows));
  session.print_json(json_of(options, robot.actuator(), rows));
}

}  // namespace

void add_compensate(Command& program, Session& session) {
  Command* command = session.add_command(program, "compensate", "Compensate a machine",
                                         "corrected joint angles, and corrected targets for closed controllers");
  const auto options = std::make_shared<Options>();
  command->add_option("--calibration", options->calibration, "calibration (JSON)");
  command->add_option("--errors", options->errors, "source errors (TOML) instead of a calibration");
  command->add_option("--poses", options->poses, "pose table (CSV): where the plate is wanted")->required();
  command->add_option("--way", options->way, "exact; or as in the paper: linear (Eqs. 22, 23) or tilt-aware (Eq. 8)")
      ->check(one_of({"exact", "tilt-aware", "linear"}))
      ->shows_default();
  command->add_flag("--targets", options->targets,
                    "print corrected targets (CSV), for a controller that computes with the nominal robot");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
