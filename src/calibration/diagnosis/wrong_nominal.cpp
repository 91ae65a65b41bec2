#include "wrong_nominal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "mistakes.hpp"
#include "numerics/dense.hpp"
#include "paracal/units.hpp"
#include "reading_mistakes.hpp"

namespace paracal::detail {
namespace {

/// "rod_mm and arm_mm"
std::string key_of(const Misprint& misprint) {
  std::vector<std::string> keys;
  for (const Dimension& one : misprint.of) keys.push_back(one.key);
  return fmt::format("{}", fmt::join(keys, " and "));
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
    const auto fit = fit_without(given, mistake_of(given.robot, misprint));
    if (!fit) return std::nullopt;
    const Eigen::VectorXd more = common_part(*fit, directions).amounts;
    misprint.values += more;
    if ((more.array().abs() < kSettled * (misprint.values - start).array().abs()).all()) break;
  }
  return misprint;
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
    if (const auto best = best_values(given, std::move(start))) mistakes.push_back(mistake_of(given.robot, *best));
  }
  return mistakes;
}

Mistake scaled_readings(double scale) {
  return {MistakeKind::nominal, "scale", fmt::format("the scale of the readings is {:.4f} instead of 1", scale),
          [scale](Input& input) { scale_readings(input.measurements, 1.0 / scale); }};
}

}  // namespace

Mistake mistake_of(const Robot& given, const Misprint& misprint) {
  std::vector<std::string> should, says;
  for (std::size_t k = 0; k < misprint.count(); ++k) {
    const Dimension& one = misprint.of[k];
    const auto shown = [&](double x) { return one.angle ? to_degrees(x) : x; };
    should.push_back(fmt::format("{} = {:.{}f}", one.key, shown(misprint.value(k)), one.angle ? 2 : 1));
    says.push_back(fmt::format("{:g}", shown(now(given, one))));
  }
  const std::string text = fmt::format("the readings fit a robot file with {} instead of {}",
                                       fmt::join(should, " and "), fmt::join(says, " and "));
  return {MistakeKind::nominal, key_of(misprint), text, [misprint](Input& input) {
            state_joints(input.robot, input.measurements);
            for (std::size_t k = 0; k < misprint.count(); ++k) {
              input.robot = with(input.robot, misprint.of[k], misprint.value(k));
            }
          }};
}

CommonPart common_part(const TrialFit& fit, const std::vector<SourceErrors>& directions) {
  constexpr double kUnseen = 1e-9;  // of the prior's own curvature
  const auto count = static_cast<Eigen::Index>(fit.sought.size()), m = static_cast<Eigen::Index>(directions.size());
  Eigen::MatrixXd along(count, m), weighted(count, m);  // D and L D
  for (Eigen::Index k = 0; k < count; ++k) {
    const SoughtSource& one = fit.sought[static_cast<std::size_t>(k)];
    for (Eigen::Index d = 0; d < m; ++d) along(k, d) = directions[static_cast<std::size_t>(d)](one.limb, one.source);
    weighted.row(k) = precision(one) * along.row(k);
  }
  const Eigen::MatrixXd prior = product(along.transpose(), weighted);
  const Eigen::MatrixXd curvature = prior - product(product(weighted.transpose(), fit.covariance), weighted);
  if (!(determinant(curvature) > kUnseen * prior.diagonal().prod())) return {Eigen::VectorXd::Zero(m)};
  const Eigen::VectorXd pull = product(weighted.transpose(), fit.errors);
  const Eigen::VectorXd amounts = symmetric_solution(curvature, pull);
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
  double scale = 1.0 + part.amounts(0);
  for (int step = 0; step < kSteps; ++step) {
    const auto with_scale = fit_without(given, scaled_readings(scale));
    if (!with_scale) return std::nullopt;
    scale *= 1.0 + common_part(*with_scale, {larger}).amounts(0);
  }
  return scaled_readings(scale);
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
