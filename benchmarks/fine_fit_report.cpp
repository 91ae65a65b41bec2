#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "calibration_reports.hpp"
#include "comparison.hpp"
#include "fine_fit.hpp"
#include "fine_solve.hpp"
#include "interleaved_timing.hpp"
#include "paracal/calibration/identification.hpp"
#include "peak.hpp"
#include "scipy_fit.hpp"
#ifdef PARACAL_BENCHMARK_CERES
#include "ceres_fit.hpp"
#endif

namespace paracal::benchmark {
namespace {

constexpr std::uint64_t kMachines = 10;
constexpr int kRounds = 100, kScipyRounds = 5;
const std::string kTask = "fine fit of 19 points, 62 unknowns";

/// Another way to the same answer.
struct Solver {
  std::string name;
  std::function<FineAnswer(std::size_t)> solve;  ///< the fit with this index
};

enum : std::size_t { kCalibrate, kFineSolve };

CalibrationOptions fine_stage() { return {.stage = Stage::fine}; }

FineAnswer calibrate_all(const FineFit& fit) {
  const Calibration calibration = calibrate(fit.robot, fit.measurements, fine_stage());
  return {calibration.errors(), calibration.frames.front().frame, calibration.stages.back().iterations};
}

std::vector<Solver> solvers_of(const std::vector<FineFit>& fits,
                               const std::vector<std::unique_ptr<FineSolve>>& fine_solves) {
  std::vector<Solver> solvers{
      {"calibrate(): rough, fine, evidence", [&](std::size_t k) { return calibrate_all(fits[k]); }},
      {"only its fine least squares", [&](std::size_t k) { return (*fine_solves[k])(); }},
  };
#ifdef PARACAL_BENCHMARK_CERES
  const auto add_ceres = [&](const char* how, const char* name, CeresCost cost, CeresSolver solver) {
    solvers.push_back({fmt::format("{}, {}, {}", ceres_version(), how, name),
                       [&fits, cost, solver](std::size_t k) { return solve_with_ceres(fits[k], cost, solver); }});
  };
  for (const auto& [name, solver] : {std::pair{"Cholesky", CeresSolver::normal_cholesky}, {"QR", CeresSolver::qr}}) {
    add_ceres("automatic derivatives per station", name, CeresCost::one_station, solver);
    add_ceres("automatic derivatives, the closure's by hand", name, CeresCost::all_stations, solver);
    solvers.push_back(
        {fmt::format("{}, with the Jacobian of paracal, {}", ceres_version(), name),
         [&fine_solves, solver = solver](std::size_t k) { return solve_with_ceres(*fine_solves[k], solver); }});
  }
#endif
  return solvers;
}

/// How the answers of one solver end up, over all fits.
struct Agreement {
  double iterations = 0.0;  ///< mean
  double cost_above = 0.0;  ///< largest share by which the cost is above that of our fine least squares
  double cost_below = 0.0;  ///< or below
};

Agreement agreement_of(const std::vector<FineFit>& fits, const Solver& solver, const std::vector<double>& costs) {
  Agreement agreement;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const FineAnswer answer = solver.solve(k);
    const double share = squared_residuals(fits[k], answer) / costs[k] - 1.0;
    agreement.iterations += static_cast<double>(answer.iterations) / static_cast<double>(fits.size());
    agreement.cost_above = std::max(agreement.cost_above, share);
    agreement.cost_below = std::max(agreement.cost_below, -share);
  }
  return agreement;
}

std::vector<double> costs_of(const std::vector<FineFit>& fits,
                             const std::vector<std::unique_ptr<FineSolve>>& fine_solves) {
  std::vector<double> costs;
  for (std::size_t k = 0; k < fits.size(); ++k) costs.push_back(squared_residuals(fits[k], (*fine_solves[k])()));
  return costs;
}

/// One orthogonal factorization of [J | r] a linearization.
double factorization_operations(const FineFit& fit, double iterations) {
  const double columns = kFrame + kSources + 1, rows = 3.0 * static_cast<double>(fit.points.size()) + kSources;
  return (iterations + 1.0) * 2.0 * columns * columns * (rows - columns / 3.0);
}

void print_header(const FineFit& fit) {
  fmt::print(
      "\nFine fit of huang2016: {} points, noise {} mm, {} source errors with priors, {} unknowns of the frame; {} "
      "machines in\n"
      "turn, {} rounds. All except calibrate() start at the end of its rough stage, with the best frame there.\n"
      "(cost: relative difference above and below the fine fit alone)\n",
      fit.points.size(), fit.sigma, kSources, kFrame, kMachines, kRounds);
  fmt::print("{:<72}{:>8}{:>8}{:>8}{:>14}{:>14}{:>12}{:>18}\n", "ms per fit", "median", "p99", "max", "calibrate()",
             "fine alone", "iterations", "cost, at most");
}

void print_row(const Solver& solver, const Agreement& agreement, const std::vector<std::vector<double>>& seconds,
               std::size_t index) {
  const Spread spread = spread_of(seconds[index]);
  const double to_ms = 1e3 / static_cast<double>(kMachines);
  fmt::print("{:<72}{:>8.3f}{:>8.3f}{:>8.3f}{:>14.2f}{:>14.2f}{:>12.1f}   +{:.0e} -{:.0e}\n", solver.name,
             spread.median * to_ms, spread.p99 * to_ms, spread.max * to_ms,
             median_ratio(seconds[index], seconds[kCalibrate]), median_ratio(seconds[index], seconds[kFineSolve]),
             agreement.iterations, agreement.cost_above, agreement.cost_below);
}

void print_floor(const FineFit& fit, double iterations, const std::vector<std::vector<double>>& seconds) {
  const double operations_a_second = compiled_peak().operations / spread_of(seconds.back()).median;
  fmt::print("lower bound: one QR of its rows per linearization at the peak of one core, {:.1f} GFLOP/s: {:.3f} ms\n",
             operations_a_second * 1e-9, factorization_operations(fit, iterations) / operations_a_second * 1e3);
}

/// Our fine least squares, and all of calibrate(), beside the fastest of the others.
void record(const std::vector<Solver>& solvers, const std::vector<Agreement>& agreements,
            const std::vector<std::vector<double>>& seconds) {
  const auto against = [&](const std::string& task, std::size_t ours, std::size_t theirs, const std::string& note) {
    compare({.task = task, .opponent = solvers[theirs].name, .unit = "ms per fit", .note = note},
            {seconds[ours], kMachines}, {seconds[theirs], kMachines});
  };
  std::size_t fastest = kFineSolve;
  for (std::size_t k = kFineSolve + 1; k < solvers.size(); ++k) {
    const Agreement& agreement = agreements[k];
    against(kTask, kFineSolve, k,
            fmt::format("costs differ by at most {:.0e}", std::max(agreement.cost_above, agreement.cost_below)));
    if (fastest == kFineSolve || median_ratio(seconds[k], seconds[fastest]) < 1.0) fastest = k;
  }
  if (fastest == kFineSolve) return not_installed(kTask, "Ceres", "libceres-dev");
  against(
      "complete `calibrate` from 19 points", kCalibrate, fastest,
      "Ceres: only the fine fit; `calibrate` also finds the start, outliers, variance components and uncertainties");
}

void report_scipy(const std::vector<FineFit>& fits, const std::vector<double>& costs, const Pass& ours) {
  ScipyFits scipy(fits, costs);
  if (scipy.versions().empty()) {
    fmt::print("SciPy (python3-scipy) is not installed: no comparison\n");
    return not_installed(kTask, "SciPy", "python3-scipy");
  }
  const std::vector<std::string> methods{"trf", "lm"};
  std::vector<double> apart(methods.size());
  std::vector<Pass> passes{ours};
  for (std::size_t k = 0; k < methods.size(); ++k) passes.push_back([&, k] { apart[k] = scipy.solve(methods[k]); });
  const auto seconds = interleave(passes, kScipyRounds);
  for (std::size_t k = 0; k < methods.size(); ++k) {
    const std::string name = fmt::format("{}, least_squares(method=\"{}\")", scipy.versions(), methods[k]);
    fmt::print("{:<46}{:>8.0f} ms, {:.0f} times ours; costs differ by at most {:.0e}\n", name,
               1e3 / static_cast<double>(kMachines) * spread_of(seconds[k + 1]).median,
               median_ratio(seconds[k + 1], seconds[0]), apart[k]);
    compare({.task = kTask,
             .opponent = name,
             .unit = "ms per fit",
             .note = fmt::format("vectorised residuals, derivatives by differences; costs differ by at most {:.0e}",
                                 apart[k])},
            {seconds[0], kMachines}, {seconds[k + 1], kMachines});
  }
}

}  // namespace

