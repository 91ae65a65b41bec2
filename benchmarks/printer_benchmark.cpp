// Time of fits of delta printers, on the published measurements of data/klipper-delta: the firmware's cost by least
// squares and by its own method (coordinate descent), and the complete calibration. kinematics_benchmark.cpp explains
// why it uses plain chrono code.
//
//   paracal-printer-benchmark
//
// The opponent is the firmware's algorithm [klipper] on our own compiled cost; in the firmware it runs in Python.
// It only reports: the exit status is always 0.

#include <fmt/format.h>

#include "comparison.hpp"
#include "host.hpp"
#include "interleaved_timing.hpp"
#include "paracal/printer/printer_calibration.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"

namespace paracal::benchmark {
namespace {

using test::KlipperSet;

struct Descent {
  DeltaGeometry geometry;
  double cost = 0.0;
  int rounds = 0;
};

/// One number after the other, in mm and deg: steps that help grow by a tenth, others shrink by a tenth; until their
/// sum is below 1e-5, or 10000 rounds.
Descent coordinate_descent(const DeltaGeometry& start, const DeltaReadings& readings) {
  const DeltaBasis basis = firmware_basis(start.actuator, !readings.distances.empty());
  const auto is_angle = [&](Eigen::Index k) { return basis.col(k).segment<2>(DeltaNumber::angle).any(); };
  Descent found{.geometry = start, .cost = judge_as_firmware(start, readings).cost};
  Eigen::VectorXd step = Eigen::VectorXd::Ones(basis.cols());
  for (; step.sum() > 1e-5 && found.rounds < 10000; ++found.rounds) {
    for (Eigen::Index k = 0; k < basis.cols(); ++k) {
      const DeltaNumbers numbers = numbers_of(found.geometry);
      const double size = is_angle(k) ? to_radians(step(k)) : step(k);
      const auto helps = [&](double change) {
        const DeltaFit fit = judge_as_firmware(with_numbers(start, numbers + change * basis.col(k)), readings);
        if (!fit.ok() || !(fit.cost < found.cost)) return false;
        found.geometry = fit.geometry;
        found.cost = fit.cost;
        return true;
      };
      step(k) *= helps(size) || helps(-size) ? 1.1 : 0.9;
    }
  }
  return found;
}

/// Away from the optimum by what an owner's first guess is.
DeltaGeometry first_guess(DeltaGeometry geometry) {
  geometry.radius += 0.5;
  geometry.endstop[0] += 0.4;
  geometry.endstop[1] -= 0.3;
  geometry.tower_angle[1] += to_radians(0.2);
  return geometry;
}

constexpr int kRounds = 15, kRepeats = 50;

/// Seconds of all sets of a kind, round by round.
struct Sum {
  std::vector<double> fit = std::vector<double>(kRounds), descent = fit, whole = fit;
  int sets = 0;

  void add(const std::vector<std::vector<double>>& seconds) {
    for (std::size_t k = 0; k < kRounds; ++k) {
      fit[k] += seconds[0][k] / kRepeats;
      descent[k] += seconds[1][k];
      whole[k] += seconds[2][k];
    }
    ++sets;
  }

  void record(const std::string& readings) const {
    if (sets == 0) return;
    compare({.task = fmt::format("the firmware's fit of a printer, {} ({} sets)", readings, sets),
             .opponent = "Klipper's coordinate descent: its algorithm in our compiled code",
             .unit = "ms per fit",
             .note = "in the firmware it runs in Python"},
            {fit, static_cast<double>(sets)}, {descent, static_cast<double>(sets)});
    state(fmt::format("`calibrate --printer`, {}", readings), 1e3 * spread_of(whole).median / sets, "ms");
  }
};

void report(const KlipperSet& set, Sum& sum) {
  const DeltaGeometry start = first_guess(set.geometry);
  const auto fits = [&] {
    for (int k = 0; k < kRepeats; ++k) keep(fit_as_firmware(start, set.readings));
  };
  const auto descends = [&] { keep(coordinate_descent(start, set.readings)); };
  const auto calibrates = [&] { keep(calibrate_printer(set.geometry, set.readings)); };
  const auto seconds = interleave({fits, descends, calibrates}, kRounds);
  sum.add(seconds);
  const Spread fit = spread_of(seconds[0]), descent = spread_of(seconds[1]), whole = spread_of(seconds[2]);
  const Descent found = coordinate_descent(start, set.readings);
  const DeltaFit best = fit_as_firmware(start, set.readings);
  constexpr double kMicro = 1e6 / kRepeats;
  fmt::print("{:<5}{:>4}{:>4}{:>9.1f}{:>9.1f}{:>9.1f}{:>10.1f}{:>9.0f}{:>8}{:>12.2e}{:>12.1e}{:>10.1f}\n", set.id,
             set.readings.heights.size(), set.readings.distances.size(), kMicro * fit.median, kMicro * fit.p99,
             kMicro * fit.max, 1e3 * descent.median, kRepeats * descent.median / fit.median, found.rounds,
             found.cost / best.cost - 1.0, best.cost / set.best_cost - 1.0, 1e3 * whole.median);
}

void run() {
  const std::vector<KlipperSet> sets = test::klipper_sets();
  fmt::print("{}\n", host_description());
  fmt::print(
      "h, d: heights and distances; fit, us (median, p99, max); descent: coordinate descent of the same cost from the\n"
      "same start, ms; its time divided by the fit's; its rounds; its relative cost above the fit's; the fit's cost\n"
      "above SciPy's; complete calibration with its ladder, ms\n\n");
  fmt::print("{:<5}{:>4}{:>4}{:>9}{:>9}{:>9}{:>10}{:>9}{:>8}{:>12}{:>12}{:>10}\n", "set", "h", "d", "fit", "p99", "max",
             "descent", "times", "rounds", "cost above", "SciPy's", "whole");
  Sum heights, distances;
  for (const KlipperSet& set : sets) report(set, set.readings.distances.empty() ? heights : distances);
  heights.record("heights");
  distances.record("heights and distances");
}

}  // namespace
}  // namespace paracal::benchmark

int main() { paracal::benchmark::run(); }
