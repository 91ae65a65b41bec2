// Time, heap allocations and floating point work of the kinematics at a pose, on every robot of the catalogue.
//
// It uses plain chrono code instead of Google Benchmark. The important figures are ratios between functions, and other
// load on a shared machine lasts longer than the measurement of one function. Candidates and baselines therefore run in
// turn in many short rounds. Ratios are computed within a round, and the median of the rounds is reported. Google
// Benchmark finishes one candidate before the next (its random interleaving repeats whole measurements), without pairs.
//
// It only reports: the exit status is always 0.

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "comparison.hpp"
#include "floor.hpp"
#include "host.hpp"
#include "interleaved_timing.hpp"
#include "operation_count.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "peak.hpp"
#include "support/allocation_count.hpp"
#include "task.hpp"

namespace {

using namespace paracal;
using namespace paracal::benchmark;

constexpr std::size_t kPoses = 1000;
constexpr int kRounds = 200;

/// Iterations over all poses.
struct Iterations {
  double mean = 0.0;
  int max = 0;
};

/// A function under measurement; `pass` runs it on every pose.
struct Candidate {
  std::string name;
  Pass pass;
  Operations operations;  ///< a pose
  Iterations iterations = {};
  std::size_t baseline = 0;  ///< index of the candidate that the ratio is to
};

enum : std::size_t { kFloor, kInverse };

template <typename Iterative>
Iterations iterations_of(Iterative&& iterative) {
  std::vector<int> iterations(kPoses);
  for (std::size_t k = 0; k < kPoses; ++k) iterations[k] = iterative(k).iterations;
  const double sum = std::accumulate(iterations.begin(), iterations.end(), 0.0);
  return {sum / static_cast<double>(kPoses), std::ranges::max(iterations)};
}

/// The pass that calls `evaluate` with the index of each pose.
template <typename Evaluate>
Pass each_pose(Evaluate evaluate) {
  return [evaluate] {
    for (std::size_t k = 0; k < kPoses; ++k) keep(evaluate(k));
  };
}

std::vector<Candidate> candidates_of(const Task& task, const Floor& floor) {
  const PoseOperations operations = count_operations(task.robot);
  const auto nominal_inverse = [&](std::size_t k) { return inverse(task.robot.nominal(), task.poses[k]); };
  const auto actual_inverse = [&](std::size_t k) { return inverse(task.machine, task.poses[k]); };
  const auto actual_forward = [&](std::size_t k) { return forward(task.machine, task.joints[k]); };
  const auto linear_model = [&](std::size_t k) { return error_model(task.robot, task.poses[k]); };
  const auto jacobian = [&](std::size_t k) { return exact_jacobian(task.machine, task.plates[k], task.joints[k]); };
  const Iterations forward_iterations = iterations_of(actual_forward);
  const Iterations inverse_iterations = iterations_of(actual_inverse);
  return {
      {"lower bound: sqrt, atan2", [&floor] { floor.pass(); }, operations.floor},
      {"inverse, nominal", each_pose(nominal_inverse), operations.inverse, {}, kFloor},
      {"forward, 14 errors per limb", each_pose(actual_forward),
       operations.forward_start + forward_iterations.mean * operations.forward_iteration, forward_iterations, kInverse},
      {"inverse, 14 errors per limb", each_pose(actual_inverse),
       operations.inverse + inverse_iterations.mean * operations.inverse_iteration, inverse_iterations, kInverse},
      {"linear error model", each_pose(linear_model), operations.error_model, {}, kInverse},
      {"exact Jacobian", each_pose(jacobian), operations.exact_jacobian, {}, kInverse},
  };
}

double allocations_per_pose(const Candidate& candidate) {
  const std::size_t before = test::allocation_count();
  candidate.pass();
  return static_cast<double>(test::allocation_count() - before) / static_cast<double>(kPoses);
}

void print_header(const Task& task) {
  fmt::print("\n{}: {} limbs, {} random poses, {} rounds\n", task.robot.name(), task.robot.limb_count(), kPoses,
             kRounds);
  constexpr std::string_view kColumns = "{:<28}{:>8}{:>8}{:>8}  {:<18}{:>11}{:>7}{:>7}{:>6}{:>9}{:>7}\n";
  fmt::print(kColumns, "", "median", "p99", "max", "ratio, to", "iterations", "heap", "flop", "calls", "GFLOP/s",
             "share");
  fmt::print(kColumns, "", "ns", "ns", "ns", "", "mean, max", "blocks", "", "", "", "of peak");
}

/// @param seconds  of this candidate's pass, of its baseline and of the peak, a round.
void print_row(const Candidate& candidate, const std::string& baseline_name, const std::vector<double>& seconds,
               const std::vector<double>& baseline, const std::vector<double>& peak) {
  const double poses = static_cast<double>(kPoses), to_ns = 1e9 / poses;
  const Spread time = spread_of(seconds);
  const double work = candidate.operations.arithmetic * poses;
  const std::string ratio =
      &seconds == &baseline ? "" : fmt::format("{:6.2f} {}", median_ratio(seconds, baseline), baseline_name);
  const auto [mean, max] = candidate.iterations;
  const std::string iterations = max == 0 ? "" : fmt::format("{:.2f}, {}", mean, max);
  fmt::print("{:<28}{:>8.0f}{:>8.0f}{:>8.0f}  {:<18}{:>11}{:>7g}{:>7.0f}{:>6.0f}{:>9.2f}{:>6.0f}%\n", candidate.name,
             time.median * to_ns, time.p99 * to_ns, time.max * to_ns, ratio, iterations,
             allocations_per_pose(candidate), candidate.operations.arithmetic, candidate.operations.functions,
             work / time.median * 1e-9, 100.0 * median_ratio(peak, seconds) * work / compiled_peak().operations);
}

void report(const Robot& robot) {
  const Task task = make_task(robot, kPoses);
  const Floor floor(task);
  const std::vector<Candidate> candidates = candidates_of(task, floor);
  std::vector<Pass> passes;
  for (const Candidate& candidate : candidates) passes.push_back(candidate.pass);
  const Peak machine = machine_peak();
  passes.push_back(compiled_peak().pass);
  passes.push_back(machine.pass);
  const std::vector<std::vector<double>> seconds = interleave(passes, kRounds);
  const std::vector<double>& peak = seconds[candidates.size()];
  print_header(task);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::size_t baseline = candidates[k].baseline;
    print_row(candidates[k], baseline == kFloor ? "lower bound" : "inverse", seconds[k], seconds[baseline], peak);
    if (task.robot.name() == "huang2016" && k != kFloor) {
      compare_with_peak(fmt::format("`huang2016`: {}", candidates[k].name), "ns per pose", kPoses,
                        candidates[k].operations.arithmetic, seconds[k], machine, seconds.back(), peak);
    }
  }
  if (task.robot.name() == "huang2016") {
    compare({.task = "inverse kinematics of `huang2016`, nominal",
             .opponent = "lower bound: only its 4 square roots and 4 arctangents",
             .unit = "ns per pose"},
            {seconds[kInverse], kPoses}, {seconds[kFloor], kPoses});
  }
  fmt::print("peak of one core, multiply and add in turn: {:.1f} GFLOP/s; {}: {:.1f} GFLOP/s\n",
             compiled_peak().operations / spread_of(peak).median * 1e-9, machine.name,
             machine.operations / spread_of(seconds.back()).median * 1e-9);
  fmt::print("arctangents of the lower bound and joints of the inverse differ by at most {:.1g} rad\n",
             floor.difference(task));
}

}  // namespace

int main() {
  fmt::print("{}", host_description());
  fmt::print(
      "\nAll figures are per pose. Times: median, 99th percentile and maximum over the rounds; ratios: median of the\n"
      "ratios within the rounds (targets: inverse at most 2 lower bounds, forward at most 30 inverses). flop: + - * /\n"
      "and square roots; calls: sin, cos and atan2, which GFLOP/s and the percentage of the peak do not include.\n");
  for (const std::string_view name : catalogue::names()) {
    const Robot robot = catalogue::find(name);
    if (robot.actuator() == Actuator::revolute) report(robot);  // the floor is that of arms
  }
}
