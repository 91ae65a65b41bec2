#include <fmt/format.h>

#include <array>
#include <iterator>
#include <memory>

#include "interruption.hpp"
#include "long_job.hpp"
#include "measuring.hpp"
#include "paracal/io/allocation_problem.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/tolerance/analysis.hpp"
#include "paracal/tolerance/failure.hpp"
#include "progress_line.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "tolerancing.hpp"
#include "usage.hpp"

namespace paracal::app {
namespace {

struct ToleranceAnalyzeArguments {
  std::string tolerances, problem, model = "linear";
  AngleOption max_tilt;
  MonteCarloOptions monte_carlo;
  double failure_error = FailureOptions{}.relative_error;
  int sobol = 0;
  bool linearity = false;
  LongJobOptions job;
  std::optional<double> min_yield;
  std::shared_ptr<std::string> report;
};

constexpr std::array<double, 4> kPercentiles{0.5, 0.9, 0.95, 0.99};

struct Findings {
  Tolerances tolerances;
  std::vector<RequirementAnalysis> analyses;
  MonteCarlo batch = {};
  FailureShare failures = {};              ///< of any limit
  std::vector<FailureShare> of_each = {};  ///< of each limit, where there are several
  bool partial = false;                    ///< stopped by its user
  std::string missing_parts = {};          ///< of the job, which others compute: then there is no result yet

