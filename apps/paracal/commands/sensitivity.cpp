#include "paracal/tolerance/sensitivity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <memory>

#include "paracal/io/file.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/units.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal::app {
namespace {

struct Options {
  std::string quantity = "tilt", tolerances, map;
  std::vector<double> pose;
  bool all_rotations = false;
  double error = 1e-3;
};

/// What the command found.
struct Findings {
  Characteristic what = {};
  GlobalSensitivity global = {};
  std::optional<PerSource> local = {};
  ValueAtPose worst = {};  ///< largest 3 sigma
  std::vector<Contributor> contributors = {};
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

std::string text_of(const Robot& robot, const Findings& found) {
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
                                                paracal::unit(source) == Unit::mm ? "mm" : "rad");
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
  return text;
}

/// By source: of tilt in the paper's units under the contract's six keys, of anything else per mm or rad.
io::Json per_source_json(const Robot& robot, Quantity quantity, const PerSource& values) {
  if (quantity == Quantity::tilt) return tilt_group_json(values * paper_units(robot));
  io::Json json = io::Json::object();
  for (const Source source : all_sources()) {
    json[std::string(name(source))] = shown(quantity, values(place(source))).value;
  }
  return json;
}

io::Json json_of(const Robot& robot, const Findings& found) {
  const Quantity quantity = found.what.quantity;
  const auto of = [&](const PerSource& values) { return per_source_json(robot, quantity, values); };
  io::Json json{{"quantity", name(found.what)},
                {"poses", found.global.poses},
                {"global", of(found.global.mean)},
                {"global_error", of(found.global.error)},
                {"largest", of(found.global.largest)}};
  if (found.local) json["local"] = of(*found.local);
  json["worst"] = io::to_json(found.worst.pose);
  json["worst"]["three_sigma_" + json_key(found.what)] = shown(quantity, found.worst.value).value;
  json["contributors"] = contributors_json(found.contributors);
  return json;
}

void run(const Options& options, const Session& session) {
  const Robot robot = session.robot();
  const Tolerances tolerances = tolerances_of(robot, options.tolerances);
  const LinearModel model(robot);
  Findings found{.what = *characteristic_named(options.quantity)};
  found.global =
      global_sensitivity(robot, found.what, {.all_rotations = options.all_rotations, .relative_error = options.error});
  if (!options.pose.empty()) {
    const Pose pose{{options.pose[0], options.pose[1], options.pose[2]}, to_radians(options.pose[3])};
    found.local = squared_sensitivities(model.rows(pose, found.what)).sqrt();
  }
  found.worst = worst_spread(robot, found.what, tolerances, Spread::statistical);
  found.contributors = contributors(model.rows(found.worst.pose, found.what), tolerances);
  if (!options.map.empty()) {
    io::write_file(options.map,
                   map_csv(found.what, sigma_map(robot, found.what, tolerances,
                                                 {.radii = 20, .azimuths = 72, .layers = 5}, options.all_rotations)));
  }
  session.json() ? session.print_json(json_of(robot, found)) : session.print(text_of(robot, found));
}

}  // namespace

void add_sensitivity(CLI::App& app, Session& session) {
  CLI::App* command =
      session.add_command(app, "sensitivity", "Design tolerances",
                          "how much each source error matters: at a pose, over the workspace, and where");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("--quantity", options->quantity,
                   "of what: tilt, twist, position, distance, rotation; "
                   "position-compensated: after the position group is compensated")
      ->check(characteristic_validator())
      ->capture_default_str();
  command->add_option("--pose", options->pose, "local sensitivities here, too: x,y,z,phi (mm, deg)")
      ->delimiter(',')
      ->expected(4);
  command->add_option("--tolerances", options->tolerances, "for contributors and map (TOML); default: the robot's");
  command->add_flag("--all-rotations", options->all_rotations, "mean over phi, too; the paper's is at phi = 0");
  command->add_option("--error", options->error, "refine the quadrature until the means have settled to this share")
      ->check(positive_finite())
      ->capture_default_str();
  command->add_option("--map", options->map, "write 3 sigma over five layers here (CSV)");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
