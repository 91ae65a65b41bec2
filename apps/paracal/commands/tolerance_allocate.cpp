#include <fmt/format.h>

#include <iterator>
#include <memory>

#include "measuring.hpp"
#include "paracal/io/allocation_problem.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/tolerance/allocation.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal::app {
namespace {

struct ToleranceAllocateArguments {
  AngleOption max_tilt, least;
  std::string bound = "sum-of-maxima", least_is = "tolerance", tolerances, problem, toml;
  std::shared_ptr<std::string> report;
};

bool is_general(const ToleranceAllocateArguments& options) { return !options.problem.empty(); }

/// Of the parts that are not chosen.
Tolerances rest_of(const ToleranceAllocateArguments& options, const Robot& robot) {
  return options.tolerances.empty() ? paracal::tolerances_of(robot)
                                    : io::read_tolerances(io::read_stored(options.tolerances), robot);
}

Allocation allocated(const ToleranceAllocateArguments& options, const Tolerances& rest, const Robot& robot) {
  if (is_general(options)) {
    const io::TextFile file = io::read_stored(options.problem);
    const AllocationProblem problem = io::read_allocation_problem(file, rest, robot);
    if (problem.variables.empty()) throw InputFileError(file.name, 0, "expected costs ([cost.NAME]), got none");
    return allocate(robot, problem);
  }
  return allocate(
      robot,
      EqualInfluence{.max_tilt = options.max_tilt.value().value_or(kUsualMaxTilt),
                     .bound = options.bound == "sum-of-maxima" ? Bound::sum_of_maxima : Bound::true_maximum,
                     .least = options.least.value(),
                     .least_reading = options.least_is == "sigma" ? LeastReading::sigma : LeastReading::tolerance,
                     .rest = rest});
}

std::string tilt_group_text(const AngleUnit& angles, const Robot& robot, const Allocation& allocation) {
  const bool in_mrad = angles.per_rad == 1.0;
  std::string text =
      fmt::format("tolerances that affect tilt (half-widths, 3 sigma), {}\n", in_mrad ? "mrad" : angles.name);
  const io::Json group = tilt_group_json(half_widths(allocation.tolerances) / paper_units(robot));
  for (const auto& [key, value] : group.items()) {
    const double shown = value.get<double>() * (in_mrad ? 1e3 : angles.per_rad);
    text += in_mrad ? fmt::format("  {:<25}{:>8.3f}\n", key, shown) : fmt::format("  {:<25}{:>#9.2g}\n", key, shown);
  }
  return text;
}

std::string text_of(const ToleranceAllocateArguments& options, const Robot& robot, const Tolerances& rest,
                    const Allocation& allocation) {
  const AngleUnit angles = options.max_tilt.unit();
  std::string text =
      fmt::format("{}: {}\ncost {:.6g}\n", name(allocation.status),
                  allocation.reason.empty() ? "every limit is kept" : allocation.reason, allocation.cost);
  const auto out = std::back_inserter(text);
  if (!is_general(options)) text += tilt_group_text(angles, robot, allocation);
  for (const RequirementOutcome& one : allocation.requirements) {
    const Shown worst = shown(one.requirement, one.worst.value, angles);
    const Shown limit = shown(one.requirement, one.requirement.limit, angles);
    fmt::format_to(out, "{} ({}): {:.4g} of {:.4g} {} at {}; a limit 1 % wider would save {:.3g}\n",
                   name(one.requirement.characteristic), name(one.requirement.criterion), worst.value, limit.value,
                   worst.unit, pose_text(robot, one.worst.pose), 0.01 * one.price * one.requirement.limit);
  }
  if (allocation.failures) text += failure_line(*allocation.failures);
  if (allocation.failure_price > 0.0)
    text += fmt::format("  twice the failure rate would save about {:.3g}\n", allocation.failure_price);
  return text + assumed_lines(allocation.tolerances.assumed) + "\n" +
         io::tolerances_toml(rounded_down(robot, allocation.tolerances, rest), robot);
}

io::Json json_of(const ToleranceAllocateArguments& options, const Robot& robot, const Allocation& allocation) {
  io::Json json{{"status", name(allocation.status)}, {"reason", allocation.reason}, {"cost", allocation.cost}};
  if (robot.is_level()) {
    json["tolerances"] = tilt_group_json(half_widths(allocation.tolerances) / paper_units(robot));
  }
  if (!is_general(options)) {
    json["bound"] = options.bound;
    json["max_tilt_3sigma"] = options.max_tilt.value().value_or(kUsualMaxTilt);
  }
  add_half_widths(json, robot, allocation.tolerances);
  json["requirements"] = io::json_array(allocation.requirements, [&](const RequirementOutcome& one) {
    const Characteristic what = one.requirement.characteristic;
    const double factor = shown(what.quantity, 1.0).value;
    io::Json entry{{"quantity", name(what)}, {"criterion", name(one.requirement.criterion)}};
    entry["limit_" + std::string(shown(what.quantity, 0.0).unit)] = factor * one.requirement.limit;
    entry["worst_" + std::string(shown(what.quantity, 0.0).unit)] = factor * one.worst.value;
    entry["worst_pose"] = io::to_json(one.worst.pose, robot.commands_tilt());
    entry["price"] = one.price / factor;
    return entry;
  });
  if (allocation.failures) {
    json["failure"] = io::to_json(*allocation.failures);
    json["failure_price"] = allocation.failure_price;
  }
  json["assumed"] = allocation.tolerances.assumed;
  return json;
}

void write_page(const ToleranceAllocateArguments& options, Session& session, const Robot& robot,
                const Allocation& allocation) {
  const Characteristic tilt{Quantity::tilt};
  write_report(*options.report, session, robot,
               {.kind = "allocation",
                .results = {{"allocation", json_of(options, robot, allocation)}},
                .figures = {{"sigma_map", three_sigma_json(robot, tilt, allocation.tolerances)}},
                .inputs = with_files({}, session, {options.tolerances, options.problem})});
}

void run(const ToleranceAllocateArguments& options, Session& session) {
  const Robot robot = session.robot();
  if (!is_general(options)) require_level(robot, "tolerance allocate without --problem");
  const Tolerances rest = rest_of(options, robot);
  const Allocation allocation = allocated(options, rest, robot);
  if (!options.toml.empty() && allocation.ok())
    session.outputs.store.write(options.toml, io::tolerances_toml(allocation.tolerances, robot));
  if (!allocation.ok()) session.exit_code = kVerdictIsNo;
  if (!options.report->empty()) write_page(options, session, robot, allocation);
  session.json() ? session.print_json(json_of(options, robot, allocation))
                 : session.print(text_of(options, robot, rest, allocation));
}

}  // namespace

