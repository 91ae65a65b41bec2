// Cost of a batch of simulated machines of huang2016: time per machine compared with its forward solutions and its fit
// alone, machines per second on one and two threads, and memory. kinematics_benchmark.cpp explains why it uses plain
// chrono code.
//
//   paracal-batch-benchmark             a machine, and machines a second
//   paracal-batch-benchmark memory      peak memory of few and many machines; some minutes
//
// It only reports: the exit status is always 0.

#include <fmt/format.h>

#include <string_view>

#include "host.hpp"
#include "interleaved_timing.hpp"
#include "jobs/batch_job.hpp"
#include "paracal/batch/batch.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "peak_memory.hpp"

namespace paracal::benchmark {
namespace {

constexpr int kRounds = 15;
constexpr std::uint64_t kMachines = 64;  // a round
const std::atomic<bool> kNeverStop = false;

Batch paper_batch(Method method) {
  Batch batch{.robot = catalogue::huang2016(), .plan = {}, .seed = 1};
  ProductionPlan plan = paper_production(batch.robot, tolerances_of(batch.robot));
  plan.calibration.method = method;
  batch.plan = settled(batch.robot, std::move(plan));
  return batch;
}

/// The forward solves and the fit that one machine cannot do without, with everything they need at hand.
struct Parts {
  Machine machine;
  std::vector<Joints> joints;  ///< of all poses measured, validated before, validated after
  Measurements readings;
};

Parts parts_of(const Batch& batch, std::uint64_t number) {
  RandomStream random(batch.seed, number);
  const SourceErrors errors = draw_errors(batch.robot, batch.plan.tolerances, random);
  Parts parts{.machine = build(batch.robot, errors),
              .joints = {},
              .readings = simulate(batch.robot, errors, batch.plan.stations, batch.plan.instrument, random)};
  const Machine believed = build(batch.robot, calibrate(batch.robot, parts.readings, batch.plan.calibration).errors());
  for (const Station& station : batch.plan.stations) parts.joints.push_back(believed_joints(batch.robot, station));
  for (const Machine& controller : {batch.robot.nominal(), believed}) {
    for (const Station& station : batch.plan.validation) {
      parts.joints.push_back(inverse(controller, station.commanded).joints);
    }
  }
  return parts;
}

void report_machine(const Batch& batch, const char* method) {
  std::vector<Parts> all;
  for (std::uint64_t number = 0; number < kMachines; ++number) all.push_back(parts_of(batch, number));
  const auto whole = [&] {
    for (std::uint64_t number = 0; number < kMachines; ++number) {
      keep(produce(batch.robot, batch.plan, batch.seed, number));
    }
  };
  const auto forward_solves = [&] {
    for (const Parts& parts : all) {
      for (const Joints& joints : parts.joints) keep(forward(parts.machine, joints));
    }
  };
  const auto fits = [&] {
    for (const Parts& parts : all) keep(calibrate(batch.robot, parts.readings, batch.plan.calibration));
  };
  const auto seconds = interleave({whole, forward_solves, fits}, kRounds);
  std::vector<double> sum(seconds[1]);
  for (std::size_t round = 0; round < sum.size(); ++round) sum[round] += seconds[2][round];
  const auto ms = [](const std::vector<double>& one) { return 1e3 * spread_of(one).median / kMachines; };
  fmt::print("{:<8}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.2f}\n", method, ms(seconds[0]), ms(seconds[1]),
             ms(seconds[2]), ms(sum), median_ratio(seconds[0], sum));
}

void report_machines() {
  fmt::print(
      "\nOne complete machine (19 stations measured, rough and fine stage, 120 poses before and after), {} rounds of "
      "{}\n",
      kRounds, kMachines);
  fmt::print("{:<8}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "method", "machine", "forward", "fit", "sum", "ratio");
  fmt::print("{:<8}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "", "ms", "ms", "ms", "ms", "");
  report_machine(paper_batch(Method::best), "best");
  report_machine(paper_batch(Method::paper), "paper");
  fmt::print(
      "ratio: time of a machine divided by the sum of its forward solutions and its fit alone (target: at most 1.5)\n");
}

void report_threads() {
  const Batch batch = paper_batch(Method::best);
  const auto chunk = [&](unsigned threads) {
    return [&batch, threads] { keep(exactly(batch, {0, 2 * kMachines}, threads, kNeverStop)); };
  };
  const auto seconds = interleave({chunk(1), chunk(2)}, kRounds);
  fmt::print("\nMachines per second: {:.0f} on 1 thread, {:.0f} on 2 threads; 2 threads are {:.2f} times as fast\n",
             2 * kMachines / spread_of(seconds[0]).median, 2 * kMachines / spread_of(seconds[1]).median,
             median_ratio(seconds[0], seconds[1]));
}

/// Machines that cost little, so that many can be made: four stations, the encoder offsets alone, three poses.
Batch cheap_batch() {
  Batch batch{.robot = catalogue::huang2016(), .plan = {}, .seed = 1};
  ProductionPlan plan = paper_production(batch.robot, tolerances_of(batch.robot));
  plan.stations = rough_stations(batch.robot, 4);
  plan.validation.resize(4);
  plan.calibration.method = Method::paper;
  plan.calibration.stage = Stage::rough;
  batch.plan = settled(batch.robot, std::move(plan));
  return batch;
}

/// Nothing else may have started threads, which a forked process would not have.
void report_memory() {
  const Batch cheap = cheap_batch(), paper = paper_batch(Method::best);
  const auto peak_of = [](const Batch& batch, std::uint64_t machines) {
    return peak_memory([&] {
      JobInMemory job;
      keep(jobs::run_batch(batch, {.machines = machines, .threads = 2}, chunk_sizes(batch, machines), job, kNeverStop));
    });
  };
  fmt::print("\nPeak memory of a process with 2 threads, MB ({:.1f} without work)\n", peak_memory([] {}));
  for (const std::uint64_t machines : {10'000U, 100'000U, 1'000'000U}) {
    fmt::print("  {:>8} machines, small plan        {:>8.1f}\n", machines, peak_of(cheap, machines));
  }
  for (const std::uint64_t machines : {1'000U, 10'000U}) {
    fmt::print("  {:>8} machines, paper's plan     {:>8.1f}\n", machines, peak_of(paper, machines));
  }
}

}  // namespace
}  // namespace paracal::benchmark

int main(int argc, char** argv) {
  using namespace paracal::benchmark;
  fmt::print("{}", host_description());
  if (argc > 1 && std::string_view(argv[1]) == "memory") {
    report_memory();
  } else {
    report_machines();
    report_threads();
  }
}
