#include "mistakes.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "paracal/kinematics/forward.hpp"
#include "wrong_nominal.hpp"

namespace paracal::detail {
namespace {

/// Sums over pairs of rotations, predicted and read, each from their mean.
struct Slope {
  double products = 0.0, squares = 0.0;

  void add(const std::vector<std::pair<double, double>>& pairs) {
    const auto count = static_cast<double>(pairs.size());
    double predicted = 0.0, read = 0.0;
    for (const auto& [p, r] : pairs) predicted += p / count, read += r / count;
    for (const auto& [p, r] : pairs) {
      products += (p - predicted) * (r - read);
      squares += (p - predicted) * (p - predicted);
    }
  }
};

/// Rotation read over rotation predicted: the pinion is smaller by that factor.
std::optional<double> rotation_ratio(const Input& input, const SourceErrors& errors) {
  const Machine machine = build(input.robot, errors);
  std::vector<double> phi;
  for (const Station& station : input.measurements.stations) {
    phi.push_back(machine.rotation_of(forward(machine, believed_joints(input.robot, station)).plate.slide));
  }
  Slope slope;
  for (const PointSeries& series : input.measurements.series) {
    std::vector<std::pair<double, double>> pairs;
    for (const PointReading& reading : series.readings) {
      if (reading.rotation) pairs.emplace_back(phi[reading.station], *reading.rotation);
    }
    slope.add(pairs);
  }
  for (const DistanceReading& reading : input.measurements.distances) {
    if (!reading.rotation) continue;
    const double turn = phi[reading.to] - phi[reading.from];
    slope.products += turn * *reading.rotation;
    slope.squares += turn * turn;
  }
  return slope.squares > 0.0 ? std::optional(slope.products / slope.squares) : std::nullopt;
}

SourceErrors errors_of(const TrialFit& fit) {
  SourceErrors errors;
  for (std::size_t k = 0; k < fit.sought.size(); ++k) {
    errors(fit.sought[k].limb, fit.sought[k].source) = fit.errors(static_cast<Eigen::Index>(k));
  }
  return errors;
}

}  // namespace

std::optional<Mistake> wrong_pinion(const Input& given) {
  constexpr double kAlike = 0.01, kFarOff = 10.0;
  constexpr int kSteps = 3;
  if (!given.robot.slide()) return std::nullopt;
  const Dimension pinion = pinion_radius();
  auto ratio = rotation_ratio(given, {});
  if (!ratio || *ratio < 1.0 / kFarOff || *ratio > kFarOff || std::abs(*ratio - 1.0) < kAlike) return std::nullopt;
  double radius = given.robot.slide()->pinion_radius / *ratio;
  const auto with_radius = [&] { return mistake_of(given.robot, {{pinion}, Eigen::VectorXd::Constant(1, radius)}); };
  for (int step = 0; step < kSteps; ++step) {
    const auto trial = undone(given, with_radius());
    const auto fit = trial ? fit_robustly(*trial) : std::nullopt;
    if (!fit) return std::nullopt;
    radius /= *rotation_ratio(*trial, errors_of(*fit));
  }
  return with_radius();
}

}  // namespace paracal::detail
