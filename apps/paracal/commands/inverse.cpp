#include <fmt/format.h>

#include <memory>

#include "paracal/io/tables.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "rows.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

struct InverseArguments {
  std::string poses;
  std::string errors;
  bool json_lines = false;
  io::TableStyle style;
};

Joints joints_at(const Robot& robot, const MachineAsBuilt& built, const Station& station) {
  const InverseResult result = inverse(built.machine, station.commanded);
  if (result.ok()) return built.drives.commanded(result.joints);
  std::string why = "no solution: the machine is singular there";
  if (result.status == InverseStatus::unreachable) {
    why = result.unreachable_limb < 0
              ? std::string(why_not_turned(robot, station.commanded))
              : fmt::format("no solution: limb {} cannot reach this pose", result.unreachable_limb + 1);
  }
  throw MathematicsSaysNo(fmt::format("{}: {}", pose_text(station), why));
}

void run(const InverseArguments& options, Session& session) {
  RowInput poses(options.poses, options.style);
  const Robot robot = session.robot(sources_of(options.errors, poses.rows));
  const MachineAsBuilt machine = session.machine_as_built(robot, options.errors);
  const Actuator actuator = robot.actuator();
  RowOutput rows(session, options.json_lines, {{"names", "name"}, {joints_key(actuator), joints_key(actuator)}});
  rows.head(io::joint_table_header(robot.joint_space()));
  JointSpace asked = !robot.is_level() ? robot.joint_space() : JointSpace{};  // whose tilts count
  asked.reach = robot.reach();
  io::read_poses(poses.rows, asked, [&](const Station& station) {
    const io::NamedJoints row{station.name, joints_at(robot, machine, station)};
    rows.add([&] { return io::joint_table_row(row, actuator); }, [&] { return joints_json(row, actuator); });
  });
  rows.finish();
}

}  // namespace

void add_inverse(Command& program, Session& session) {
  Command* command = session.add_command(program, "inverse", "Kinematics", "compute the joint angles for poses");
  const auto options = std::make_shared<InverseArguments>();
  command->add_option("--poses", options->poses, "pose table (CSV: x_mm,y_mm,z_mm,phi_deg)")->required();
  command->add_option("--errors", options->errors, "errors of the machine as built (TOML), or a calibration (JSON)");
  add_json_lines_option(*command, options->json_lines);
  add_table_options(*command, options->style);
  command->example("Joint angles of the nominal robot", "paracal inverse --robot huang2016 --poses work.csv");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
