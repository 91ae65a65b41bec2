#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "paracal/kinematics/error_model.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

/// How the paper writes the column of a source: scaled to mm (position group) or rad (tilt group).
std::string column_name(const Robot& robot, Source source) {
  std::string plain(name(source));
  const bool on_rail = robot.actuator() == Actuator::linear;
  switch (source) {
    case Source::theta_offset:
      return on_rail ? plain : "L*" + plain;
    case Source::alpha0:
    case Source::beta0:
      return (on_rail ? "l*" : "L*") + plain;
    case Source::rod_difference:
    case Source::width_difference:
      return plain + "/c";
    default:
      return plain;
  }
}

template <typename Task>
void for_columns(const Robot& robot, bool tilt_group, Task&& task) {
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
      if (tilts_plate(source) == tilt_group) task(limb + 1, source);
    }
  }
}

io::Json parameters_json(const Robot& robot) {
  io::Json groups;
  for (const bool tilt_group : {false, true}) {
    io::Json columns = io::Json::array();
    for_columns(robot, tilt_group, [&](std::size_t limb, Source source) {
      columns.push_back({{"limb", limb},
                         {"name", name(source)},
                         {"column", column_name(robot, source)},
                         {"unit", tilt_group ? "rad" : "mm"}});
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
  for_columns(robot, tilt_group, [&](std::size_t limb, Source source) {
    text += fmt::format("\n  limb {} {:<17}", limb, column_name(robot, source));
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

Pose pose_of(const std::vector<double>& numbers) {
  return {{numbers[0], numbers[1], numbers[2]}, numbers.size() > 3 ? to_radians(numbers[3]) : 0.0};
}

void run(const std::vector<double>& numbers, Session& session) {
  for (const double number : numbers) {
    if (!std::isfinite(number)) throw WrongUsage(fmt::format("--pose: expected finite numbers, got {}", number));
  }
  const Robot robot = session.level_robot("error-model");
  const Pose pose = pose_of(numbers);
  const ErrorModel model = error_model(robot, pose);
  if (model.status == ErrorModelStatus::unreachable) {
    throw MathematicsSaysNo(fmt::format("pose: {} does not reach ({:g}, {:g}, {:g}) mm at {:g} deg", robot.name(),
                                        numbers[0], numbers[1], numbers[2], to_degrees(pose.rotation)));
  }
  if (!model.ok()) {
    throw MathematicsSaysNo(
        fmt::format("pose: the robot is singular there (reciprocal conditions {:.1e} and {:.1e}, limit {:.0e})",
                    model.condition_dd, model.condition_ee, ErrorModel::kSmallestCondition));
  }
  if (!session.json()) return session.print(report(robot, model));
  session.print_json(io::Json{
      {"robot", robot.name()},
      {"pose",
       {{"x_mm", numbers[0]}, {"y_mm", numbers[1]}, {"z_mm", numbers[2]}, {"phi_deg", to_degrees(pose.rotation)}}},
      {"parameters", parameters_json(robot)},
      {"G_dd", io::rows_json(model.G_dd)},
      {"G_de", io::rows_json(model.G_de)},
      {"G_ee", io::rows_json(model.G_ee)}});
}

}  // namespace

void add_error_model(Command& program, Session& session) {
  Command* command =
      session.add_command(program, "error-model", "Error model", "how source errors move and tilt the plate at a pose");
  const auto pose = std::make_shared<std::vector<double>>();
  command->add_option("--pose", *pose, "x,y,z,phi in mm and deg (phi may be left out)")
      ->required()
      ->separated_by(',')
      ->expected(3, 4);
  command->callback([&session, pose] { run(*pose, session); });
}

}  // namespace paracal::app
