#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "controller.hpp"
#include "paracal/compensation/pose_correction.hpp"
#include "paracal/compensation/target_correction.hpp"
#include "paracal/units.hpp"
#include "rows.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal::app {
namespace {

const std::map<std::string, CompensationWay> kWays{{"exact", CompensationWay::exact},
                                                   {"tilt-aware", CompensationWay::tilt_aware},
                                                   {"linear", CompensationWay::linear}};

struct CompensateArguments {
  std::string poses;
  std::string calibration, errors;
  ControllerOptions controller;
  std::string way = "exact";
  bool targets = false;
  bool rigid = false;
  bool json_lines = false;
  io::TableStyle style;
};

struct Compensated {
  std::string name;
  CorrectedPose corrected;
};

/// What a command corrects for, and the controller that it corrects.
struct Corrected {
  KnownErrors known;
  ControllerModel controller;
};

Corrected known_machine(const CompensateArguments& options, const Robot& robot, Session& session) {
  if (options.calibration.empty() == options.errors.empty()) {
    throw WrongUsage("expected either --calibration or --errors");
  }
  if (!options.errors.empty() && !is_calibration(options.errors)) {
    return {{.errors = session.read_errors(robot, options.errors), .parameters = {}, .covariance = {}},
            {.evidence = ControllerEvidence::stated}};
  }
  const bool as_errors = !options.errors.empty();
  const io::JsonFile& file = session.calibration_file(as_errors ? options.errors : options.calibration);
  const io::CalibratedMachine machine = as_errors ? io::read_calibration(file, robot)
                                                  : checked_calibration(file, options.controller, robot, options.style);
  Corrected corrected{options.rigid ? machine.rigid() : machine.known(), machine.controller};
  if (as_errors) corrected.known.covariance = {};
  return corrected;
}

[[noreturn]] void refuse(const Station& station, std::string_view why) {
  throw MathematicsSaysNo(fmt::format("{}: {}", pose_text(station), why));
}

io::Json uncertainty_json(const std::optional<StatedU>& stated) {
  if (!stated) return nullptr;
  const Eigen::Vector3d& mm = stated->position;
  io::Json json{{"U_mm", {mm.x(), mm.y(), mm.z()}}};
  if (!stated->tilt) {
    json["U_deg"] = to_degrees(stated->rotation);
  } else {
    for (const double angle : *stated->tilt) json["U_tilt_deg"].push_back(to_degrees(angle));
  }
  return json;
}

io::Json json_of(const Compensated& row, const Robot& robot) {
  const auto& [status, joints, target, tilt, uncertainty] = row.corrected;
  io::Json json = joints_json({row.name, joints}, robot.actuator());
  json["target"] = target ? io::to_json(*target, robot.commands_tilt()) : io::Json(nullptr);
  json["remaining_tilt"] = {{"tilt_x_rad", tilt.eps_x}, {"tilt_y_rad", tilt.eps_y}};
  json["uncertainty"] = uncertainty_json(uncertainty);
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
  void add(const std::optional<StatedU>& stated) {
    is_known_ = is_known_ && stated;
    if (!stated) return;
    largest_.position = largest_.position.cwiseMax(stated->position);
    largest_.rotation = std::max(largest_.rotation, stated->rotation);
    if (stated->tilt) largest_.tilt = largest_.tilt.value_or(Eigen::Vector3d::Zero()).cwiseMax(*stated->tilt);
  }

  /// "# largest U (k = 2, 95 %) of these poses in the robot's frame: x 2.4, y 2.4, z 0.1 mm, phi 4.8 deg": a comment of
  /// the table.
  std::string line() const {
    if (!is_known_) return "# U of these poses is unknown, because the errors have no covariance: use --calibration\n";
    const auto& [mm, rotation, tilt] = largest_;
    const std::string turns = tilt ? fmt::format("tilt {:.2g}, {:.2g}, {:.2g}", to_degrees(tilt->x()),
                                                 to_degrees(tilt->y()), to_degrees(tilt->z()))
                                   : fmt::format("phi {:.2g}", to_degrees(rotation));
    return fmt::format(
        "# largest U (k = 2, 95 %) of these poses in the robot's frame: x {:.2g}, y {:.2g}, z {:.2g} mm, {} deg\n",
        mm.x(), mm.y(), mm.z(), turns);
  }

 private:
  StatedU largest_ = {};
  bool is_known_ = true;
};

std::string extrapolation_line(std::size_t count) {
  if (count == 0) return "";
  return fmt::format(
      "# note: {} of these poses lie{} outside of the region of the calibrated poses: errors exceed U more often "
      "there\n",
      count, count == 1 ? "s" : "");
}

PoseCorrector corrector_of(const Robot& robot, const Corrected& machine, const std::string& way) {
  if (!robot.is_level() && way != "exact") {
    throw WrongUsage(
        "--way: expected exact: the linear methods are for plates that three or four parallelograms keep level");
  }
  return pose_corrector(robot, machine.known, kWays.at(way), machine.controller.computes_with(robot));
}

/// A target may be missing where nobody prints it by itself: some joints of a machine that is off are no nominal one's.
Compensated compensated(const PoseCorrector& corrector, const Station& station, bool needs_target) {
  CorrectedPose found = corrector(station.commanded);
  if (found.status == CompensationStatus::unreachable) refuse(station, "no solution: the pose is out of reach");
  if (found.status != CompensationStatus::ok) refuse(station, "no solution: the machine is singular there");
  if (needs_target && !found.target)
    refuse(station, "no solution: no pose of the nominal robot has the corrected joints");
  return {station.name, std::move(found)};
}

std::string without_line_end(std::string line) {
  line.pop_back();
  return line;
}

/// @param knows_u  every target has its U, in columns behind it.
std::string table_header(const CompensateArguments& options, const Robot& robot, bool knows_u) {
  if (!options.targets) return io::joint_table_header(robot.joint_space());
  std::string header = io::pose_table_header(robot.commands_tilt());
  if (!knows_u) return header;
  const char* const turns = robot.commands_tilt() ? "U_tilt_x_deg,U_tilt_y_deg,U_tilt_z_deg" : "U_phi_deg";
  return fmt::format("{},U_x_mm,U_y_mm,U_z_mm,{}\n", without_line_end(header), turns);
}

/// A pose of which no U is known leaves its columns empty.
std::string table_row(const CompensateArguments& options, const Robot& robot, const Compensated& row, bool knows_u) {
  if (!options.targets) return io::joint_table_row({row.name, row.corrected.joints}, robot.actuator());
  std::string target = io::pose_table_row({row.name, *row.corrected.target}, robot.commands_tilt());
  const auto& stated = row.corrected.uncertainty;
  if (!knows_u) return target;
  std::string text = without_line_end(target);
  if (!stated) return text.append(robot.commands_tilt() ? 6 : 4, ',') + '\n';
  const auto append = [&text](double u) { fmt::format_to(std::back_inserter(text), ",{:.3g}", u); };
  for (const double u : stated->position) append(u);
  if (!stated->tilt) append(to_degrees(stated->rotation));
  for (int axis = 0; stated->tilt && axis < 3; ++axis) append(to_degrees((*stated->tilt)[axis]));
  return text + '\n';
}

/// What joints depend on, as comments of their table; targets depend on none of it.
std::string controller_comments(const CompensateArguments& options, const std::vector<std::string>& assumed,
                                const Robot& robot, const ControllerModel& controller) {
  if (options.targets) return robot.nominal().spare_limbs() > 0 ? fmt::format("# note: {}\n", kSpareLimbs) : "";
  std::string text = assumed_lines(assumed, "#");
  for (const std::string& line : comparison_lines(robot, controller)) text += "# " + line + "\n";
  return text;
}

void run(const CompensateArguments& options, Session& session) {
  RowInput poses(options.poses, options.style);
  RobotSources sources = sources_of(options.errors, poses.rows);
  if (!options.calibration.empty()) sources.calibrations.push_back(options.calibration);
  const Robot robot = session.robot(sources);
  Corrected machine = known_machine(options, robot, session);
  for (const std::string& known : {options.calibration, options.errors}) session.forget_calibration(known);
  machine.controller = checked_controller(options.controller, machine.controller, robot, options.style);
  const ControllerModel& controller = machine.controller;
  const std::vector<std::string> assumed = controller_assumptions(controller, robot);
  const PoseCorrector corrector = corrector_of(robot, machine, options.way);
  RowOutput rows(session, options.json_lines, json_columns(robot.actuator()));
  LargestUncertainty largest;
  std::size_t extrapolated = 0;
  const bool knows_u = machine.known.covariance.size() > 0;
  io::read_poses(poses.rows, robot.joint_space(), [&](const Station& station) {
    if (const std::string_view why = why_not_turned(robot, station.commanded); !why.empty()) refuse(station, why);
    const Compensated row = compensated(corrector, station, options.targets);
    largest.add(row.corrected.uncertainty);
    extrapolated += machine.known.region.is_left_by(station.commanded.position) ? 1 : 0;
    rows.add([&] { return table_row(options, robot, row, knows_u); }, [&] { return json_of(row, robot); });
  });
  rows.head(largest.line() + extrapolation_line(extrapolated) +
            controller_comments(options, assumed, robot, controller) + table_header(options, robot, knows_u));
  rows.finish({{"way", options.way},
               {"extrapolated", extrapolated},
               {"assumed", assumed},
               {"nominal_joints", comparison_json(robot, controller)}});
}

}  // namespace

