#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <iterator>
#include <memory>

#include "interruption.hpp"
#include "jobs/batch_job.hpp"
#include "long_job.hpp"
#include "measuring.hpp"
#include "paracal/batch/error_spread.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/units.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "tolerancing.hpp"
#include "usage.hpp"
#include "yield_plan.hpp"

namespace paracal::app {
namespace {

constexpr double kUsualRotationNoise = 0.3;  // deg: rotational repeatability in [huang2016, section 5.2]
constexpr std::uint64_t kMostMachines = 1'000'000'000'000, kLargestChunk = 1'000'000;

/// A row of the table, and the option that judges it. Tilt has the unit of its limit.
struct Row {
  ErrorKind kind;
  const char *text, *option;
  double factor = 1.0;           ///< from mm or rad to the row's unit
  const char* before = nullptr;  ///< the option's name of before
};

constexpr std::array kRows{
    Row{ErrorKind::distance, "distance, mm", "--limit-mm", 1.0, "--max-distance-mm"},
    Row{ErrorKind::volumetric, "position, mm", "--limit-position-mm", 1.0, "--max-position-mm"},
    Row{ErrorKind::volumetric_aligned, "position aligned, mm", "--limit-aligned-mm", 1.0, "--max-position-aligned-mm"},
    Row{ErrorKind::rotation, "rotation, deg", "--limit-deg", to_degrees(1.0), "--max-rotation-deg"},
    Row{ErrorKind::tilt, "tilt, rad", "--max-tilt-rad"}};

struct YieldArguments {
  std::uint64_t machines = 0;
  io::TableStyle style = {};
  std::string tolerances, poses, method = "best", rotation = "none";
  LongJobOptions job;
  std::uint64_t chunk = 0;  ///< 0: by counted work
  double interval = jobs::BatchJobOptions{}.interval;
  bool plan = false;
  InstrumentOptions instrument{.noise_mm = kUsualNoise, .rotation_noise_deg = kUsualRotationNoise};
  PerErrorKind<std::optional<double>> limits = {};  ///< in the units of kRows, but for tilt
  AngleOption max_tilt;
  std::optional<double> min_yield = {};
  double confidence = 0.95;
  bool exact = false;
  std::shared_ptr<std::string> report;
};

/// A batch with the files that it was described in.
struct Order {
  Batch batch;
  std::vector<InputFile> inputs;
};

/// The metrologist knows the instrument, and corrects by the residuals.
NoiseModel first_guess(const VirtualInstrument& instrument) {
  constexpr double kSmallest = 1e-5;  // mm or rad: no instrument is perfect
  NoiseModel noise;
  if (instrument.noise >= kSmallest) noise.point = noise.body = instrument.noise;
  if (instrument.rotation_noise >= kSmallest) noise.rotation = instrument.rotation_noise;
  noise.tracker = instrument.tracker;
  return noise;
}

/// Whether machines of such a robot can be off by that.
bool is_shown(ErrorKind kind, const Robot& robot) {
  const auto& free = robot.freedoms().free;
  if (kind == ErrorKind::tilt) return !robot.nominal().has_guides || free[3] || free[4];
  return kind != ErrorKind::rotation || turns(robot);
}

PerErrorKind<std::optional<double>> limits_of(const YieldArguments& options, const Robot& robot) {
  PerErrorKind<std::optional<double>> limits;
  for (const Row& row : kRows) {
    const std::optional<double> limit =
        row.kind == ErrorKind::tilt ? options.max_tilt.value() : options.limits[row.kind];
    if (!limit) continue;
    if (!is_shown(row.kind, robot)) {
      throw WrongUsage(fmt::format("{}: expected a robot that {} its plate, got {}", row.option,
                                   row.kind == ErrorKind::tilt ? "tilts" : "turns", robot.name()));
    }
    limits[row.kind] = *limit / row.factor;
  }
  return limits;
}

/// Reads the inputs and keeps their hashes.
Order order_of(const YieldArguments& options, Session& session) {
  Order order{.batch = {.robot = session.robot({.tables = {options.poses}}), .plan = {}, .seed = session.seed()},
              .inputs = {}};
  const auto input = [&](const std::filesystem::path& name) {
    io::TextFile file = input_table(name, options.style);
    order.inputs.push_back({file.name, io::sha256(file)});
    return file;
  };
  const Robot& robot = order.batch.robot;
  if (const auto& file = session.robot_file()) input(*file);
  ProductionPlan plan = paper_production(
      robot, options.tolerances.empty() ? tolerances_of(robot) : read_priors(input(options.tolerances), robot));
  if (!options.poses.empty()) plan.stations = io::read_poses(input(options.poses), robot.joint_space());
  if (robot.commands_tilt() && options.rotation != "none") {
    throw WrongUsage(
        fmt::format("--rotation: expected none (the orientation of this plate is measured), got {}", options.rotation));
  }
  plan.instrument = options.instrument.instrument(options.rotation != "none");
  plan.instrument.reads_orientation = robot.commands_tilt();
  plan.calibration.method = options.method == "paper" ? Method::paper : Method::best;
  plan.calibration.noise = first_guess(plan.instrument);
  plan.calibration.rotation_zero = options.rotation == "absolute" ? RotationZero::known : RotationZero::unknown;
  plan.limits = limits_of(options, robot);
  if (options.min_yield && !has_limits(plan)) {
    throw WrongUsage("--min-yield: expected a limit (--max-...) with it, got none");
  }
  order.batch.plan = settled(robot, std::move(plan));
  if (!options.exact) order.batch = with_surrogate(std::move(order.batch));
  return order;
}

ChunkSizes sizes_of(const YieldArguments& options, const Batch& batch) {
  if (options.chunk == 0) return chunk_sizes(batch, options.machines);
  return {.first_order = batch.surrogate ? options.chunk : 0,
          .exact = batch.surrogate ? std::bit_floor(std::min(options.chunk, kLargestExactChunk)) : options.chunk};
}

/// A folder keeps the chunks that it was begun with.
void require_chunks(const YieldArguments& options, const ShownJob& job) {
  const ChunkSizes sizes = jobs::chunk_sizes(job.agreed());
  const std::uint64_t begun = sizes.first_order > 0 ? sizes.first_order : sizes.exact;
  if (options.chunk == 0 || options.chunk == begun) return;
  throw InputFileError((std::filesystem::path(options.job.checkpoint) / "job.json").string(), 0,
                       fmt::format("expected chunks of {} machines, got {}; remove --chunk or use another folder",
                                   options.chunk, begun));
}

/// The number of exact machines that can distinguish a yield slightly above the required one from it.
std::uint64_t least_exact(const YieldArguments& options) {
  constexpr double kMachines =
      8.0;  // failures expected at the required yield: twice as many as a proof without failures needs at 95 %
  if (!options.min_yield || *options.min_yield >= 1.0) return 0;
  return static_cast<std::uint64_t>(kMachines / (1.0 - *options.min_yield));
}

jobs::BatchResult make(const YieldArguments& options, Session& session, const Batch& batch, ShownJob& job) {
  return jobs::run_batch(batch,
                         {.machines = options.machines,
                          .interval = options.interval,
                          .confidence = options.confidence,
                          .least_exact = least_exact(options),
                          .threads = session.threads()},
                         jobs::chunk_sizes(job.agreed()), job, flag_of_interruption());
}

// ---- what a person reads

std::string percent(double share) { return fmt::format("{:.3f} %", 100.0 * share); }

/// The interval; too few machines give a rare error no upper end.
std::string interval_text(const Interval& interval, double factor) {
  if (!std::isfinite(interval.high)) return fmt::format("above {:.4g}; upper end not known yet", factor * interval.low);
  return fmt::format("{:.4g} to {:.4g}", factor * interval.low, factor * interval.high);
}

std::string spread_line(const ErrorSpread& spread, double factor, double confidence, std::string_view when) {
  std::string text = fmt::format("{:<8}", when);
  const auto out = std::back_inserter(text);
  for (const double share : {0.5, 0.9, 0.95, 0.99, 0.9973}) {
    // Without an upper end, the figure comes only from the largest of these machines.
    const bool is_known = std::isfinite(spread.quantile_interval(share, confidence).high);
    fmt::format_to(out, "{:>11}", fmt::format("{:.4g}{}", factor * spread.quantile(share), is_known ? "" : "?"));
  }
  fmt::format_to(out, "   {}\n", interval_text(spread.quantile_interval(0.95, confidence), factor));
  return text;
}

std::string accuracy_table(const Batch& batch, const Tally& tally, double confidence, const AngleUnit& tilts) {
  std::string text = fmt::format(
      "  largest error of a machine over {} poses: percentiles\n"
      "  {:<22}{:8}{:>11}{:>11}{:>11}{:>11}{:>11}   {} interval of the 95 % percentile\n",
      batch.plan.validation.size() - 1, "", "", "50 %", "90 %", "95 %", "99 %", "99.73 %",
      fmt::format("{:g} %", 100.0 * confidence));
  bool is_known = true;
  for (const Row& row : kRows) {
    if (!is_shown(row.kind, batch.robot)) continue;
    const ErrorSpread before(tally, {.kind = row.kind, .after = false}), after(tally, {.kind = row.kind});
    const bool is_tilt = row.kind == ErrorKind::tilt;
    const double factor = is_tilt ? tilts.per_rad : row.factor;
    text += fmt::format("  {:<22}", is_tilt ? "tilt, " + tilts.name : row.text) +
            spread_line(before, factor, confidence, "before");
    text += fmt::format("  {:<22}", "") + spread_line(after, factor, confidence, "after");
    for (const ErrorSpread* one : {&before, &after}) {
      is_known = is_known && std::isfinite(one->quantile_interval(0.9973, confidence).high);
    }
  }
  if (!is_known) text += "  ? upper end not known: too few exact machines; raise --machines\n";
  return text;
}

std::string yield_line(const YieldArguments& options, const Batch& batch, const Tally& tally) {
  if (!has_limits(batch.plan)) return "no yield: no limits are stated; set them with --max-...\n";
  const Proportion share = yield(tally, options.confidence), defects = defects_per_million(share);
  return fmt::format("yield {} [{}, {}] ({:g} % interval); defects per million {:.0f} [{:.0f}, {:.0f}]\n",
                     percent(share.value), percent(share.interval.low), percent(share.interval.high),
                     100.0 * options.confidence, defects.value, defects.interval.low, defects.interval.high);
}

/// How many machines were computed exactly, and which failures this number cannot exclude.
std::string way_line(const Tally& tally, double confidence) {
  if (tally.produced() == tally.machines()) return "";
  std::string text = fmt::format(
      "  exact model: {} machines; the others: first order, corrected by paired simulation\n", tally.produced());
  if (const double unseen = unseen_share(tally, confidence); unseen > 0.0) {
    text += fmt::format("  no calibration failed among the exact machines; up to {} of all machines may still fail\n",
                        percent(unseen));
  }
  return text;
}

std::string text_of(const YieldArguments& options, const Batch& batch, const jobs::BatchResult& result) {
  const Tally& tally = result.tally;
  std::string text;
  const auto out = std::back_inserter(text);
  if (!result.complete)
    fmt::format_to(out, "partial result: stopped by the user before {} machines were complete\n", options.machines);
  if (tally.produced() == 0) return text + "no result yet: no machine is computed exactly\n";
  text += yield_line(options, batch, tally);
  fmt::format_to(out, "batch of {} simulated machines of {}, seed {}\n", tally.machines(), batch.robot.name(),
                 batch.seed);
  fmt::format_to(
      out, "  calibrations: {} accepted, {} rejected, {} not identifiable, {} not converged; {} cannot reach a pose\n",
      tally.of(Fate::accepted), tally.of(Fate::rejected), tally.of(Fate::not_identifiable),
      tally.of(Fate::not_converged), tally.of(Fate::does_not_close));
  text +=
      way_line(tally, options.confidence) + accuracy_table(batch, tally, options.confidence, options.max_tilt.unit());
  return text + assumed_lines(batch.plan.tolerances.assumed);
}

// ---- what a program reads

io::Json json_of(const YieldArguments& options, const Order& order, const jobs::BatchResult& result) {
  io::Json json{{"machines_asked", options.machines}, {"partial", !result.complete}};
  json.update(io::to_json(order.batch, result.tally, options.confidence));
  if (options.min_yield) json["min_yield"] = *options.min_yield;
  json["assumed"] = order.batch.plan.tolerances.assumed;
  json["batch"] = io::to_json(order.batch);
  json["inputs"] = io::to_json(order.inputs);
  return json;
}

io::Json histogram_of(const Tally& tally, Measure measure, double factor) {
  return report::histogram(ErrorSpread(tally, measure).counts(), factor);
}

/// A histogram an error, before and after on bins of their own.
io::Json histograms(const Batch& batch, const Tally& tally) {
  io::Json json = io::Json::array();
  for (const Row& row : kRows) {
    if (!is_shown(row.kind, batch.robot)) continue;
    json.push_back({{"quantity", row.text},
                    {"before", histogram_of(tally, {.kind = row.kind, .after = false}, row.factor)},
                    {"after", histogram_of(tally, {.kind = row.kind}, row.factor)}});
    if (const auto& limit = batch.plan.limits[row.kind]) json.back()["limit"] = row.factor * *limit;
  }
  return json;
}

void write_page(const YieldArguments& options, Session& session, const Order& order, const jobs::BatchResult& result) {
  write_report(*options.report, session, order.batch.robot,
               {.kind = "yield",
                .results = {{"yield", json_of(options, order, result)}},
                .figures = {{"largest_of_a_machine", histograms(order.batch, result.tally)}},
                .inputs = order.inputs});
}

void run(const YieldArguments& options, Session& session) {
  (void)flag_of_interruption();
  const Order order = order_of(options, session);
  if (options.plan) {
    const YieldPlan plan = measured_plan(order.batch, sizes_of(options, order.batch), options.machines,
                                         options.interval, options.confidence);
    return session.json() ? session.print_json(json_of(plan)) : session.print(text_of(plan));
  }
  ShownJob job(options.job, session, jobs::description(order.batch, sizes_of(options, order.batch)));
  require_chunks(options, job);
  const jobs::BatchResult result = make(options, session, order.batch, job);
  if (const std::string missing = job.missing_parts(); !missing.empty()) {
    session.json() ? session.print_json(json_of(options, order, result)) : session.print(missing);
    return;
  }
  const bool enough = !options.min_yield || yield(result.tally, options.confidence).interval.low >= *options.min_yield;
  if (!result.complete || !enough) session.exit_code = kVerdictIsNo;
  if (!options.report->empty()) write_page(options, session, order, result);
  session.json() ? session.print_json(json_of(options, order, result))
                 : session.print(text_of(options, order.batch, result));
}

void add_limits(Command& command, YieldArguments& options) {
  command.heading("Limits after calibration");
  for (const Row& row : kRows) {
    const std::string text = fmt::format("largest allowed value of \"{}\"", row.text);
    if (row.kind != ErrorKind::tilt) {
      const Rule rule = row.kind == ErrorKind::rotation ? within(plausible::kLimitDeg) : positive();
      Option* const limit = command.add_option(row.option, options.limits[row.kind], text)->check(rule);
      command.add_option(row.before, options.limits[row.kind], text)->check(rule)->excludes(limit)->hide();
      continue;
    }
    add_angle_options(command, options.max_tilt, row.option, "--max-tilt", "largest allowed tilt");
  }
  command.add_option("--min-yield", options.min_yield, "smallest yield, from 0 to 1; its lower bound must reach it")
      ->check(non_negative())
      ->check(between(0.0, 1.0));
}

}  // namespace

void add_yield(Command& program, Session& session) {
  Command* command = session.add_command(program, "yield", "Design tolerances",
                                         "simulate a batch of machines: build, calibrate and validate each one");
  const auto options = std::make_shared<YieldArguments>();
  command->add_option("--machines", options->machines, "number of machines")
      ->required()
      ->check(whole_number(1, kMostMachines))
      ->shows_default("");
  command->add_option("--tolerances", options->tolerances, "tolerances of the parts (TOML; default: the robot's)");
  command->add_option(
      "--poses", options->poses,
      "poses to measure (CSV; default: home and two circles of 9, or 30 poses for six degrees of freedom)");
  add_table_options(*command, options->style);
  command->heading("Calibration");
  command->add_option("--method", options->method, "method of the calibration, as in calibrate")
      ->check(one_of({"best", "paper"}));
  command->add_option("--rotation", options->rotation, "whether phi is measured, and from which zero")
      ->check(one_of({"none", "relative", "absolute"}));
  add_instrument_options(*command, options->instrument);
  add_limits(*command, *options);
  command->heading("Monte Carlo");
  command->add_flag(
      "--exact", options->exact,
      "simulate every machine exactly (default: some exactly; they correct the others, simulated to first "
      "order)");
  command->add_option("--confidence", options->confidence, "confidence level of the intervals")
      ->check(positive())
      ->check(between(0.01, 0.999999));
  command
      ->add_option("--interval", options->interval,
                   "add exact machines until the 95 % percentiles have this relative error, up to half of all machines")
      ->check(positive())
      ->check(between(0.001, 10.0));
  add_long_job_options(*command, options->job);
  command
      ->add_option("--chunk", options->chunk,
                   "machines per chunk, which is lost if a process dies (default: 0.2 s of work)")
      ->check(whole_number(1, kLargestChunk))
      ->shows_default("");
  command->add_flag("--plan", options->plan,
                    "compute no batch; predict time, memory and files for 1 to 1024 cores from a short trial");
  command->heading("Results");
  command->example("100 machines with the tolerances of a file",
                   "paracal yield --robot huang2016 --tolerances tolerances.toml --machines 100");
  options->report = add_report_option(*command, session);
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
