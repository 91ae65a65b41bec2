#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "calibration_reports.hpp"
#include "fine_fit.hpp"
#include "fine_solve.hpp"
#include "interleaved_timing.hpp"
#include "paracal/calibration/identification.hpp"
#include "peak.hpp"
#ifdef PARACAL_BENCHMARK_CERES
#include "ceres_fit.hpp"
#endif

namespace paracal::benchmark {
namespace {

constexpr std::uint64_t kMachines = 10;
constexpr int kRounds = 100;

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
      {"its fine least squares alone", [&](std::size_t k) { return (*fine_solves[k])(); }},
  };
#ifdef PARACAL_BENCHMARK_CERES
  const auto add_ceres = [&](const char* name, CeresCost cost, CeresSolver solver) {
    solvers.push_back({name, [&fits, cost, solver](std::size_t k) { return solve_with_ceres(fits[k], cost, solver); }});
  };
  add_ceres("Ceres, a cost a station, Cholesky", CeresCost::one_station, CeresSolver::normal_cholesky);
  add_ceres("Ceres, one cost for all, Cholesky", CeresCost::all_stations, CeresSolver::normal_cholesky);
  add_ceres("Ceres, one cost for all, QR", CeresCost::all_stations, CeresSolver::qr);
#endif
  return solvers;
}