  Proportion yield(double confidence) const { return paracal::yield(failures, batch, confidence); }
  std::vector<SobolIndex> sobol = {};
  std::vector<LinearityPoint> linearity = {};
};

std::vector<Requirement> requirements_of(const ToleranceAnalyzeArguments& options, const Robot& robot,
                                         const Tolerances& tolerances) {
  if (options.problem.empty()) return {{{Quantity::tilt}, options.max_tilt.value().value_or(kUsualMaxTilt)}};
  return io::read_allocation_problem(io::read_stored(options.problem), tolerances, robot).requirements;
}

/// Shows how far the drawing of machines is; an interruption ends it.
Progress watched(const std::atomic<bool>& interrupted) {
  const auto line = std::make_shared<ProgressLine>("machines");
  return [line, &interrupted](std::uint64_t done, std::uint64_t /*expected*/) {
    line->show(done);
    return !interrupted;
  };
}

void find_failures(const ToleranceAnalyzeArguments& options, const Robot& robot, const Session& session,
                   const std::vector<Requirement>& requirements, const std::vector<Pose>& poses, Findings& found) {
  const FailureOptions sampling{.seed = session.seed(),
                                .relative_error = options.failure_error,
                                .confidence = options.monte_carlo.confidence,
                                .threads = session.threads()};
  const Progress progress = watched(flag_of_interruption());
  const auto share = [&](const std::vector<Requirement>& limits) {
    return failure_share(robot, found.tolerances, limits, poses, sampling, progress);
  };
  found.failures = share(requirements);
  if (requirements.size() == 1) return;
  for (const Requirement& one : requirements) found.of_each.push_back(share({one}));
}

/// What the files of the command say.
io::Json files_json(const ToleranceAnalyzeArguments& options, const Tolerances& tolerances) {
  io::Json json{{"half_widths", tolerances.half_width.values}, {"measured", tolerances.measured.values}};
  if (!options.problem.empty()) json["problem"] = io::sha256(io::read_stored(options.problem));
  return json;
}

Findings find(const ToleranceAnalyzeArguments& options, const Robot& robot, Session& session) {
  const std::atomic<bool>& interrupted = flag_of_interruption();
  const Tolerances tolerances = tolerances_of(robot, options.tolerances);
  const std::vector<Requirement> requirements = requirements_of(options, robot, tolerances);
  Findings found{.tolerances = tolerances, .analyses = analyze(robot, tolerances, requirements)};
  const std::vector<Pose> poses = judged_poses(robot, tolerances, found.analyses);
  MonteCarloOptions sampling = options.monte_carlo;
  sampling.model = options.model == "exact" ? Model::exact : Model::linear;
  sampling.seed = session.seed();
  sampling.threads = session.threads();
  if (sampling.model == Model::exact) {
    ShownJob job(options.job, session, description_of(session, robot, files_json(options, tolerances)));
    found.batch = monte_carlo(robot, tolerances, requirements, poses, sampling, watched(interrupted), &job);
    found.missing_parts = job.missing_parts();
    if (!found.missing_parts.empty()) return found;
  } else {
    found.batch = monte_carlo(robot, tolerances, requirements, poses, sampling, watched(interrupted));
  }
  find_failures(options, robot, session, requirements, poses, found);
  found.partial = interrupted;
  if (found.partial) return found;
  const RequirementAnalysis& first = found.analyses.front();
  if (options.sobol > 0) {
    found.sobol = sobol_indices(robot, tolerances, first.requirement.characteristic, first.three_sigma.pose,
                                {.model = Model::exact,
                                 .seed = session.seed(),
                                 .samples = options.sobol,
                                 .confidence = sampling.confidence,
                                 .threads = session.threads()});
  }
  if (options.linearity) {
    found.linearity = linearity(robot, tolerances, first.requirement.characteristic, poses, {0.1, 1.0, 3.0, 10.0, 30.0},
                                200, session.seed());
  }
  return found;
}

std::string sobol_text(const std::vector<SobolIndex>& indices) {
  std::string text = "Sobol indices at the worst pose (exact model): first order, total\n";
  for (const SobolIndex& one : indices) {
    fmt::format_to(std::back_inserter(text), "  {:<17}{:>7.3f} [{:.3f}, {:.3f}]{:>9.3f} [{:.3f}, {:.3f}]\n",
                   name(one.source), one.first, one.first_interval.low, one.first_interval.high, one.total,
                   one.total_interval.low, one.total_interval.high);
  }
  return text;
}

std::string text_of(const ToleranceAnalyzeArguments& options, const Robot& robot, const Findings& found) {
  const MonteCarlo& batch = found.batch;
  const double confidence = options.monte_carlo.confidence;
  std::string text = found.partial ? "partial result: stopped by the user\n" : "";
  text += yield_text(found.failures, batch, confidence);
  const auto out = std::back_inserter(text);
  for (std::size_t k = 0; k < found.analyses.size(); ++k) {
    const RequirementAnalysis& one = found.analyses[k];
    const RequirementStatistics& drawn = batch.requirements[k];
    const auto [factor, unit] = shown(one.requirement, 1.0, options.max_tilt.unit());
    fmt::format_to(out, "\n{}, {}: limit {:.4g}\n", name(one.requirement.characteristic), unit,
                   factor * one.requirement.limit);
    if (!found.of_each.empty()) text += failure_line(found.of_each[k]);
    fmt::format_to(out, "  3 sigma, RSS         {:>10.4g}  at {}\n", factor * one.three_sigma.value,
                   pose_text(robot, one.three_sigma.pose));
    const SigmaAtPose& worst = drawn.at_worst();
    fmt::format_to(out, "  3 sigma, Monte Carlo {:>10.4g}  [{:.4g}, {:.4g}]; Cpk {:.2f}\n", 3.0 * factor * worst.sigma,
                   3.0 * factor * worst.interval.low, 3.0 * factor * worst.interval.high, drawn.cpk());
    fmt::format_to(out, "  worst case           {:>10.4g}  at {}\n", factor * one.worst_case.value,
                   pose_text(robot, one.worst_case.pose));
    fmt::format_to(out, "  largest error of a machine, percentiles:");
    for (const double share : kPercentiles) {
      fmt::format_to(out, "  {:g} % {:.4g}", 100.0 * share, factor * drawn.largest.quantile(share));
    }
    text += "\n  contributions to the variance at the worst pose\n" + pareto(one.contributors);
  }
  fmt::format_to(out, "\nMonte Carlo: {} simulated machines, {} model; {:g} % intervals{}\n", batch.machines,
                 options.model, 100.0 * confidence,
                 batch.converged ? fmt::format("; every sigma to {:g} %", 100.0 * options.monte_carlo.sigma_error)
                                 : std::string("; too few for --sigma-error: raise --max-machines"));
  if (batch.not_closed > 0) fmt::format_to(out, "{} machines cannot reach every pose\n", batch.not_closed);
  if (!found.sobol.empty()) text += "\n" + sobol_text(found.sobol);
  if (!found.linearity.empty())
    text += "\ndifference of the linear model from the exact model, by factor on all tolerances\n";
  for (const LinearityPoint& point : found.linearity) {
    fmt::format_to(out, "  {:>5g}: {:.3g} %\n", point.factor, 100.0 * point.difference);
  }
  return text + assumed_lines(found.tolerances.assumed) + "\n" + io::tolerances_toml(found.tolerances, robot);
}

io::Json requirement_json(const Robot& robot, const RequirementAnalysis& one, const RequirementStatistics& drawn,
                          double confidence) {
  const auto pose_json = [&](const Pose& pose) { return io::to_json(pose, robot.commands_tilt()); };
  const Characteristic what = one.requirement.characteristic;
  const double factor = shown(what.quantity, 1.0).value;
  const SigmaAtPose& worst = drawn.at_worst();
  io::Json json{{"quantity", name(what)},
                {"unit", shown(what.quantity, 0.0).unit},
                {"limit", factor * one.requirement.limit},
                {"worst_case", factor * one.worst_case.value},
                {"worst_case_pose", pose_json(one.worst_case.pose)},
                {"rss_3sigma", factor * one.three_sigma.value},
                {"rss_pose", pose_json(one.three_sigma.pose)},
                {"monte_carlo_3sigma", 3.0 * factor * worst.sigma},
                {"monte_carlo_3sigma_interval", io::interval_json(worst.interval, 3.0 * factor)},
                {"monte_carlo_pose", pose_json(worst.pose)},
                {"cpk", drawn.cpk()},
                {"passed", drawn.passed},
                {"contributors", contributors_json(one.contributors)}};
  for (const double share : kPercentiles) {
    json["largest_on_a_machine"][fmt::format("p{:g}", 100.0 * share)] = factor * drawn.largest.quantile(share);
  }
  json["largest_on_a_machine"]["p95_interval"] =
      io::interval_json(drawn.largest.quantile_interval(0.95, confidence), factor);
  return json;
}

io::Json json_of(const ToleranceAnalyzeArguments& options, const Robot& robot, const Findings& found) {
  const MonteCarlo& batch = found.batch;
  const double confidence = options.monte_carlo.confidence;
  io::Json json{{"model", options.model},         {"machines", batch.machines}, {"converged", batch.converged},
                {"not_closed", batch.not_closed}, {"confidence", confidence},   {"requirements", io::Json::array()}};
  for (std::size_t k = 0; k < found.analyses.size(); ++k) {
    json["requirements"].push_back(requirement_json(robot, found.analyses[k], batch.requirements[k], confidence));
    json["requirements"].back()["failure"] = io::to_json(found.of_each.empty() ? found.failures : found.of_each[k]);
  }
  const io::Json first = json["requirements"].front();  // a copy: what is added to json may move it
  for (const char* key :
       {"worst_case", "rss_3sigma", "monte_carlo_3sigma", "monte_carlo_3sigma_interval", "contributors"}) {
    json[key] = first[key];
  }
  json["yield"] = io::to_json(found.yield(confidence));
  json["dpmo"] = io::to_json(defects_per_million(found.yield(confidence)));
  json["failure"] = io::to_json(found.failures);
  for (const SobolIndex& one : found.sobol) {
    json["sobol"].push_back({{"name", name(one.source)},
                             {"first", one.first},
                             {"first_interval", io::interval_json(one.first_interval)},
                             {"total", one.total},
                             {"total_interval", io::interval_json(one.total_interval)}});
  }
  for (const LinearityPoint& point : found.linearity) {
    json["linearity"].push_back(
        {{"factor", point.factor}, {"difference", point.difference}, {"not_closed", point.not_closed}});
  }
  add_half_widths(json, robot, found.tolerances);
  json["assumed"] = found.tolerances.assumed;
  return json;
}

void write_page(const ToleranceAnalyzeArguments& options, Session& session, const Robot& robot, const Findings& found) {
  const Characteristic what = found.analyses.front().requirement.characteristic;
  io::Json map = three_sigma_json(robot, what, found.tolerances);
  io::Json histograms = io::json_array(found.batch.requirements, [](const RequirementStatistics& one) {
    const auto [factor, unit] = shown(one.requirement.characteristic.quantity, 1.0);
    return io::Json{{"quantity", name(one.requirement.characteristic)},
                    {"unit", unit},
                    {"limit", factor * one.requirement.limit},
                    {"machines", report::histogram(one.largest, factor)}};
  });
  write_report(*options.report, session, robot,
               {.kind = "tolerance analysis",
                .results = {{"analysis", json_of(options, robot, found)}},
                .figures = {{"sigma_map", std::move(map)}, {"largest_on_a_machine", std::move(histograms)}},
                .inputs = with_files({}, session, {options.tolerances, options.problem})});
}

void run(const ToleranceAnalyzeArguments& options, Session& session) {
  require_job(options.job, options.model == "exact", "--model exact");
  const Robot robot = session.robot();
  const Findings found = find(options, robot, session);
  if (!found.missing_parts.empty()) return session.print(found.missing_parts);
  const bool enough =
      !options.min_yield || (is_proven(found.failures, found.batch) &&
                             found.yield(options.monte_carlo.confidence).interval.low >= *options.min_yield);
  if (!enough || !found.batch.converged) session.exit_code = kVerdictIsNo;
  if (!options.report->empty()) write_page(options, session, robot, found);
  session.json() ? session.print_json(json_of(options, robot, found)) : session.print(text_of(options, robot, found));
}

}  // namespace

void add_tolerance_analyze(Command& tolerance, Session& session) {
  Command* command =
      session.add_command(tolerance, "analyze", "Design tolerances",
                          "compute worst case, root sum of squares, Monte Carlo, contributions and yield");
  const auto options = std::make_shared<ToleranceAnalyzeArguments>();
  command->add_option("--tolerances", options->tolerances, "tolerances (TOML; default: the robot's)");
  const std::array tilt =
      add_angle_options(*command, options->max_tilt, "--max-tilt", "--max-tilt", "limit on the plate's tilt");
  tilt.front()->shows_default(fmt::format("{}", kUsualMaxTilt));
  Option* problem =
      command->add_option("--problem", options->problem,
                          "requirements from this file (TOML; see docs/tolerance.md), instead of --max-tilt");
  for (Option* one : tilt) problem->excludes(one);
  command->add_option("--min-yield", options->min_yield, "exit with 1 unless the exact model proves this yield")
      ->check(between(0.0, 1.0));
  command->heading("Monte Carlo");
  command->add_option("--model", options->model, "model of the simulated machines")->check(one_of({"linear", "exact"}));
  const Rule share = within(option_limits::kRelativeError), confidence = within(option_limits::kConfidence);
  command
      ->add_option("--sigma-error", options->monte_carlo.sigma_error,
                   "simulate machines until every sigma has this relative error")
      ->check(share);
  command->add_option("--confidence", options->monte_carlo.confidence, "confidence level of all intervals")
      ->check(confidence);
  command->add_option("--failure-error", options->failure_error, "relative error of the failure rate")->check(share);
  command->add_option("--max-machines", options->monte_carlo.max_machines, "largest number of simulated machines")
      ->check(within(option_limits::kMaxMachines));
  command->add_option("--sobol", options->sobol, "compute Sobol indices from N samples of the exact model")
      ->check(whole_number(8, 10'000'000))
      ->shows_default("");
  command->add_flag("--linearity", options->linearity,
                    "show the error of the linear model up to 30 times the tolerances");
  add_long_job_options(*command, options->job);
  command->heading("Results");
  options->report = add_report_option(*command, session);
  command->example("With the default limit of 0.001 rad tilt", "paracal tolerance analyze --robot huang2016");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
