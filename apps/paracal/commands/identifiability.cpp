#include <fmt/format.h>

#include <iterator>
#include <memory>

#include "calibration/fit/null_space.hpp"
#include "calibration/verdict/parameter_table.hpp"
#include "measuring.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/units.hpp"
#include "session.hpp"
#include "settings.hpp"

namespace paracal::app {
namespace {

struct IdentifiabilityArguments {
  io::TableStyle style;
  Settings<io::PlanSettings> settings;
  PlanningOptions plan;
  std::string poses;
};

Measurements plan_of(const Robot& robot, const IdentifiabilityArguments& options) {
  return planned(robot, io::read_poses(input_table(options.poses, options.style), robot.joint_space()),
                 options.plan.planned());
}

/// Rotations between poses do not see the zero of phi. Where it is known, home is one reading more; the point that
/// comes with it says nothing, in a frame that need not be found.
Identifiability seen_by(const Robot& robot, Measurements plan, CalibrationOptions calibration) {
  if (plan.distances.empty() || calibration.rotation_zero == RotationZero::unknown) {
    return identifiability(robot, plan, calibration);
  }
  constexpr double kNothing = 1e20;  // mm
  const Pose& home = plan.stations.front().commanded;
  plan.series = {{"home", {{.point = home.position, .rotation = home.rotation, .sigma = kNothing}}}};
  calibration.frame = Frame::robot;
  Identifiability seen = identifiability(robot, plan, calibration);
  seen.rows -= 3;
  return seen;
}

CalibrationOptions calibration_options(const IdentifiabilityArguments& options, const Robot& robot) {
  CalibrationOptions calibration;
  options.settings.put_into(calibration, robot);
  const Measurand measurand = options.plan.readings.measurand;
  const bool points = measurand == Measurand::coordinates || measurand == Measurand::poses;
  if (!points) calibration.frame = Frame::unknown;
  calibration.reflectors = options.plan.readings.mount;
  calibration.rotation_zero = options.plan.rotation_zero();
  return calibration;
}

/// What the plan promises of one parameter.
struct Promise {
  SoughtSource parameter;
  double std;
};

std::vector<Promise> promises(const KnownErrors& after, const std::vector<SoughtSource>& wanted) {
  std::vector<Promise> list;
  for (std::size_t k = 0; k < after.parameters.size(); ++k) {
    for (const SoughtSource& one : wanted) {
      if (one.limb != after.parameters[k].limb || one.source != after.parameters[k].source) continue;
      const auto i = static_cast<Eigen::Index>(k);
      list.push_back({after.parameters[k], std::sqrt(after.covariance(i, i))});
    }
  }
  return list;
}

/// Standard deviations, a row a limb.
std::string deviations(const Robot& robot, const std::vector<Promise>& list) {
  std::vector<detail::ParameterCell> cells;
  const auto add = [&](const std::string& row, const SoughtSource& of, double std, const char* mark) {
    const Unit inside = paracal::unit(of.source, robot.actuator());
    const double shown = to_file_unit(inside, std);
    cells.push_back({row, fmt::format("{} {} ", name(of.source), file_unit(inside)),
                     fmt::format("{:.{}f}{}", shown, detail::decimals_of(shown), mark)});
  };
  for (const Promise& one : list) add("before", one.parameter, one.parameter.prior_std.value_or(0.0), " ");
  for (const Promise& one : list) {
    const double before = one.parameter.prior_std.value_or(0.0);
    const bool mostly_prior = one.std * one.std > 0.5 * before * before;
    add(detail::limb_row(one.parameter.limb), one.parameter, one.std, mostly_prior ? "*" : " ");
  }
  const std::string table = detail::parameter_table(cells);
  return "standard deviations after measuring (before: from the tolerances)\n" + table +
         (table.find('*') == std::string::npos ? ""
                                               : "  * mostly from the prior: the measurements give less than 50 %\n");
}

std::string text_of(const Robot& robot, const Identifiability& seen, const std::vector<Promise>& list,
                    const WorkspaceUncertainty& spread) {
  std::string text =
      fmt::format("{} readings determine {} of {} parameters\n", seen.rows, seen.rank, seen.parameters.size()) +
      detail::undetermined_lines(seen.null_space);
  const auto out = std::back_inserter(text);
  const Observability& o = seen.indices;
  fmt::format_to(out, "  O1 {:.4g}  O2 {:.4g}  O3 {:.4g}  O4 {:.4g}  O5 {:.4g}\n", o.O1, o.O2, o.O3, o.O4, o.O5);
  text += deviations(robot, list);
  fmt::format_to(out,
                 "over the workspace (largest): distance to home {:.3f} mm, aligned position {:.3f} mm, "
                 "rotation {:.3f} deg\n",
                 spread.max_distance, spread.max_aligned, to_degrees(spread.max_rotation));
  return text + assumed_lines(tolerances_of(robot).assumed);
}

io::Json json_of(const Robot& robot, const Identifiability& seen, const std::vector<Promise>& list,
                 const WorkspaceUncertainty& spread) {
  io::Json json{{"rank", seen.rank}, {"rows", seen.rows}, {"parameters", io::Json::array()}};
  for (const Promise& one : list) {
    const double before = one.parameter.prior_std.value_or(0.0);
    const Unit unit = paracal::unit(one.parameter.source, robot.actuator());
    json["parameters"].push_back({{"name", name(one.parameter.source)},
                                  {"limb", one.parameter.limb + 1},
                                  {"unit", file_unit(unit)},
                                  {"prior_std", to_file_unit(unit, before)},
                                  {"std", to_file_unit(unit, one.std)},
                                  {"data_share", 1.0 - one.std * one.std / (before * before)}});
  }
  json["null_space"] = io::json_array(seen.null_space, [](const NullDirection& one) {
    return io::Json{{"text", one.text}, {"direction", io::json_array(one.direction)}};
  });
  json["singular_values"] = io::json_array(seen.singular_values);
  add_indices(json, seen.indices);
  json["workspace_std"] = workspace_json(spread);
  json["assumed"] = tolerances_of(robot).assumed;
  return json;
}

void run(const IdentifiabilityArguments& options, Session& session) {
  const Robot robot = session.robot({.tables = {options.poses}});
  const Measurements plan = plan_of(robot, options);
  const CalibrationOptions calibration = calibration_options(options, robot);
  const Identifiability seen = seen_by(robot, plan, calibration);
  const KnownErrors after = promised(robot, plan, calibration);
  const WorkspaceUncertainty spread =
      PoseSpread(robot, {}, after.parameters, workspace_stations(robot)).uncertainty(after.covariance);
  const std::vector<Promise> list = promises(after, seen.parameters);
  session.json() ? session.print_json(json_of(robot, seen, list, spread))
                 : session.print(text_of(robot, seen, list, spread));
}

}  // namespace

void add_identifiability(Command& program, Session& session) {
  Command* command = session.add_command(program, "identifiability", "Calibrate a machine",
                                         "predict what a measurement plan can determine, before measuring");
  const auto options = std::make_shared<IdentifiabilityArguments>();
  command->add_option("--poses", options->poses, "poses of the plan (CSV)")->required();
  add_table_options(*command, options->style);
  command->heading("Measurement");
  add_planning_options(*command, options->plan);
  add_rotation_options(*command, options->plan, {"none", "relative", "absolute"});
  command->add_flag("--second", options->plan.readings.second, "a second reflector is measured, too; it shows tilt");
  options->settings.declare(*command);
  command->example("Check a plan", "paracal identifiability --poses plan.csv");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
