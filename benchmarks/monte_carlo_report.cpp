#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>

#include "comparison.hpp"
#include "interleaved_timing.hpp"
#include "paracal/tolerance/response.hpp"
#include "peak.hpp"
#include "tilt_task.hpp"
#include "tolerance/drawing.hpp"
#include "tolerance_reports.hpp"
#ifdef PARACAL_BENCHMARK_OPENTURNS
#include "openturns_tilt.hpp"
#endif

namespace paracal::benchmark {
namespace {

constexpr int kRounds = 21;
constexpr std::uint64_t kMachines = 1U << 17;
constexpr std::uint64_t kChunk = 128;             // machines, as monte_carlo() takes them
constexpr unsigned kOpponentMachines = 1U << 13;  // enough: the time of one does not depend on their number
constexpr Eigen::Index kSize = 512;               // of the matrices of the peak
constexpr int kProducts = 8;                      // of them a pass

/// The parts of linear Monte Carlo by themselves, on threads of their own.
class Parts {
 public:
  Parts(const TiltTask& task, unsigned threads)
      : response_(task.robot, {task.requirement.characteristic}, task.poses),
        drawing_(task.robot, response_.linear(), *task.robot.tolerances()),
        errors_(drawing_.matrix().cols(), kChunk),
        square_(Eigen::MatrixXd::Random(kSize, kSize)),
        arena_(static_cast<int>(threads)) {
    drawing_.draw(1, 0, errors_);
  }

  const Eigen::MatrixXd& matrix() const { return drawing_.matrix(); }

  /// A multiplication and an addition an entry of the matrix.
  double operations_a_machine() const { return 2.0 * static_cast<double>(matrix().size()); }

  void draw() {
    for_each(kMachines / kChunk, [&](std::uint64_t chunk) {
      Eigen::MatrixXd errors(errors_.rows(), errors_.cols());
      drawing_.draw(1, chunk * kChunk, errors);
      keep(errors);
    });
  }

  void multiply() {
    for_each(kMachines / kChunk, [&](std::uint64_t) {
      Eigen::MatrixXd components(matrix().rows(), errors_.cols());
      components.noalias() = matrix() * errors_;
      keep(components);
    });
  }

  /// Large matrix products, one a thread at a time: as fast as the library's compiler flags let Eigen multiply.
  void multiply_large() {
    for_each(kProducts, [&](std::uint64_t) {
      Eigen::MatrixXd product(kSize, kSize);
      product.noalias() = square_ * square_;
      keep(product);
    });
  }

  static double large_operations() { return 2.0 * kProducts * std::pow(static_cast<double>(kSize), 3); }

 private:
  template <typename Body>
  void for_each(std::uint64_t count, const Body& body) {
    arena_.execute([&] { tbb::parallel_for(std::uint64_t{0}, count, body); });
  }

