#include "wrong_nominal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dimensions.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

Mistake mistake_of(const Robot& given, const Dimension& dimension, double value) {
  const auto shown = [&](double x) { return dimension.angle ? to_degrees(x) : x; };
  const std::string text =
      fmt::format("the readings fit a robot whose {} is {:.{}f}, the file says {:g}", dimension.key, shown(value),
                  dimension.angle ? 2 : 1, shown(now(given, dimension)));
  return {MistakeKind::nominal, dimension.key, text, [dimension, value](Input& input) {
            state_joints(input.robot, input.measurements);
            input.robot = with(input.robot, dimension, value);
          }};
}

/// Newton's method on the value, each step from a fit to the robot with the last one.
std::optional<double> best_value(const Input& given, const Dimension& dimension, double value) {
  constexpr int kSteps = 4;
  constexpr double kSettled = 0.01;  // of the whole correction
  const double start = now(given.robot, dimension);
  for (int step = 0; step < kSteps; ++step) {
    Input trial = given;
    mistake_of(given.robot, dimension, value).undo(trial);
    const auto fit = fit_robustly(trial);
    if (!fit) return std::nullopt;
    const double more = common_part(*fit, dimension.direction).amount;
    value += more;
    if (std::abs(more) < kSettled * std::abs(value - start)) break;
  }
  return value;
}

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

/// From the nominal machine, then from that which fits with the pinion found so.
std::optional<Mistake> wrong_pinion(const Input& given) {
  constexpr double kAlike = 0.01, kFarOff = 10.0;
  constexpr int kSteps = 3;
  if (!given.robot.slide()) return std::nullopt;
  const Dimension pinion{"pinion_radius_mm", false,
                         [](RobotDescription& r) -> double& { return r.slide->pinion_radius; }};
  auto ratio = rotation_ratio(given, {});
  if (!ratio || *ratio < 1.0 / kFarOff || *ratio > kFarOff || std::abs(*ratio - 1.0) < kAlike) return std::nullopt;
  double radius = given.robot.slide()->pinion_radius / *ratio;
  for (int step = 0; step < kSteps; ++step) {
    Input trial = given;
    mistake_of(given.robot, pinion, radius).undo(trial);
    const auto fit = fit_robustly(trial);
    if (!fit) return std::nullopt;
    radius /= *rotation_ratio(trial, errors_of(*fit));
  }
  return mistake_of(given.robot, pinion, radius);
}

constexpr double kWorthwhile = 20.0;  // of twice the objective: less than any mistake that is named

/// The few with the largest gain, which stands first.
template <typename Candidate>
std::vector<Candidate> most(std::vector<Candidate> candidates) {
  constexpr std::size_t kTried = 3;
  std::ranges::stable_sort(candidates, std::greater{}, [](const Candidate& one) { return one.first; });
  if (candidates.size() > kTried) candidates.erase(candidates.begin() + kTried, candidates.end());
  return candidates;
}

/// Inverse variance of a prior.
double precision(const SoughtSource& one) { return one.prior_std ? 1.0 / (*one.prior_std * *one.prior_std) : 0.0; }

}  // namespace

CommonPart common_part(const TrialFit& fit, const SourceErrors& direction) {
  constexpr double kUnseen = 1e-9;  // of the prior's own curvature
  const auto count = static_cast<Eigen::Index>(fit.sought.size());
  Eigen::VectorXd weighted(count);  // L d
  double prior = 0.0;               // d^T L d
  for (Eigen::Index k = 0; k < count; ++k) {
    const SoughtSource& one = fit.sought[static_cast<std::size_t>(k)];
    const double along = direction(one.limb, one.source);
    weighted(k) = precision(one) * along;
    prior += weighted(k) * along;
  }
  const double curvature = prior - weighted.dot(fit.covariance * weighted);
  if (!(curvature > kUnseen * prior)) return {};
  const double pull = weighted.dot(fit.errors);
  return {pull / curvature, pull * pull / curvature};
}

std::vector<Mistake> wrong_parts(const TrialFit& fit) {
  std::vector<std::pair<double, SourceSelector>> parts;
  for (const SoughtSource& one : fit.sought) {
    SourceErrors alone;
    alone(one.limb, one.source) = 1.0;
    const double gain = common_part(fit, alone).gain;
    if (gain > kWorthwhile) parts.emplace_back(gain, SourceSelector{one.source, one.limb});
  }
  std::vector<Mistake> mistakes;
  for (const auto& [gain, part] : most(std::move(parts))) {
    mistakes.push_back({MistakeKind::part, "part", "a wrong part",
                        [freed = part](Input& input) { input.options.free.push_back(freed); }});
  }
  return mistakes;
}

std::vector<Mistake> wrong_nominals(const Input& given, const TrialFit& fit) {
  std::vector<std::pair<double, Dimension>> promising;
  for (Dimension& dimension : dimensions(given.robot)) {
    const double gain = common_part(fit, dimension.direction).gain;
    if (gain > kWorthwhile) promising.emplace_back(gain, std::move(dimension));
  }
  std::vector<Mistake> mistakes;
  for (const auto& [gain, dimension] : most(std::move(promising))) {
    const double start = now(given.robot, dimension) + common_part(fit, dimension.direction).amount;
    try {
      if (const auto value = best_value(given, dimension, start)) {
        mistakes.push_back(mistake_of(given.robot, dimension, *value));
      }
    } catch (const Error&) {  // no such robot
    }
  }
  if (auto pinion = wrong_pinion(given)) mistakes.push_back(std::move(*pinion));
  return mistakes;
}

}  // namespace paracal::detail