void add_tolerance_allocate(Command& tolerance, Session& session) {
  Command* command = session.add_command(tolerance, "allocate", "Design tolerances",
                                         "compute the widest tolerances that keep a limit");
  const auto options = std::make_shared<ToleranceAllocateArguments>();
  const std::array tilt =
      add_angle_options(*command, options->max_tilt, "--max-tilt", "--max-tilt", "limit on the plate's tilt (3 sigma)");
  tilt.front()->shows_default(fmt::format("{}", kUsualMaxTilt));
  command->heading("Result");
  session.outputs.declare(
      command->add_option("--toml", options->toml, "write the tolerances to this file, for --tolerances"));
  options->report = add_report_option(*command, session);
  command->heading("Problem");
  Option* bound =
      command
          ->add_option("--bound", options->bound,
                       "how the largest tilt is computed: sum-of-maxima as in the paper's Table 2; true-maximum "
                       "allows about 10 % wider tolerances")
          ->check(one_of({"sum-of-maxima", "true-maximum"}));
  const std::array least = add_angle_options(*command, options->least, "--least", "--least",
                                             "tightest tolerance that can be made (paper: 0.0002)");
  command->add_option("--least-is", options->least_is, "quantity that --least bounds: the tolerance (3 sigma) or sigma")
      ->check(one_of({"tolerance", "sigma"}));
  command->add_option("--tolerances", options->tolerances,
                      "tolerances of the parts that are not chosen (TOML; default: the robot's)");
  Option* problem =
      command->add_option("--problem", options->problem, "requirements, costs and bounds (TOML; see docs/tolerance.md)")
          ->excludes(bound);
  for (Option* one : tilt) problem->excludes(one);
  for (Option* one : least) problem->excludes(one);
  command->example("The paper's Table 2",
                   "paracal tolerance allocate --robot huang2016 --max-tilt 0.001 --toml chosen.toml");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
