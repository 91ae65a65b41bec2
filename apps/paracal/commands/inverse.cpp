#include <fmt/format.h>

#include <memory>

#include "paracal/io/tables.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

struct Options {
  std::string poses;
  std::string errors;
};

Joints joints_at(const Machine& machine, const Station& station) {
  const InverseResult result = inverse(machine, station.commanded);
  if (result.ok()) return result.joints;
  std::string why = "the machine is singular there";
  if (result.status == InverseStatus::unreachable) {
    why = result.unreachable_limb < 0 ? "a rigid plate does not turn: expected phi = 0 deg"
                                      : fmt::format("out of reach of limb {}", result.unreachable_limb + 1);
  }
  throw MathematicsSaysNo(fmt::format("{}: {}", pose_text(station.name, station.commanded), why));
}

void run(const Options& options, Session& session) {
  const Robot robot = session.robot(sources_of(options.errors, {options.poses}));
  const Machine machine = machine_as_built(robot, options.errors);
  std::vector<io::NamedJoints> rows;
  for (const Station& station : io::read_poses(input_file(options.poses))) {
    rows.push_back({station.name, joints_at(machine, station)});
  }
  if (!session.json()) return session.print(io::joint_table(rows, robot.actuator()));
  session.print_json(joints_json(rows, robot.actuator()));
}

}  // namespace

void add_inverse(Command& program, Session& session) {
  Command* command = session.add_command(program, "inverse", "Kinematics", "joint angles that reach poses");
  const auto options = std::make_shared<Options>();
  command->add_option("--poses", options->poses, "pose table (CSV)")->required();
  command->add_option("--errors", options->errors,
                      "source errors (TOML) or a calibration (JSON): the machine as built");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
