#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration_reports.hpp"
#include "comparison.hpp"
#include "fresh_exchange.hpp"
#include "interleaved_timing.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/mechanism/catalogue.hpp"

namespace paracal::benchmark {
namespace {

constexpr int kCandidates = 10000, kPoses = 20, kRounds = 7;
constexpr std::size_t kSample = 2000;  // exchanges

std::vector<std::size_t> indices_of(const std::vector<Station>& chosen, const std::vector<Station>& candidates) {
  std::vector<std::size_t> indices;
  for (const Station& station : chosen) {
    const auto same = std::ranges::find(candidates, station.name, &Station::name);
    indices.push_back(static_cast<std::size_t>(same - candidates.begin()));
  }
  return indices;
}

/// One exchange of the sample: which chosen pose goes, and which candidate comes.
struct Exchanged {
  std::size_t place, candidate;
};

/// Spread over all chosen poses but home, and over the candidates.
Exchanged sample(std::size_t k) {
  constexpr std::size_t kStride = 4999;
  return {1 + k % (kPoses - 1), k * kStride % kCandidates};
}

/// All from the 20 poses: C^-1, its Cholesky factor, the trace.
void evaluate_afresh(const FreshCriterion& criterion, const std::vector<std::size_t>& chosen) {
  for (std::size_t k = 0; k < kSample; ++k) {
    const auto [place, candidate] = sample(k);
    std::vector<std::size_t> poses = chosen;
    poses[place] = candidate;
    keep(criterion.of(criterion.information(poses)));
  }
}

/// C^-1 of all chosen poses but one, for each of them but home.
std::vector<Eigen::MatrixXd> without_one(const FreshCriterion& criterion, const std::vector<std::size_t>& chosen) {
  std::vector<Eigen::MatrixXd> information;
  for (std::size_t place = 1; place < chosen.size(); ++place) {
    std::vector<std::size_t> others = chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(place));
    information.push_back(criterion.information(others));
  }
  return information;
}

/// The same with C^-1 of the other 19 poses at hand.
void evaluate_beside(const FreshCriterion& criterion, const std::vector<Eigen::MatrixXd>& others) {
  for (std::size_t k = 0; k < kSample; ++k) {
    const auto [place, candidate] = sample(k);
    keep(criterion.with(others[place - 1], candidate));
  }
}

void print_row(const char* name, const std::vector<double>& seconds, double times, double exchanges,
               const std::vector<double>& ours) {
  const Spread spread = spread_of(seconds);
  fmt::print("{:<46}{:>9.3f}{:>9.3f}{:>9.3f}{:>14.2f}{:>12.0f}\n", name, spread.median * times, spread.p99 * times,
             spread.max * times, spread.median * times / exchanges * 1e6, median_ratio(seconds, ours) * times);
}

}  // namespace

void report_selection() {
  const Robot robot = catalogue::huang2016();
  const std::vector<Station> candidates = candidate_stations(robot, kCandidates, 1);
  const SelectionOptions options{.poses = kPoses};
  const Selection selection = select_stations(robot, candidates, options);
  const FreshCriterion criterion(robot, candidates);
  const std::vector<std::size_t> chosen = indices_of(selection.stations, candidates);
  const std::vector<Eigen::MatrixXd> others = without_one(criterion, chosen);

  const auto seconds =
      interleave({[&] { keep(select_stations(robot, candidates, options)); },
                  [&] { evaluate_afresh(criterion, chosen); }, [&] { evaluate_beside(criterion, others); }},
                 kRounds);
  const double exchanges = selection.sweeps * (kPoses - 1.0) * kCandidates;
  const double times = exchanges / static_cast<double>(kSample);
  const auto against = [&](const char* opponent, const std::vector<double>& theirs) {
    compare({.task = "choosing 20 of 10,000 poses",
             .opponent = opponent,
             .unit = "s",
             .note = "extrapolated from 2,000 exchanges"},
            {seconds[0]}, {theirs, 1.0 / times});
  };
  against("plain method, our code: evaluates each exchange from the start", seconds[1]);
  against("plain method, our code: keeps the sum over the other 19 poses", seconds[2]);
  fmt::print(
      "\nSelecting {} of {} poses, huang2016: {} sweeps evaluate {} x {} exchanges each and make {}; {} rounds.\n"
      "Plain methods: extrapolated from {} exchanges; ours also includes the selection of the first set.\n",
      kPoses, kCandidates, selection.sweeps, kPoses - 1, kCandidates, selection.exchanges, kRounds, kSample);
  fmt::print("{:<46}{:>9}{:>9}{:>9}{:>14}{:>12}\n", "s", "median", "p99", "max", "us/exchange", "ratio");
  print_row("select_stations(), complete", seconds[0], 1.0, exchanges, seconds[0]);
  print_row("plain, each from the start", seconds[1], times, exchanges, seconds[0]);
  print_row("plain, with the sum over the other 19", seconds[2], times, exchanges, seconds[0]);
  fmt::print("(target: at least 50) criterion of the selected poses: {:.6g} mm^2; plain: relative difference {:.1g}\n",
             selection.criterion, std::abs(criterion.of(criterion.information(chosen)) / selection.criterion - 1.0));
}

}  // namespace paracal::benchmark