void report_fine_fit() {
  std::vector<FineFit> fits;
  for (std::uint64_t machine = 0; machine < kMachines; ++machine) fits.push_back(make_fine_fit(machine));
  std::vector<std::unique_ptr<FineSolve>> fine_solves;
  for (const FineFit& fit : fits) fine_solves.push_back(std::make_unique<FineSolve>(fit));
  const std::vector<Solver> solvers = solvers_of(fits, fine_solves);
  const std::vector<double> costs = costs_of(fits, fine_solves);

  std::vector<Pass> passes;
  for (const Solver& solver : solvers) {
    passes.push_back([&] {
      for (std::size_t k = 0; k < fits.size(); ++k) keep(solver.solve(k));
    });
  }
  passes.push_back(compiled_peak().pass);
  const std::vector<std::vector<double>> seconds = interleave(passes, kRounds);

  print_header(fits.front());
  std::vector<Agreement> agreements;
  for (std::size_t k = 0; k < solvers.size(); ++k) {
    agreements.push_back(agreement_of(fits, solvers[k], costs));
    print_row(solvers[k], agreements.back(), seconds, k);
  }
  print_floor(fits.front(), agreements[kFineSolve].iterations, seconds);
  record(solvers, agreements, seconds);
  report_scipy(fits, costs, passes[kFineSolve]);
}

}  // namespace paracal::benchmark
