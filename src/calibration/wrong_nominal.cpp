#include "wrong_nominal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dimensions.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/units.hpp"
#include "reading_mistakes.hpp"

namespace paracal::detail {
namespace {

/// Numbers of the robot file that are wrong together, and what they should be.
struct Misprint {
  std::vector<Dimension> of;
  Eigen::VectorXd values;

  std::size_t count() const { return of.size(); }
  double value(std::size_t k) const { return values(static_cast<Eigen::Index>(k)); }
};

/// "rod_mm and arm_mm"
std::string key_of(const Misprint& misprint) {
  std::vector<std::string> keys;
  for (const Dimension& one : misprint.of) keys.push_back(one.key);
  return fmt::format("{}", fmt::join(keys, " and "));
}

Mistake mistake_of(const Robot& given, const Misprint& misprint) {
  std::vector<std::string> should, says;
  for (std::size_t k = 0; k < misprint.count(); ++k) {
    const Dimension& one = misprint.of[k];
    const auto shown = [&](double x) { return one.angle ? to_degrees(x) : x; };
    should.push_back(fmt::format("{} is {:.{}f}", one.key, shown(misprint.value(k)), one.angle ? 2 : 1));
    says.push_back(fmt::format("{:g}", shown(now(given, one))));
  }
  const std::string text = fmt::format("the readings fit a robot whose {}, the file says {}",
                                       fmt::join(should, " and "), fmt::join(says, " and "));
  return {MistakeKind::nominal, key_of(misprint), text, [misprint](Input& input) {
            state_joints(input.robot, input.measurements);
            for (std::size_t k = 0; k < misprint.count(); ++k) {
              input.robot = with(input.robot, misprint.of[k], misprint.value(k));
            }
          }};
}

std::vector<SourceErrors> directions_of(const std::vector<Dimension>& dimensions) {
  std::vector<SourceErrors> directions;
  directions.reserve(dimensions.size());
  for (const Dimension& one : dimensions) directions.push_back(one.direction);
  return directions;
}

Eigen::VectorXd now(const Robot& robot, const std::vector<Dimension>& dimensions) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(dimensions.size()));
  for (std::size_t k = 0; k < dimensions.size(); ++k) values(static_cast<Eigen::Index>(k)) = now(robot, dimensions[k]);
  return values;
}

/// Newton's method on the values, each step from a fit to the robot with the last ones.
std::optional<Misprint> best_values(const Input& given, Misprint misprint) {
  constexpr int kSteps = 4;
  constexpr double kSettled = 0.01;  // of the whole correction
  const std::vector<SourceErrors> directions = directions_of(misprint.of);
  const Eigen::VectorXd start = now(given.robot, misprint.of);
  for (int step = 0; step < kSteps; ++step) {
    Input trial = given;
    mistake_of(given.robot, misprint).undo(trial);
    const auto fit = fit_robustly(trial);
    if (!fit) return std::nullopt;
    const Eigen::VectorXd more = common_part(*fit, directions).amounts;
    misprint.values += more;
    if ((more.array().abs() < kSettled * (misprint.values - start).array().abs()).all()) break;
  }
  return misprint;
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
    mistake_of(given.robot, {{pinion}, Eigen::VectorXd::Constant(1, radius)}).undo(trial);
    const auto fit = fit_robustly(trial);
    if (!fit) return std::nullopt;
    radius /= *rotation_ratio(trial, errors_of(*fit));
  }
  return mistake_of(given.robot, {{pinion}, Eigen::VectorXd::Constant(1, radius)});
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

CommonPart common_part(const TrialFit& fit, const std::vector<SourceErrors>& directions) {
  constexpr double kUnseen = 1e-9;  // of the prior's own curvature
  const auto count = static_cast<Eigen::Index>(fit.sought.size()), m = static_cast<Eigen::Index>(directions.size());
  Eigen::MatrixXd along(count, m), weighted(count, m);  // D and L D
  for (Eigen::Index k = 0; k < count; ++k) {
    const SoughtSource& one = fit.sought[static_cast<std::size_t>(k)];
    for (Eigen::Index d = 0; d < m; ++d) along(k, d) = directions[static_cast<std::size_t>(d)](one.limb, one.source);
    weighted.row(k) = precision(one) * along.row(k);
  }
  const Eigen::MatrixXd prior = along.transpose() * weighted;
  const Eigen::MatrixXd curvature = prior - weighted.transpose() * fit.covariance * weighted;
  if (!(curvature.determinant() > kUnseen * prior.diagonal().prod())) return {Eigen::VectorXd::Zero(m)};
  const Eigen::VectorXd pull = weighted.transpose() * fit.errors;
  const Eigen::VectorXd amounts = curvature.ldlt().solve(pull);
  return {amounts, pull.dot(amounts)};
}

