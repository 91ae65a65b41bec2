#include <fmt/format.h>

#include <memory>

#include "paracal/kinematics/error_model.hpp"
#include "paracal/tolerance/characteristic.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

/// How the paper writes the column of a source: scaled to mm (position group) or rad (tilt group).
std::string column_name(const Robot& robot, const Parameter& one) {
  std::string plain(name(one.source));
  if (!robot.is_level()) return plain;
  if (tilts_plate(one.source)) return one.unit == Unit::mm ? plain + "/c" : plain;
  if (one.unit != Unit::rad) return plain;
  return (runs_on_rail(robot.actuator()) ? "l*" : "L*") + plain;
}

template <typename Task>
void for_columns(const Robot& robot, bool tilt_group, Task&& task) {
  for (const Parameter& one : robot.parameters()) {
    if ((robot.is_level() && tilts_plate(one.source)) == tilt_group) task(one);
  }
}

io::Json parameters_json(const Robot& robot) {
  io::Json groups;
  const auto unit_of = [&](const Parameter& one) {
    if (!robot.is_level()) return file_unit(one.unit);
    return tilts_plate(one.source) ? std::string_view("rad") : std::string_view("mm");
  };
  for (const bool tilt_group : {false, true}) {
    io::Json columns = io::Json::array();
    for_columns(robot, tilt_group, [&](const Parameter& one) {
      columns.push_back({{"limb", one.limb + 1},
                         {"name", name(one.source)},
                         {"column", column_name(robot, one)},
                         {"unit", unit_of(one)}});
    });
    groups[tilt_group ? "tilt" : "position"] = columns;
  }
  return groups;
}

std::string matrix_text(const std::string& title, const Robot& robot, bool tilt_group,
                        const std::vector<std::string>& rows, const Eigen::MatrixXd& matrix) {
  std::string text = title + "\n" + fmt::format("  {:<24}", "");
  for (const std::string& row : rows) text += fmt::format("{:>12}", row);
  Eigen::Index column = 0;
  for_columns(robot, tilt_group, [&](const Parameter& one) {
    text += fmt::format("\n  limb {} {:<17}", one.limb + 1, column_name(robot, one));
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) text += fmt::format("{:>12.5f}", matrix(row, column));
    ++column;
  });
  return text + "\n\n";
}

std::string report(const Robot& robot, const ErrorModel& model) {
  std::vector<std::string> delta{"dx", "dy", "dz"};
  if (robot.slide()) delta.emplace_back("ds");
  return matrix_text("G_dd: mm of plate per mm of source error", robot, false, delta, model.G_dd) +
         matrix_text("G_de: mm of plate per rad of source error", robot, true, delta, model.G_de) +
         matrix_text("G_ee: rad of tilt per rad of source error", robot, true, {"tilt_x", "tilt_y", "tilt_z"},
                     model.G_ee);
}

/// Per unit of files.
Eigen::MatrixXd by_file_unit(const Robot& robot, Eigen::MatrixXd columns) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    columns.col(k) *= from_file_unit(robot.parameters()[static_cast<std::size_t>(k)].unit, 1.0);
  }
  return columns;
}

io::Json head(const Robot& robot, const Pose& pose) {
  return {{"robot", robot.name()},
          {"pose", io::to_json(pose, robot.commands_tilt())},
          {"parameters", parameters_json(robot)}};
}

/// All errors move and turn a plate with six degrees of freedom; one matrix describes both.
void run_with_six_freedoms(const Robot& robot, const Pose& pose, Session& session) {
  const LinearModel model(robot);
  const Eigen::MatrixXd motion = by_file_unit(robot, model.rows(pose, {Quantity::position}));
  const Eigen::MatrixXd turn = by_file_unit(robot, model.turns(pose));
  if (session.json()) {
    io::Json json = head(robot, pose);
    json["G_position"] = io::rows_json(motion);
    json["G_turn"] = io::rows_json(turn);
    return session.print_json(json);
  }
  session.print(
      matrix_text("mm of plate per mm, deg or mm/m of source error", robot, false, {"dx", "dy", "dz"}, motion) +
      matrix_text("mrad of plate, about x, y and z of the base, per mm, deg or mm/m of source error", robot, false,
                  {"turn_x", "turn_y", "turn_z"}, 1e3 * turn));
}

void run(const std::vector<double>& numbers, Session& session) {
  const Robot robot = session.robot();
  const Pose pose = pose_of_option(robot, "--pose", numbers);
  if (!robot.is_level()) return run_with_six_freedoms(robot, pose, session);
  const ErrorModel model = error_model(robot, pose);
  if (model.status == ErrorModelStatus::unreachable) {
    throw MathematicsSaysNo(fmt::format("pose: no solution: {} cannot reach ({:g}, {:g}, {:g}) mm at {:g} deg",
                                        robot.name(), numbers[0], numbers[1], numbers[2], to_degrees(pose.rotation)));
  }
  if (!model.ok()) {
    throw MathematicsSaysNo(fmt::format(
        "pose: no solution: the robot is singular there (reciprocal conditions {:.1e} and {:.1e}, limit {:.0e})",
        model.condition_dd, model.condition_ee, ErrorModel::kSmallestCondition));
  }
  if (!session.json()) return session.print(report(robot, model));
  io::Json json = head(robot, pose);
  json["G_dd"] = io::rows_json(model.G_dd);
  json["G_de"] = io::rows_json(model.G_de);
  json["G_ee"] = io::rows_json(model.G_ee);
  session.print_json(json);
}

}  // namespace

void add_error_model(Command& program, Session& session) {
  Command* command =
      session.add_command(program, "error-model", "Error model", "show how errors move and tilt the plate at a pose");
  const auto pose = std::make_shared<std::vector<double>>();
  command
      ->add_option(
          "--pose", *pose,
          "pose in mm and deg; six numbers x,y,z and three tilts for six degrees of freedom; angles may be omitted")
      ->lists("X,Y,Z[,PHI]", 3, 6)
      ->required();
  command->example("At one pose of the published robot",
                   "paracal error-model --robot huang2016 --pose 200,-130,-930,30");
  command->callback([&session, pose] { run(*pose, session); });
}

}  // namespace paracal::app
