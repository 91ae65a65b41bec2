#include "source_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "numerics/distributions.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::detail {
namespace {

constexpr double kLargestTilt = 30.0;  // standard deviations
constexpr double kCut = 3.0;           // where a truncated normal law ends, in standard deviations of the whole one

double normal_density(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi); }

/// log(sinh(x) / x)
double log_sinh_over(double x) {
  constexpr double kSmall = 1e-4;
  const double size = std::abs(x);
  if (size < kSmall) return x * x / 6.0;
  return size - std::log(2.0 * size) + std::log1p(-std::exp(-2.0 * size));
}

/// coth(x) - 1 / x
double langevin(double x) {
  constexpr double kSmall = 1e-3;
  return std::abs(x) < kSmall ? x / 3.0 : 1.0 / std::tanh(x) - 1.0 / x;
}

/// Of a standard normal law around `shift`, what lies within the cut.
double within_cut(double shift) { return normal_probability(kCut - shift) - normal_probability(-kCut - shift); }

/// The quantile of exp(x e) on [-1, 1].
double exponential_quantile(double x, double probability) {
  constexpr double kSmall = 1e-9;
  if (std::abs(x) < kSmall) return 2.0 * probability - 1.0;
  if (x < 0.0) return -exponential_quantile(-x, 1.0 - probability);
  return 1.0 + std::log(probability + (1.0 - probability) * std::exp(-2.0 * x)) / x;
}

/// The quantile of a standard normal law around `shift`, cut off at +-kCut: from the side that is nearer to its tail.
double cut_quantile(double shift, double probability) {
  if (shift < 0.0) return -cut_quantile(-shift, 1.0 - probability);
  const double low = normal_probability(-kCut - shift), high = normal_probability(kCut - shift);
  const double inside = std::max(low + probability * (high - low), std::numeric_limits<double>::min());
  return std::clamp(normal_quantile(inside) + shift, -kCut, kCut);
}

}  // namespace

SourceLaw::SourceLaw(const Tolerances& tolerances, Source source)
    : tolerances_(&tolerances),
      source_(source),
      half_width_(tolerances[source]),
      std_(tolerances.std(source)),
      measured_(tolerances.measured[source]) {
  if (!measured_.empty()) {
    least_ = std::ranges::min(measured_);
    most_ = std::ranges::max(measured_);
  } else {
    most_ = tolerances.distribution == Distribution::normal ? std::numeric_limits<double>::infinity() : half_width_;
    least_ = -most_;
  }
}

double SourceLaw::largest_tilt() const {
  return std::isinf(most_) || !(std_ > 0.0) ? std::numeric_limits<double>::infinity() : kLargestTilt / std_;
}

double SourceLaw::measured_cumulant(double t) const {
  const double largest = t >= 0.0 ? t * most_ : t * least_;
  const double sum = std::accumulate(measured_.begin(), measured_.end(), 0.0,
                                     [&](double all, double value) { return all + std::exp(t * value - largest); });
  return largest + std::log(sum / static_cast<double>(measured_.size()));
}

double SourceLaw::cumulant(double t) const {
  if (!measured_.empty()) return measured_cumulant(t);
  const double sigma = half_width_ / 3.0;
  switch (tolerances_->distribution) {
    case Distribution::normal:
      return 0.5 * t * t * sigma * sigma;
    case Distribution::uniform:
      return log_sinh_over(t * half_width_);
    case Distribution::truncated_normal:
      return 0.5 * t * t * sigma * sigma + std::log(within_cut(std::abs(t * sigma)) / within_cut(0.0));
  }
  return 0.0;
}

double SourceLaw::mean(double t) const {
  if (!measured_.empty()) {
    const double normed = measured_cumulant(t), count = static_cast<double>(measured_.size());
    return std::accumulate(measured_.begin(), measured_.end(), 0.0, [&](double all, double value) {
      return all + value * std::exp(t * value - normed) / count;
    });
  }
  const double sigma = half_width_ / 3.0, shift = std::abs(t * sigma);
  switch (tolerances_->distribution) {
    case Distribution::normal:
      return t * sigma * sigma;
    case Distribution::uniform:
      return half_width_ * langevin(t * half_width_);
    case Distribution::truncated_normal:
      return std::copysign(sigma, t) *
             (shift + (normal_density(kCut + shift) - normal_density(kCut - shift)) / within_cut(shift));
  }
  return 0.0;
}

double SourceLaw::draw(double t, double standard_normal) const {
  if (t == 0.0) return source_error(*tolerances_, source_, standard_normal);
  const double probability = normal_probability(standard_normal);
  if (!measured_.empty()) {
    const double normed = measured_cumulant(t), count = static_cast<double>(measured_.size());
    double sum = 0.0;
    const auto found = std::ranges::find_if(
        measured_, [&](double value) { return (sum += std::exp(t * value - normed) / count) >= probability; });
    return found == measured_.end() ? measured_.back() : *found;
  }
  const double sigma = half_width_ / 3.0;
  switch (tolerances_->distribution) {
    case Distribution::normal:
      return sigma * (standard_normal + t * sigma);
    case Distribution::uniform:
      return half_width_ * exponential_quantile(t * half_width_, probability);
    case Distribution::truncated_normal:
      return sigma * cut_quantile(t * sigma, probability);
  }
  return 0.0;
}

}  // namespace paracal::detail