void add_compensate(Command& program, Session& session) {
  Command* command = session.add_command(program, "compensate", "Compensate a machine",
                                         "compute corrected joint angles, or corrected targets for closed controllers");
  const auto options = std::make_shared<CompensateArguments>();
  command->add_option("--calibration", options->calibration, "calibration of the machine (JSON)");
  command->add_option("--errors", options->errors, "errors of the machine (TOML), instead of a calibration");
  command->add_option("--poses", options->poses, "wanted poses (CSV)")->required();
  command
      ->add_option(
          "--way", options->way,
          "method of compensation: exact; or linear (Eqs. 22 and 23) or tilt-aware (Eq. 8) of Huang et al. (2016)")
      ->check(one_of({"exact", "tilt-aware", "linear"}));
  command->add_flag("--targets", options->targets,
                    "print corrected targets (CSV) for a controller that uses the nominal dimensions");
  command->add_flag("--rigid", options->rigid, "omit the smooth errors of the drives");
  add_controller_options(*command, options->controller);
  add_json_lines_option(*command, options->json_lines);
  add_table_options(*command, options->style);
  command->example("Joint angles for the poses of a table",
                   "paracal compensate --calibration calibration.json --poses work.csv");
  command->example(
      "Corrected targets for a closed controller",
      "paracal compensate --calibration calibration.json --poses work.csv --targets --out targets_out.csv");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
