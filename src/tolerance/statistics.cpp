#include "paracal/tolerance/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/distributions.hpp"

namespace paracal {
namespace {

constexpr int kBinsAnOctave = 256;
constexpr int kLowestExponent = -40;  // of frexp: the first bin begins at 2^-41

}  // namespace

Interval proportion_interval(std::uint64_t hits, std::uint64_t trials, double confidence) {
  if (trials == 0) return {0.0, 1.0};
  const auto [low, high] =
      detail::probability_bounds(static_cast<double>(hits), static_cast<double>(trials), 0.5 * (1.0 - confidence));
  return {low, high};
}

Proportion proportion(std::uint64_t hits, std::uint64_t trials, double confidence) {
  return {static_cast<double>(hits) / static_cast<double>(trials), proportion_interval(hits, trials, confidence)};
}

Proportion defects_per_million(const Proportion& yield) {
  constexpr double kMillion = 1e6;
  return {kMillion * (1.0 - yield.value),
          {kMillion * (1.0 - yield.interval.high), kMillion * (1.0 - yield.interval.low)}};
}

std::uint32_t Histogram::bin_of(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);  // in [0.5, 1)
  if (!(value > 0.0) || exponent < kLowestExponent) return 0;
  const auto within = static_cast<std::uint32_t>((2.0 * mantissa - 1.0) * kBinsAnOctave);
  const auto octave = static_cast<std::uint32_t>(exponent - kLowestExponent);
  return std::min(octave * kBinsAnOctave + within, kBins - 1);
}

void Histogram::add(double value) { add(bin_of(value), 1); }

void Histogram::add(const Histogram& other) {
  for (std::uint32_t bin = 0; bin < kBins; ++bin) counts_[bin] += other.counts_[bin];
  total_ += other.total_;
}

void Histogram::add(std::uint32_t bin, std::uint64_t count) {
  counts_.at(bin) += count;
  total_ += count;
}

double Histogram::mean() const {
  double sum = 0.0;
  for (const Bin& bin : counts()) sum += static_cast<double>(bin.count) * value_of(bin.number);
  return sum / static_cast<double>(total_);
}

double Histogram::std() const {
  const double centre = mean();
  double sum = 0.0;
  for (const Bin& bin : counts()) sum += static_cast<double>(bin.count) * std::pow(value_of(bin.number) - centre, 2);
  return std::sqrt(sum / static_cast<double>(total_));
}

double Histogram::ranked(std::uint64_t rank) const {
  std::uint64_t seen = 0;
  for (std::uint32_t bin = 0; bin < kBins; ++bin) {
    seen += counts_[bin];
    if (seen >= rank) return value_of(bin);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double Histogram::quantile(double share) const {
  if (total_ == 0) return std::numeric_limits<double>::quiet_NaN();
  const double rank = std::ceil(share * static_cast<double>(total_));
  return ranked(std::clamp<std::uint64_t>(static_cast<std::uint64_t>(rank), 1, total_));
}

Interval Histogram::quantile_interval(double share, double confidence) const {
  if (total_ == 0) return {quantile(share), quantile(share)};
  const auto n = static_cast<double>(total_);
  const double half_width = detail::two_sided_quantile(confidence) * std::sqrt(share * (1.0 - share) / n);
  return {quantile(std::max(share - half_width, 0.0)), quantile(std::min(share + half_width, 1.0))};
}

std::vector<Histogram::Bin> Histogram::counts() const {
  std::vector<Bin> bins;
  for (std::uint32_t bin = 0; bin < kBins; ++bin) {
    if (counts_[bin] > 0) bins.push_back({bin, counts_[bin]});
  }
  return bins;
}

double Histogram::begin_of(std::uint32_t bin) {
  const double within = static_cast<double>(bin % kBinsAnOctave) / kBinsAnOctave;
  return std::ldexp(0.5 * (1.0 + within), static_cast<int>(bin / kBinsAnOctave) + kLowestExponent);
}

double Histogram::value_of(std::uint32_t bin) { return 0.5 * (begin_of(bin) + begin_of(bin + 1)); }

}  // namespace paracal
