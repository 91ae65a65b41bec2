#include "paracal/tolerance/sensitivity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <memory>

#include "measuring.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/units.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal::app {
namespace {

struct SensitivityArguments {
  std::string quantity = "tilt", tolerances, map;
  std::vector<double> pose;
  bool all_rotations = false;
  double error = 1e-3;
  std::shared_ptr<std::string> report;
};

/// A map's rows: a layer is a z and a rotation or a tilt.
std::string map_csv(const Robot& robot, const Characteristic& what, const std::vector<ValueAtPose>& map) {
  const bool tilts = robot.commands_tilt();
  std::string text = fmt::format("x_mm,y_mm,z_mm,{},radius_mm,three_sigma_{}\n",
                                 tilts ? "tilt_x_deg,tilt_y_deg,tilt_z_deg" : "phi_deg", json_key(what));
  const auto out = std::back_inserter(text);
  for (const auto& [pose, sigma] : map) {
    const Eigen::Vector3d& r = pose.position;
    fmt::format_to(out, "{:.6g},{:.6g},{:.6g},", r.x(), r.y(), r.z());
    if (!tilts) fmt::format_to(out, "{:.6g},", to_degrees(pose.rotation));
    for (Eigen::Index k = 0; tilts && k < 3; ++k) fmt::format_to(out, "{:.6g},", to_degrees(pose.tilt(k)));
    fmt::format_to(out, "{:.6g},{:.9g}\n", std::hypot(r.x(), r.y()), 3.0 * shown(what.quantity, sigma).value);
  }
  return text;
}

/// How a source's sensitivity is shown: the factor, and the unit that it then has.
struct Scale {
  double factor = 1.0;
  std::string unit;
  bool over_width = false;  ///< of lengths over the parallelogram's width
};

/// Tilt in the paper's units, rad per rad, but of a plate with six freedoms, which lengths tilt.
Scale scale_of(const Robot& robot, Quantity quantity, Source source) {
  const double factor = shown(quantity, 1.0).value;
  const Unit of_source = unit(source, robot.actuator());
  const std::string_view per = of_source == Unit::rad ? "rad" : file_unit(of_source);
  if (unit(quantity) == Unit::mm || quantity == Quantity::rotation) {
    return {factor, fmt::format("{} per {}", shown(quantity, 0.0).unit, per)};
  }
  if (!robot.is_level()) return {1e3 * factor, fmt::format("mrad per {}", per)};
  const double size = paper_units(robot)(place(source));
  return {factor * size, "rad per rad", size != 1.0};
}

std::string text_of(const Robot& robot, const SensitivityFindings& found) {
  std::string text = fmt::format("sensitivity of {} over the workspace ({} poses): mean, largest{}\n", name(found.what),
                                 found.global.poses, found.local ? ", at the pose" : "");
  const auto out = std::back_inserter(text);
  for (const Source source : sources_of(robot.limbs())) {
    const Eigen::Index k = place(source);
    if (found.global.largest(k) == 0.0) continue;
    const auto [factor, unit, over_width] = scale_of(robot, found.what.quantity, source);
    fmt::format_to(out, "  {:<21}{:>10.4f} +- {:<8.1g}{:>10.4f}",
                   fmt::format("{}{}", name(source), over_width ? " / c" : ""), factor * found.global.mean(k),
                   factor * found.global.error(k), factor * found.global.largest(k));
    if (found.local) fmt::format_to(out, "{:>10.4f}", factor * (*found.local)(k));
    fmt::format_to(out, "  {}\n", unit);
  }
  const Shown worst = shown(found.what.quantity, found.worst.value);
  fmt::format_to(out, "largest 3 sigma with these tolerances: {:.4g} {} at {}\n", worst.value, worst.unit,
                 pose_text(robot, found.worst.pose));
  fmt::format_to(out, "contributions to its variance:\n{}", pareto(found.contributors));
  return text + assumed_lines(found.tolerances.assumed) + "\n" + io::tolerances_toml(found.tolerances, robot);
}

void write_page(const SensitivityArguments& options, Session& session, const Robot& robot,
                const SensitivityFindings& found, const Tolerances& tolerances) {
  write_report(*options.report, session, robot,
               {.kind = "sensitivity",
                .results = {{"sensitivity", sensitivity_json(robot, found)}},
                .figures = {{"sigma_map", three_sigma_json(robot, found.what, tolerances)}},
                .inputs = with_files({}, session, {options.tolerances})});
}

void run(const SensitivityArguments& options, Session& session) {
  const Robot robot = session.robot();
  const Characteristic what = *characteristic_named(options.quantity);
  std::optional<Pose> pose;
  if (!options.pose.empty()) pose = pose_of_option(robot, "--pose", options.pose);
  const Tolerances tolerances = tolerances_of(robot, options.tolerances);
  SensitivityFindings found = find_sensitivity(
      robot, what, tolerances, {.all_rotations = options.all_rotations, .relative_error = options.error});
  if (pose) found.local = squared_sensitivities(robot, LinearModel(robot).rows(*pose, what)).sqrt();
  if (!options.map.empty()) {
    session.outputs.store.write(
        options.map,
        map_csv(robot, what,
                sigma_map(robot, what, tolerances, {.radii = 20, .azimuths = 72, .layers = 5}, options.all_rotations)));
  }
  if (!options.report->empty()) write_page(options, session, robot, found, tolerances);
  session.json() ? session.print_json(sensitivity_json(robot, found)) : session.print(text_of(robot, found));
}

}  // namespace

void add_sensitivity(Command& program, Session& session) {
  Command* command = session.add_command(program, "sensitivity", "Design tolerances",
                                         "show how strongly each error acts: at a pose and over the workspace");
  const auto options = std::make_shared<SensitivityArguments>();
  command
      ->add_option(
          "--quantity", options->quantity,
          "tilt, twist, position, distance or rotation; with -compensated: after compensation of the position group")
      ->takes("QUANTITY")
      ->check(characteristic_validator());
  command
      ->add_option("--pose", options->pose,
                   "also show local sensitivities at this pose (mm, deg; or x,y,z and three tilts)")
      ->lists("X,Y,Z[,PHI]", 3, 6);
  command->add_option("--tolerances", options->tolerances,
                      "tolerances for contributions and map (TOML; default: the robot's)");
  command->add_flag("--all-rotations", options->all_rotations,
                    "average over phi or tilts, too (default: phi = 0 and level, as in the paper)");
  command->add_option("--error", options->error, "relative error of the means")->check(positive());
  session.outputs.declare(
      command->add_option("--map", options->map, "write 3 sigma at five heights of the workspace (CSV)"));
  options->report = add_report_option(*command, session);
  command->example("Tilt of the published robot", "paracal sensitivity --robot huang2016");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
