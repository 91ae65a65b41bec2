#include <fmt/format.h>

#include "calibration_reports.hpp"
#include "comparison.hpp"
#include "interleaved_timing.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "peak.hpp"
#include "peak_memory.hpp"

namespace paracal::benchmark {
namespace {

constexpr int kMany = 1000;  // stations
constexpr int kRounds = 11;
constexpr int kSmallFits = 30;  // of the few stations, in a round: a time like that of the many

/// One calibration by the paper's method.
struct PairFit {
  Robot robot = catalogue::huang2016();
  Measurements measurements = {};

  explicit PairFit(const std::vector<Station>& stations) {
    constexpr double kNoise = 0.017;  // mm
    RandomStream random(1);
    const SourceErrors errors = draw_errors(robot, *robot.tolerances(), random);
    measurements = simulate(robot, errors, stations, {.noise = kNoise}, random);
  }

  Calibration operator()() const {
    return calibrate(robot, measurements, {.method = Method::paper, .stage = Stage::fine});
  }
  double stations() const { return static_cast<double>(measurements.stations.size()); }
  double pairs() const { return stations() * (stations() - 1.0) / 2.0; }
};

/// Orthogonal folding of one row of [J | r] a linearization, which the streamed root cannot do without.
double operations_a_pair(const Calibration& calibration) {
  const auto fold = [](int iterations, double columns) { return (iterations + 1.0) * 2.0 * columns * columns; };
  const double rough = static_cast<double>(calibration.robot.limb_count()) + 1.0;
  const double fine = static_cast<double>(calibration.parameters.size()) + 1.0;
  return fold(calibration.stages.front().iterations, rough) + fold(calibration.stages.back().iterations, fine);
}

void print_row(const PairFit& fit, const std::vector<double>& seconds, double fits, double memory, double floor) {
  const Spread spread = spread_of(seconds);
  const double to_us = 1e6 / fits / fit.pairs(), to_ms = 1e3 / fits;
  fmt::print("{:>8.0f}{:>9.0f}{:>10.1f}{:>10.2f}{:>8.2f}{:>8.2f}{:>10.2f}{:>8.0f}\n", fit.stations(), fit.pairs(),
             spread.median * to_ms, spread.median * to_us, spread.p99 * to_us, spread.max * to_us, floor * 1e6, memory);
}

}  // namespace

void report_pairs() {
  const Robot robot = catalogue::huang2016();
  const PairFit few(fine_stations(robot, 9)), many(candidate_stations(robot, kMany, 1));
  const double memory_of_none = peak_memory([] {}), memory_of_few = peak_memory([&] { keep(few()); }),
               memory_of_many = peak_memory([&] { keep(many()); });
  const auto few_pass = [&] {
    for (int k = 0; k < kSmallFits; ++k) keep(few());
  };
  const auto seconds = interleave({few_pass, [&] { keep(many()); }, compiled_peak().pass}, kRounds);
  const double operation = spread_of(seconds.back()).median / compiled_peak().operations;

  fmt::print("\nMethod::paper, distances of all pairs of points, huang2016, {} rounds\n", kRounds);
  fmt::print("{:>8}{:>9}{:>10}{:>10}{:>8}{:>8}{:>10}{:>8}\n", "stations", "pairs", "fit", "pair", "p99", "max", "bound",
             "memory");
  fmt::print("{:>8}{:>9}{:>10}{:>10}{:>8}{:>8}{:>10}{:>8}\n", "", "", "ms", "us", "us", "us", "us", "MB");
  print_row(few, seconds[0], kSmallFits, memory_of_few, operations_a_pair(few()) * operation);
  print_row(many, seconds[1], 1.0, memory_of_many, operations_a_pair(many()) * operation);
  state("the paper's method on all 499,500 distances of 1000 points", 1e3 * spread_of(seconds[1]).median, "ms");
  state("memory of the process for this task", memory_of_many, "MB");
  fmt::print("time per pair, many / few: {:.2f} (target: at most 1.2); bound: accumulating its row once per\n",
             median_ratio(seconds[1], seconds[0]) * kSmallFits * few.pairs() / many.pairs());
  fmt::print(
      "linearization at the peak of one core; memory: peak of a process (target: at most 100), {:.0f} without work\n",
      memory_of_none);
}

}  // namespace paracal::benchmark