std::vector<Mistake> wrong_parts(const TrialFit& fit) {
  std::vector<std::pair<double, SourceSelector>> parts;
  for (const SoughtSource& one : fit.sought) {
    SourceErrors alone;
    alone(one.limb, one.source) = 1.0;
    const double gain = common_part(fit, {alone}).gain;
    if (gain > kWorthwhile) parts.emplace_back(gain, SourceSelector{one.source, one.limb});
  }
  std::vector<Mistake> mistakes;
  for (const auto& [gain, part] : most(std::move(parts))) {
    mistakes.push_back({MistakeKind::part, "part", "a wrong part",
                        [freed = part](Input& input) { input.options.free.push_back(freed); }});
  }
  return mistakes;
}

namespace {

/// Those of the sets that promise most, with the values that fit best.
std::vector<Mistake> best_misprints(const Input& given, const TrialFit& fit, std::vector<std::vector<Dimension>> sets) {
  std::vector<std::pair<double, Misprint>> promising;
  for (std::vector<Dimension>& set : sets) {
    const CommonPart part = common_part(fit, directions_of(set));
    if (part.gain <= kWorthwhile) continue;
    const Eigen::VectorXd values = now(given.robot, set) + part.amounts;
    promising.emplace_back(part.gain, Misprint{std::move(set), values});
  }
  std::vector<Mistake> mistakes;
  for (auto& [gain, start] : most(std::move(promising))) {
    try {
      if (const auto best = best_values(given, std::move(start))) mistakes.push_back(mistake_of(given.robot, *best));
    } catch (const Error&) {  // no such robot
    }
  }
  return mistakes;
}

}  // namespace

std::vector<Mistake> wrong_nominals(const Input& given, const TrialFit& fit) {
  std::vector<std::vector<Dimension>> sets;
  for (Dimension& one : dimensions(given.robot)) sets.push_back({std::move(one)});
  std::vector<Mistake> mistakes = best_misprints(given, fit, std::move(sets));
  if (auto pinion = wrong_pinion(given)) mistakes.push_back(std::move(*pinion));
  return mistakes;
}

std::optional<Mistake> wrong_scale(const Input& given, const TrialFit& fit) {
  constexpr int kSteps = 4;
  const SourceErrors larger = larger_robot(given.robot);
  const CommonPart part = common_part(fit, {larger});
  if (part.gain <= kWorthwhile) return std::nullopt;
  const auto read_in = [](double scale) {
    return [scale](Input& input) { scale_readings(input.measurements, 1.0 / scale); };
  };
  double scale = 1.0 + part.amounts(0);
  for (int step = 0; step < kSteps; ++step) {
    Input trial = given;
    read_in(scale)(trial);
    const auto with_scale = fit_robustly(trial);
    if (!with_scale) return std::nullopt;
    scale *= 1.0 + common_part(*with_scale, {larger}).amounts(0);
  }
  const std::string text = fmt::format("the readings are {:.4f} times as long as they should be", scale);
  return Mistake{MistakeKind::nominal, "scale", text, read_in(scale)};
}

std::vector<Mistake> wrong_pairs(const Input& given, const TrialFit& fit) {
  const std::vector<Dimension> all = dimensions_of_all_limbs(given.robot);
  std::vector<std::vector<Dimension>> pairs;
  for (std::size_t one = 0; one < all.size(); ++one) {
    for (std::size_t other = one + 1; other < all.size(); ++other) pairs.push_back({all[one], all[other]});
  }
  return best_misprints(given, fit, std::move(pairs));
}

}  // namespace paracal::detail