/// How the answers of one solver end up, over all fits.
struct Agreement {
  double iterations = 0.0;  ///< mean
  double cost_above = 0.0;  ///< largest share by which the cost is above calibrate()'s
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

std::vector<double> costs_of(const std::vector<FineFit>& fits) {
  std::vector<double> costs;
  for (const FineFit& fit : fits) costs.push_back(squared_residuals(fit, calibrate_all(fit)));
  return costs;
}

/// One orthogonal factorization of [J | r] a linearization.
double factorization_operations(const FineFit& fit, double iterations) {
  const double columns = kFrame + kSources + 1, rows = 3.0 * static_cast<double>(fit.points.size()) + kSources;
  return (iterations + 1.0) * 2.0 * columns * columns * (rows - columns / 3.0);
}

void print_header(const FineFit& fit) {
  fmt::print(
      "\nFine fit of huang2016: {} points of {} mm, {} source errors with priors, {} of the frame; {} machines in "
      "turn,\n"
      "{} rounds. All but calibrate() start where its rough stage ends, with the frame that fits best there.\n"
      "(aims: Ceres at least 5, SciPy at least 200 times ours; cost: how far above and below calibrate()'s, a share)\n",
      fit.points.size(), fit.sigma, kSources, kFrame, kMachines, kRounds);
  fmt::print("{:<36}{:>8}{:>8}{:>8}{:>14}{:>14}{:>12}{:>18}\n", "ms a fit", "median", "p99", "max", "calibrate()",
             "fine alone", "iterations", "cost, at most");
}

void print_row(const Solver& solver, const Agreement& agreement, const std::vector<std::vector<double>>& seconds,
               std::size_t index) {
  const Spread spread = spread_of(seconds[index]);
  const double to_ms = 1e3 / static_cast<double>(kMachines);
  fmt::print("{:<36}{:>8.3f}{:>8.3f}{:>8.3f}{:>14.2f}{:>14.2f}{:>12.1f}   +{:.0e} -{:.0e}\n", solver.name,
             spread.median * to_ms, spread.p99 * to_ms, spread.max * to_ms,
             median_ratio(seconds[index], seconds[kCalibrate]), median_ratio(seconds[index], seconds[kFineSolve]),
             agreement.iterations, agreement.cost_above, agreement.cost_below);
}

void print_floor(const FineFit& fit, double iterations, const std::vector<std::vector<double>>& seconds) {
  const double operations_a_second = peak_operations() / spread_of(seconds.back()).median;
  fmt::print("floor: one QR of its rows a linearization at the peak of one core, {:.1f} GFLOP/s: {:.3f} ms\n",
             operations_a_second * 1e-9, factorization_operations(fit, iterations) / operations_a_second * 1e3);
}

nlohmann::json numbers(const Eigen::MatrixXd& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& row : matrix.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

nlohmann::json robot_as_json(const Robot& robot) {
  const Geometry& geometry = robot.geometry();
  return {{"base_radius", geometry.base_radius},
          {"plate_radius", geometry.plate_radius},
          {"arm", geometry.arm},
          {"rod", geometry.rod},
          {"parallelogram_width", geometry.parallelogram_width},
          {"limb_azimuth", geometry.limb_azimuth},
          {"slide_axis", numbers(robot.slide()->axis.transpose())[0]},
          {"slide_sign", robot.slide()->sign}};
}

/// Position and slide, mm.
nlohmann::json plate_as_json(const Robot& robot, const Pose& pose) {
  const Eigen::Vector3d& position = pose.position;
  return {position.x(), position.y(), position.z(), robot.nominal().slide_of(pose.rotation)};
}

nlohmann::json fit_as_json(const FineFit& fit, double cost) {
  nlohmann::json points, commanded, joints, start;
  for (std::size_t k = 0; k < fit.points.size(); ++k) {
    points.push_back(numbers(fit.points[k].transpose())[0]);
    joints.push_back(numbers(fit.joints[k].transpose())[0]);
    commanded.push_back(plate_as_json(fit.robot, fit.measurements.stations[k].commanded));
  }
  for (std::size_t k = 0; k < kSources; ++k)
    start.push_back(fit.start(k / kSourceCount, all_sources()[k % kSourceCount]));
  return {{"points", points},
          {"joints", joints},
          {"commanded", commanded},
          {"start", start},
          {"rotation", numbers(fit.frame.rotation)},
          {"translation", numbers(fit.frame.translation.transpose())[0]},
          {"squared_residuals", cost}};
}

void write_tasks(const std::string& path, const std::vector<FineFit>& fits, const std::vector<double>& costs,
                 const std::vector<std::vector<double>>& seconds) {
  nlohmann::json all{{"robot", robot_as_json(fits.front().robot)},
                     {"sigma", fits.front().sigma},
                     {"prior_std", numbers(fits.front().prior_std.transpose())[0]}};
  for (std::size_t k = 0; k < fits.size(); ++k) all["fits"].push_back(fit_as_json(fits[k], costs[k]));
  const double to_ms = 1e3 / static_cast<double>(kMachines);
  all["milliseconds"] = {{"calibrate()", spread_of(seconds[kCalibrate]).median * to_ms},
                         {"its fine least squares alone", spread_of(seconds[kFineSolve]).median * to_ms}};
  if (!(std::ofstream(path) << all.dump(1) << '\n')) fmt::print("cannot write \"{}\"\n", path);
}

}  // namespace

void report_fine_fit(const std::string& tasks) {
  std::vector<FineFit> fits;
  for (std::uint64_t machine = 0; machine < kMachines; ++machine) fits.push_back(make_fine_fit(machine));
  std::vector<std::unique_ptr<FineSolve>> fine_solves;
  for (const FineFit& fit : fits) fine_solves.push_back(std::make_unique<FineSolve>(fit));
  const std::vector<Solver> solvers = solvers_of(fits, fine_solves);
  const std::vector<double> costs = costs_of(fits);

  std::vector<Pass> passes;
  for (const Solver& solver : solvers) {
    passes.push_back([&] {
      for (std::size_t k = 0; k < fits.size(); ++k) keep(solver.solve(k));
    });
  }
  passes.push_back(peak_pass);
  const std::vector<std::vector<double>> seconds = interleave(passes, kRounds);

  print_header(fits.front());
  double iterations = 0.0;
  for (std::size_t k = 0; k < solvers.size(); ++k) {
    const Agreement agreement = agreement_of(fits, solvers[k], costs);
    if (k == kFineSolve) iterations = agreement.iterations;
    print_row(solvers[k], agreement, seconds, k);
  }
  print_floor(fits.front(), iterations, seconds);
  if (!tasks.empty()) write_tasks(tasks, fits, costs, seconds);
}

}  // namespace paracal::benchmark
