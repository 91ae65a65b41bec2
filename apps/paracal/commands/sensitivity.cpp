#include "paracal/tolerance/sensitivity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <memory>

#include "measuring.hpp"
#include "paracal/io/file.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/units.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal::app {
namespace {

struct Options {
  std::string quantity = "tilt", tolerances, map;
  std::vector<double> pose;
  bool all_rotations = false;
  double error = 1e-3;
  std::shared_ptr<std::string> report;
};

/// A map's rows: a layer is a z and a rotation.
std::string map_csv(const Characteristic& what, const std::vector<ValueAtPose>& map) {
  std::string text = fmt::format("x_mm,y_mm,z_mm,phi_deg,radius_mm,three_sigma_{}\n", json_key(what));
  for (const ValueAtPose& point : map) {
    const Eigen::Vector3d& r = point.pose.position;
    fmt::format_to(std::back_inserter(text), "{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.9g}\n", r.x(), r.y(), r.z(),
                   to_degrees(point.pose.rotation), std::hypot(r.x(), r.y()),
                   3.0 * shown(what.quantity, point.value).value);
  }
  return text;
}

std::string text_of(const Robot& robot, const SensitivityFindings& found) {
  const bool tilt = found.what.quantity == Quantity::tilt || found.what.quantity == Quantity::twist;
  const PerSource unit_size = tilt ? paper_units(robot) : PerSource::Ones();
  std::string text = fmt::format("sensitivity of {} over the workspace ({} poses), mean and largest{}\n",
                                 name(found.what), found.global.poses, found.local ? ", and at the pose" : "");
  const auto out = std::back_inserter(text);
  for (const Source source : all_sources()) {
    const Eigen::Index k = place(source);
    if (found.global.largest(k) == 0.0) continue;
    const bool over_width = tilt && unit_size(k) != 1.0;
    const std::string unit = tilt ? "rad per rad"
                                  : fmt::format("{} per {}", shown(found.what.quantity, 0.0).unit,
                                                paracal::unit(source, robot.actuator()) == Unit::mm ? "mm" : "rad");
    const double to_screen = shown(found.what.quantity, 1.0).value * unit_size(k);
    fmt::format_to(out, "  {:<21}{:>10.4f} +- {:<8.1g}{:>10.4f}",
                   fmt::format("{}{}", name(source), over_width ? " / c" : ""), to_screen * found.global.mean(k),
                   to_screen * found.global.error(k), to_screen * found.global.largest(k));
    if (found.local) fmt::format_to(out, "{:>10.4f}", to_screen * (*found.local)(k));
    fmt::format_to(out, "  {}\n", unit);
  }
  const Shown worst = shown(found.what.quantity, found.worst.value);
  fmt::format_to(out, "largest 3 sigma with the tolerances: {:.4g} {} at {}\n", worst.value, worst.unit,
                 pose_text(found.worst.pose));
  fmt::format_to(out, "what makes it, share of the variance:\n{}", pareto(found.contributors));
  return text + assumed_lines(found.assumed);
}

void write_page(const Options& options, Session& session, const Robot& robot, const SensitivityFindings& found,
                const Tolerances& tolerances) {
  write_report(*options.report, session, robot,
               {.kind = "sensitivity",
                .results = {{"sensitivity", sensitivity_json(robot, found)}},
                .figures = {{"sigma_map", three_sigma_json(robot, found.what, tolerances)}},
                .inputs = with_files({}, session, {options.tolerances})});
}

void run(const Options& options, Session& session) {
  const Robot robot = session.level_robot("sensitivity");
  const Tolerances tolerances = tolerances_of(robot, options.tolerances);
  SensitivityFindings found =
      find_sensitivity(robot, *characteristic_named(options.quantity), tolerances,
                       {.all_rotations = options.all_rotations, .relative_error = options.error});
  if (!options.pose.empty()) {
    const Pose pose{{options.pose[0], options.pose[1], options.pose[2]}, to_radians(options.pose[3])};
    found.local = squared_sensitivities(LinearModel(robot).rows(pose, found.what)).sqrt();
  }
  if (!options.map.empty()) {
    session.outputs.write(
        options.map, map_csv(found.what, sigma_map(robot, found.what, tolerances,
                                                   {.radii = 20, .azimuths = 72, .layers = 5}, options.all_rotations)));
  }
  if (!options.report->empty()) write_page(options, session, robot, found, tolerances);
  session.json() ? session.print_json(sensitivity_json(robot, found)) : session.print(text_of(robot, found));
}

}  // namespace

void add_sensitivity(Command& program, Session& session) {
  Command* command =
      session.add_command(program, "sensitivity", "Design tolerances",
                          "how much each source error matters: at a pose, over the workspace, and where");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("--quantity", options->quantity,
                   "of what: tilt, twist, position, distance, rotation; "
                   "position-compensated: after the position group is compensated")
      ->check(characteristic_validator())
      ->shows_default();
  command->add_option("--pose", options->pose, "local sensitivities here, too: x,y,z,phi (mm, deg)")
      ->separated_by(',')
      ->expected(4);
  command->add_option("--tolerances", options->tolerances, "for contributors and map (TOML); default: the robot's");
  command->add_flag("--all-rotations", options->all_rotations, "mean over phi, too; the paper's is at phi = 0");
  command->add_option("--error", options->error, "refine the quadrature until the means have settled to this share")
      ->check(positive_finite())
      ->shows_default();
  session.outputs.declare(command->add_option("--map", options->map, "write 3 sigma over five layers here (CSV)"));
  options->report = add_report_option(*command, session);
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
