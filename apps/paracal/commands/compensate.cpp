#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "paracal/compensation/parameters.hpp"
#include "paracal/units.hpp"
#include "rows.hpp"
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
  bool json_lines = false;
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

io::Json json_of(const Compensated& row, Actuator actuator) {
  io::Json json = joints_json({row.name, row.joints}, actuator);
  json["target"] = io::to_json(row.target);
  json["remaining_tilt"] = {{"tilt_x_rad", row.tilt.eps_x}, {"tilt_y_rad", row.tilt.eps_y}};
  json["uncertainty"] = uncertainty_json(row.uncertainty);
  return json;
}

std::vector<JsonColumn> json_columns(Actuator actuator) {
  return {{"names", "name"},
          {joints_key(actuator), joints_key(actuator)},
          {"targets", "target"},
          {"remaining_tilt", "remaining_tilt"},
          {"uncertainty", "uncertainty"}};
}

/// The largest U of some poses, in each direction.
class LargestUncertainty {
 public:
  void add(const std::optional<CompensatorUncertainty<double>>& stated) {
    is_known_ = is_known_ && stated;
    if (!stated) return;
    largest_.x = std::max(largest_.x, stated->x);
    largest_.y = std::max(largest_.y, stated->y);
    largest_.z = std::max(largest_.z, stated->z);
    largest_.phi = std::max(largest_.phi, stated->phi);
  }

  /// "# U of these poses in the robot's frame (95 %), largest: x 2.4, y 2.4, z 0.1 mm, phi 4.8 deg": a comment of the
  /// table.
  std::string line() const {
    if (!is_known_) return "# U of these poses is not known: the errors have no covariance\n";
    return fmt::format(
        "# U of these poses in the robot's frame (95 %), largest: x {:.2g}, y {:.2g}, z {:.2g} mm, phi {:.2g} deg\n",
        largest_.x, largest_.y, largest_.z, to_degrees(largest_.phi));
  }

 private:
  CompensatorUncertainty<double> largest_ = {};
  bool is_known_ = true;
};

/// U of poses; nothing where no covariance is known.
class PoseUncertainty {
 public:
  PoseUncertainty(const Robot& robot, const io::CalibratedMachine& machine) {
    if (machine.covariance.size() == 0) return;
    covariance_ = compensator_covariance(robot, machine.parameters, machine.known().pose_covariance());
  }

  std::optional<CompensatorUncertainty<double>> at(const CompensatorParameters<double>& parameters,
                                                   const Pose& pose) const {
    CompensatorUncertainty<double> stated;
    if (!covariance_) return std::nullopt;
    const CompensationStatus status = stated_uncertainty(parameters, *covariance_, compensator_pose(pose), stated);
    return status == CompensationStatus::ok ? std::optional(stated) : std::nullopt;
  }

 private:
  std::optional<CompensatorCovariance<double>> covariance_ = {};
};

std::string table_header(const Options& options, const Robot& robot) {
  return options.targets ? std::string(io::pose_table_header()) : io::joint_table_header(robot.joint_space());
}

std::string table_row(const Options& options, Actuator actuator, const Compensated& row) {
  return options.targets ? io::pose_table_row({row.name, row.target})
                         : io::joint_table_row({row.name, row.joints}, actuator);
}

void run(const Options& options, Session& session) {
  RowInput poses(options.poses);
  RobotSources sources = sources_of(options.errors, poses.rows);
  if (!options.calibration.empty()) sources.calibrations.push_back(options.calibration);
  const Robot robot = session.robot(sources);
  const io::CalibratedMachine machine = known_machine(options, robot);
  const Compensator<double> compensator(compensator_parameters(robot, machine.errors), kWays.at(options.way));
  const PoseUncertainty uncertainty(robot, machine);
  const Actuator actuator = robot.actuator();
  RowOutput rows(session, options.json_lines, json_columns(actuator));
  LargestUncertainty largest;
  io::read_poses(poses.rows, robot.joint_space(), [&](const Station& station) {
    Compensated row = compensated(robot, compensator, station);
    row.uncertainty = uncertainty.at(compensator.parameters(), station.commanded);
    largest.add(row.uncertainty);
    rows.add([&] { return table_row(options, actuator, row); }, [&] { return json_of(row, actuator); });
  });
  rows.head(largest.line() + table_header(options, robot));
  rows.finish({{"way", options.way}});
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
  add_json_lines_option(*command, options->json_lines);
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
