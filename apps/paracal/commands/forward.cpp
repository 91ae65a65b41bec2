#include <fmt/format.h>

#include <memory>

#include "paracal/io/tables.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

struct Options {
  std::string joints;
  std::string errors;
};

io::NamedPlate plate_at(const Machine& machine, const io::NamedJoints& row) {
  const ForwardResult result = forward(machine, row.joints);
  if (!result.ok()) {
    const char* why = result.residual > ForwardOptions{}.max_residual ? "the rods do not meet"
                      : result.status == ForwardStatus::singular      ? "the joints do not hold the plate"
                                                                      : "the closure did not settle";
    throw MathematicsSaysNo(fmt::format("joints {}: {} (largest rod residual {:.3g} mm after {} iterations)", row.name,
                                        why, result.residual, result.iterations));
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

void run(const Options& options, Session& session) {
  const Robot robot = session.robot(sources_of(options.errors, {options.joints}));
  const Machine machine = machine_as_built(robot, options.errors);
  std::vector<io::NamedPlate> rows;
  for (const io::NamedJoints& joints : io::read_joints(input_file(options.joints), robot.joint_space())) {
    rows.push_back(plate_at(machine, joints));
  }
  if (!session.json()) return session.print(io::plate_table(rows));
  io::Json poses = io::Json::array();
  for (const io::NamedPlate& row : rows) poses.push_back(plate_json(row));
  session.print_json(io::Json{{"poses", poses}});
}

}  // namespace

void add_forward(Command& program, Session& session) {
  Command* command = session.add_command(program, "forward", "Kinematics", "exact poses that joint angles lead to");
  const auto options = std::make_shared<Options>();
  command->add_option("--joints", options->joints, "joint table (CSV)")->required();
  command->add_option("--errors", options->errors,
                      "source errors (TOML) or a calibration (JSON): the machine as built");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
