#include <fmt/format.h>

#include <map>
#include <memory>

#include "paracal/compensation/parameters.hpp"
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
};

SourceErrors known_errors_of(const Options& options, const Robot& robot) {
  if (options.calibration.empty() == options.errors.empty()) {
    throw WrongUsage("expected either --calibration or --errors");
  }
  if (!options.errors.empty()) return read_errors(robot, options.errors);
  return io::read_calibration(io::read_file(options.calibration), robot).errors;
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
  const std::optional<Pose> target = corrected_target(robot, corrected);
  if (!target) refuse(station, "no target of the nominal robot has the corrected joints");
  return {station.name, corrected, *target, tilt};
}

io::Json json_of(const Options& options, const std::vector<Compensated>& rows) {
  std::vector<io::NamedJoints> joints;
  joints.reserve(rows.size());
  for (const Compensated& row : rows) joints.push_back({row.name, row.joints});
  io::Json targets = io::Json::array(), tilts = io::Json::array();
  for (const Compensated& row : rows) {
    targets.push_back(io::to_json(row.target));
    tilts.push_back({{"tilt_x_rad", row.tilt.eps_x}, {"tilt_y_rad", row.tilt.eps_y}});
  }
  io::Json json = joints_json(joints);
  json["targets"] = std::move(targets);
  json["remaining_tilt"] = std::move(tilts);
  json["way"] = options.way;
  return json;
}

std::string text_of(const Options& options, const std::vector<Compensated>& rows) {
  std::vector<io::NamedJoints> joints;
  std::vector<io::NamedPose> targets;
  for (const Compensated& row : rows) {
    joints.push_back({row.name, row.joints});
    targets.push_back({row.name, row.target});
  }
  return options.targets ? io::pose_table(targets) : io::joint_table(joints);
}

void run(const Options& options, const Session& session) {
  const Robot robot = session.robot();
  const Compensator<double> compensator(compensator_parameters(robot, known_errors_of(options, robot)),
                                        kWays.at(options.way));
  std::vector<Compensated> rows;
  for (const Station& station : io::read_poses(io::read_file(options.poses))) {
    rows.push_back(compensated(robot, compensator, station));
  }
  session.json() ? session.print_json(json_of(options, rows)) : session.print(text_of(options, rows));
}

}  // namespace

void add_compensate(CLI::App& app, Session& session) {
  CLI::App* command = session.add_command(app, "compensate", "Compensate a machine",
                                          "corrected joint angles, and corrected targets for closed controllers");
  const auto options = std::make_shared<Options>();
  command->add_option("--calibration", options->calibration, "calibration (JSON)");
  command->add_option("--errors", options->errors, "source errors (TOML) instead of a calibration");
  command->add_option("--poses", options->poses, "pose table (CSV): where the plate is wanted")->required();
  command->add_option("--way", options->way, "exact; or as in the paper: linear (Eqs. 22, 23) or tilt-aware (Eq. 8)")
      ->check(CLI::IsMember({"exact", "tilt-aware", "linear"}))
      ->capture_default_str();
  command->add_flag("--targets", options->targets,
                    "print corrected targets (CSV), for a controller that computes with the nominal robot");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
