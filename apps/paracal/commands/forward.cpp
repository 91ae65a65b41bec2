#include <fmt/format.h>

#include <memory>

#include "paracal/io/tables.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/units.hpp"
#include "rows.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

struct ForwardArguments {
  std::string joints;
  std::string errors;
  bool json_lines = false;
  io::TableStyle style;
};

io::NamedPlate plate_at(const MachineAsBuilt& built, const io::NamedJoints& row) {
  const Machine& machine = built.machine;
  const ForwardResult result = forward(machine, built.drives.actual(row.joints));
  if (!result.ok()) {
    throw MathematicsSaysNo(
        fmt::format("{}: joints {}: no solution: {}", row.stated_in, row.name, why_no_pose(machine, result)));
  }
  return {row.name, result, machine.rotation_of(result.plate.slide)};
}

io::Json plate_json(const io::NamedPlate& row) {
  const PlateState& plate = row.result.plate;
  return {{"name", row.name},
          {"x_mm", plate.position.x()},
          {"y_mm", plate.position.y()},
          {"z_mm", plate.position.z()},
          {"phi_deg", to_degrees(row.rotation)},
          {"tilt_x_rad", plate.tilt.x()},
          {"tilt_y_rad", plate.tilt.y()},
          {"tilt_z_rad", plate.tilt.z()},
          {"residual_mm", row.result.residual},
          {"iterations", row.result.iterations}};
}

void run(const ForwardArguments& options, Session& session) {
  RowInput joints(options.joints, options.style);
  const Robot robot = session.robot(sources_of(options.errors, joints.rows));
  const MachineAsBuilt machine = session.machine_as_built(robot, options.errors);
  RowOutput rows(session, options.json_lines, {JsonColumn{"poses"}});
  rows.head(io::plate_table_header());
  io::read_joints(joints.rows, robot.joint_space(), [&](const io::NamedJoints& one) {
    const io::NamedPlate row = plate_at(machine, one);
    rows.add([&] { return io::plate_table_row(row); }, [&] { return plate_json(row); });
  });
  rows.finish();
}

}  // namespace

void add_forward(Command& program, Session& session) {
  Command* command = session.add_command(program, "forward", "Kinematics", "compute the exact poses for joint angles");
  const auto options = std::make_shared<ForwardArguments>();
  command->add_option("--joints", options->joints, "joint table (CSV: q1_deg,... or q1_mm,...)")->required();
  command->add_option("--errors", options->errors, "errors of the machine as built (TOML), or a calibration (JSON)");
  add_json_lines_option(*command, options->json_lines);
  add_table_options(*command, options->style);
  command->example("Poses of the nominal robot", "paracal forward --robot huang2016 --joints joints.csv");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
