#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "comparison.hpp"
#include "interleaved_timing.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/random.hpp"
#include "tilt_task.hpp"
#include "tolerance_reports.hpp"

namespace paracal::benchmark {
namespace {

constexpr std::uint64_t kMachines = 1U << 10;
constexpr int kRounds = 21;

/// What exact Monte Carlo cannot do without: where every machine puts its plate at home and at every pose. Machines,
/// joints and first guesses are at hand.
class ForwardSolutions {
 public:
  ForwardSolutions(const TiltTask& task, unsigned threads) : arena_(static_cast<int>(threads)) {
    std::vector<Pose> poses = task.poses;
    poses.push_back({task.robot.workspace().centre(), 0.0});
    const Machine& nominal = task.robot.nominal();
    for (const Pose& pose : poses) {
      joints_.push_back(inverse(nominal, pose).joints);
      starts_.push_back({.position = pose.position, .slide = nominal.slide_of(pose.rotation)});
    }
    for (std::uint64_t m = 0; m < kMachines; ++m) {
      RandomStream random(1, m);
      machines_.push_back(build(task.robot, draw_errors(task.robot, *task.robot.tolerances(), random)));
    }
  }

  std::size_t per_machine() const { return joints_.size(); }

  void solve() {
    arena_.execute([&] {
      tbb::parallel_for(std::size_t{0}, machines_.size(), [&](std::size_t m) {
        for (std::size_t p = 0; p < joints_.size(); ++p) keep(forward(machines_[m], joints_[p], {.start = starts_[p]}));
      });
    });
  }

 private:
  std::vector<Joints> joints_;
  std::vector<PlateState> starts_;
  std::vector<Machine> machines_;
  tbb::task_arena arena_;
};

void print_row(const char* name, const std::vector<double>& seconds, std::size_t poses, double ratio) {
  const Spread spread = spread_of(seconds);
  const double to_us = 1e6 / static_cast<double>(kMachines);
  fmt::print("{:<36}{:>9.1f}{:>9.1f}{:>9.1f}{:>16.3f}{:>9.2f}\n", name, spread.median * to_us, spread.p99 * to_us,
             spread.max * to_us, static_cast<double>(poses) / (spread.median * to_us), ratio);
}

}  // namespace

void report_exact_monte_carlo(unsigned threads) {
  const TiltTask task;
  ForwardSolutions solutions(task, threads);
  const auto seconds = interleave(
      {[&] { solutions.solve(); }, [&] { keep(task.monte_carlo(Model::exact, kMachines, threads)); }}, kRounds);
  fmt::print(
      "\nExact Monte Carlo of tilt at {} poses: {} forward solutions per machine, {} machines, {} thread{}, "
      "{} rounds\n",
      task.poses.size(), solutions.per_machine(), kMachines, threads, threads == 1 ? "" : "s", kRounds);
  fmt::print("{:<36}{:>9}{:>9}{:>9}{:>16}{:>9}\n", "us per machine", "median", "p99", "max", "Mega poses/s", "ratio");
  compare({.task = "exact Monte Carlo of tilt, 121 poses",
           .opponent = "lower bound: only its forward solutions",
           .unit = "us per machine",
           .threads = static_cast<int>(threads),
           .note = "paracal also draws machines and counts"},
          {seconds[1], kMachines}, {seconds[0], kMachines});
  print_row("monte_carlo(), complete", seconds[1], task.poses.size(), median_ratio(seconds[1], seconds[0]));
  print_row("  only its forward solutions", seconds[0], task.poses.size(), 1.0);
}

}  // namespace paracal::benchmark