  Response response_;
  detail::Drawing drawing_;
  Eigen::MatrixXd errors_, square_;
  tbb::task_arena arena_;
};

enum : std::size_t { kAll, kDraw, kProduct, kPeak, kMachinePeak, kCompiledPeak, kOpponent };

using Rounds = std::vector<std::vector<double>>;

void print_row(const char* name, const std::vector<double>& seconds, std::uint64_t machines, std::size_t poses) {
  const Spread spread = spread_of(seconds);
  const double to_ns = 1e9 / static_cast<double>(machines);
  fmt::print("{:<36}{:>9.0f}{:>9.0f}{:>9.0f}{:>16.1f}\n", name, spread.median * to_ns, spread.p99 * to_ns,
             spread.max * to_ns, static_cast<double>(poses) / (spread.median * to_ns) * 1e3);
}

/// What monte_carlo() takes besides numbers and product, round by round.
std::vector<double> remainder(const Rounds& seconds) {
  std::vector<double> rest = seconds[kAll];
  for (std::size_t round = 0; round < rest.size(); ++round) {
    rest[round] -= seconds[kDraw][round] + seconds[kProduct][round];
  }
  return rest;
}

void print_share(const char* name, const Rounds& seconds, std::size_t index, double operations) {
  const double share = median_ratio(seconds[kPeak], seconds[index]) * operations / Parts::large_operations();
  fmt::print("{}: {:.2f} GFLOP/s, {:.1f} % of the peak\n", name, operations / spread_of(seconds[index]).median * 1e-9,
             100.0 * share);
}

void print_ours(const TiltTask& task, const Parts& parts, const Rounds& seconds) {
  const std::size_t poses = task.poses.size();
  fmt::print("{:<36}{:>9}{:>9}{:>9}{:>16}\n", "ns per machine", "median", "p99", "max", "Mega poses/s");
  print_row("monte_carlo(), complete", seconds[kAll], kMachines, poses);
  print_row("  only random numbers", seconds[kDraw], kMachines, poses);
  print_row("  only the product", seconds[kProduct], kMachines, poses);
  print_row("  the rest: reduction, yield, setup", remainder(seconds), kMachines, poses);
  const double operations = static_cast<double>(kMachines) * parts.operations_a_machine();
  fmt::print("peak: products of {} x {} by Eigen, {:.2f} GFLOP/s\n", kSize, kSize,
             Parts::large_operations() / spread_of(seconds[kPeak]).median * 1e-9);
  print_share("monte_carlo(), only operations of its product (target: at least 40 %)", seconds, kAll, operations);
  print_share("only the product", seconds, kProduct, operations);
}

#ifdef PARACAL_BENCHMARK_OPENTURNS
/// Standard deviation of the columns of the matrix: it holds the tilt group of every limb, in order.
Eigen::VectorXd column_std(const Tolerances& tolerances, Eigen::Index columns) {
  Eigen::VectorXd std(columns);
  for (Eigen::Index k = 0; k < columns; ++k) {
    std(k) = tolerances.std(
        sources_of(Actuator::revolute)[ErrorModel::kPosition + static_cast<std::size_t>(k) % ErrorModel::kTilt]);
  }
  return std;
}

OpenTurnsTilt opponent_of(const TiltTask& task, const Parts& parts) {
  return {parts.matrix(), column_std(*task.robot.tolerances(), parts.matrix().cols())};
}

constexpr std::array<std::pair<OpenTurnsWay, const char*>, 3> kWays{{
    {OpenTurnsWay::linear_function, "LinearFunction on one sample"},
    {OpenTurnsWay::small_samples, "LinearFunction on small samples"},
    {OpenTurnsWay::bare_product, "its matrix product"},
}};

/// How far two sigmas at the worst pose are apart, in standard errors.
double standard_errors_apart(const SigmaAtPose& ours, double theirs) {
  constexpr double kQuantile = 1.96;  // of the interval's confidence, 0.95
  const double error = (ours.interval.high - ours.interval.low) / (2.0 * kQuantile);
  return (theirs - ours.sigma) / (error * std::sqrt(1.0 + static_cast<double>(kMachines) / kOpponentMachines));
}

void print_opponent(const TiltTask& task, const OpenTurnsTilt& opponent, const Rounds& seconds, unsigned threads) {
  const RequirementStatistics drawn = task.monte_carlo(Model::linear, kMachines, threads).requirements.front();
  const std::string library = OpenTurnsTilt::libraries();
  fmt::print("{}, sigma only; {} thread{}\n", library, threads, threads == 1 ? "" : "s");
  for (std::size_t k = 0; k < kWays.size(); ++k) {
    const auto [way, title] = kWays[k];
    print_row(title, seconds[kOpponent + k], kOpponentMachines, task.poses.size());
    const double theirs = opponent.sigma(way, kOpponentMachines, threads)(static_cast<Eigen::Index>(drawn.worst));
    const double ratio = median_ratio(seconds[kOpponent + k], seconds[kAll]) * kMachines / kOpponentMachines;
    compare({.task = "linear Monte Carlo of tilt, 121 poses",
             .opponent = fmt::format("{}, {}", library, title),
             .unit = "us per machine",
             .threads = static_cast<int>(threads),
             .note = "OpenTURNS computes only sigma; paracal also computes its interval and the yield"},
            {seconds[kAll], kMachines}, {seconds[kOpponent + k], kOpponentMachines});
    fmt::print(
        "  {:.2f} times ours (target: at least 20); sigma at the worst pose {:.4f} mrad, ours {:.4f}: {:.1f} standard "
        "errors apart\n",
        ratio, 1e3 * theirs, 1e3 * drawn.at_worst().sigma, standard_errors_apart(drawn.at_worst(), theirs));
  }
}
#endif

}  // namespace

void report_linear_monte_carlo(unsigned threads) {
  const TiltTask task;
  Parts parts(task, threads);
  std::vector<Pass> passes{[&] { keep(task.monte_carlo(Model::linear, kMachines, threads)); },
                           [&] { parts.draw(); },
                           [&] { parts.multiply(); },
                           [&] { parts.multiply_large(); },
                           machine_peak().pass,
                           compiled_peak().pass};
#ifdef PARACAL_BENCHMARK_OPENTURNS
  const OpenTurnsTilt opponent = opponent_of(task, parts);
  for (const auto& [way, title] : kWays) {
    passes.push_back([&opponent, way, threads] { keep(opponent.sigma(way, kOpponentMachines, threads)); });
  }
#endif
  const Rounds seconds = interleave(passes, kRounds);
  fmt::print("\nLinear Monte Carlo of tilt at {} poses: {} rows x {} errors, {} machines, {} thread{}, {} rounds\n",
             task.poses.size(), parts.matrix().rows(), parts.matrix().cols(), kMachines, threads,
             threads == 1 ? "" : "s", kRounds);
  print_ours(task, parts, seconds);
  if (threads == 1) {
    for (const auto& [name, part] :
         {std::pair{"linear Monte Carlo of tilt, complete (only the operations of its product)", kAll},
          std::pair{"linear Monte Carlo of tilt: only its matrix product", kProduct}}) {
      compare_with_peak(name, "ns per machine", kMachines, parts.operations_a_machine(), seconds[part], machine_peak(),
                        seconds[kMachinePeak], seconds[kCompiledPeak]);
    }
  }
#ifdef PARACAL_BENCHMARK_OPENTURNS
  print_opponent(task, opponent, seconds, threads);
#else
  not_installed("linear Monte Carlo of tilt", "OpenTURNS", "libopenturns-dev");
#endif
}

}  // namespace paracal::benchmark
