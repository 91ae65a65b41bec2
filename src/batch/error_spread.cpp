#include "paracal/batch/error_spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "numerics/distributions.hpp"

namespace paracal {
namespace {

std::uint32_t bin_in(const ErrorBins& bins, Measure measure) {
  return measure.used_up ? bins.used_up : (measure.after ? bins.after : bins.before)[measure.kind];
}

template <typename Machines>
const Histogram& histogram_of(const Machines& machines, Measure measure) {
  return (measure.after ? machines.after : machines.before)[measure.kind];
}

}  // namespace

ErrorSpread::ErrorSpread(const Tally& tally, Measure measure)
    : n_(static_cast<double>(tally.produced())),
      closed_(n_ - (measure.used_up ? 0.0 : static_cast<double>(tally.of(Fate::does_not_close)))) {
  std::vector<Histogram::Bin> linear;
  if (tally.first_order) {
    linear = (measure.used_up ? tally.first_order->used_up : histogram_of(*tally.first_order, measure)).counts();
  } else if (!measure.used_up) {
    for (const auto& [bin, count] : histogram_of(tally, measure).counts()) {
      known_.push_back({.exact = bin, .machines = static_cast<double>(count)});
    }
    if (n_ > closed_) known_.push_back({.machines = n_ - closed_, .closes = false});
  }
  for (const MachinePair& pair : tally.pairs) {
    Known known{.linear = bin_in(pair.first_order, measure), .exact = bin_in(pair.exact, measure)};
    if (pair.fate == Fate::does_not_close) {
      known.closes = measure.used_up;
      known.exact = Histogram::kBins;  // beyond any limit
    }
    known_.push_back(known);
    if (known.closes) shifts_.push_back(known.exact - known.linear);
    const auto same =
        std::ranges::lower_bound(linear, static_cast<std::uint32_t>(known.linear), {}, &Histogram::Bin::number);
    if (same != linear.end() && same->number == known.linear && same->count > 0) --same->count;
  }
  std::ranges::copy_if(linear, std::back_inserter(others_), [](const Histogram::Bin& bin) { return bin.count > 0; });
  predict_from_shifts();
  lowest_ = Histogram::kBins;
  highest_ = 0;
  for (const Known& known : known_) {
    if (!known.closes) continue;
    lowest_ = std::min(lowest_, known.exact);
    highest_ = std::max(highest_, known.exact);
  }
  for (const auto& [bin, count] : others_) {
    rest_ += static_cast<double>(count);
    if (shifts_.empty()) continue;
    lowest_ = std::clamp(bin + shifts_.front(), std::int64_t{0}, lowest_);
    highest_ = std::clamp(bin + shifts_.back(), highest_, std::int64_t{Histogram::kBins});
  }
}

void ErrorSpread::predict_from_shifts() {
  if (shifts_.empty()) return;
  std::ranges::sort(shifts_);
  for (std::int64_t shift = shifts_.front(); shift < shifts_.back(); ++shift) {
    const auto beyond = shifts_.end() - std::ranges::upper_bound(shifts_, shift);
    larger_shifts_.push_back(static_cast<double>(beyond) / static_cast<double>(shifts_.size()));
  }
}

/// Of a machine's error beyond a bin, by its first order.
double ErrorSpread::predicted(std::int64_t linear, std::int64_t bin) const {
  const std::int64_t place = bin - linear - shifts_.front();
  if (place < 0) return 1.0;
  return place < std::ssize(larger_shifts_) ? larger_shifts_[static_cast<std::size_t>(place)] : 0.0;
}

ErrorSpread::Beyond ErrorSpread::beyond(std::int64_t bin) const {
  const double lambda = shifts_.empty() ? 0.0 : rest_ / (n_ + rest_), closing = closed_ / n_;
  double of_rest = 0.0, squares_of_rest = 0.0;
  for (const auto& [linear, count] : others_) {
    const double p = lambda == 0.0 ? 0.0 : predicted(linear, bin);
    of_rest += static_cast<double>(count) * p;
    squares_of_rest += static_cast<double>(count) * p * p;
  }
  const auto is_beyond = [&](const Known& one) { return one.closes && one.exact > bin ? 1.0 : 0.0; };
  const auto predicted_of = [&](const Known& one) { return lambda == 0.0 ? 0.0 : predicted(one.linear, bin); };
  double of_known = 0.0;
  for (const Known& one : known_) of_known += one.machines * (is_beyond(one) - lambda * predicted_of(one));
  const double mean_of_rest = rest_ > 0.0 ? of_rest / rest_ : 0.0, mean_of_known = of_known / n_;
  const double value = (mean_of_known + lambda * mean_of_rest) / closing;
  double squares = 0.0;  // the ratio linearised: what a machine does to the numerator, less Q times whether it closes
  for (const Known& one : known_) {
    const double off =
        is_beyond(one) - lambda * predicted_of(one) - mean_of_known - value * ((one.closes ? 1.0 : 0.0) - closing);
    squares += one.machines * off * off;
  }
  double variance = squares / (n_ * n_);
  if (rest_ > 0.0) variance += lambda * lambda * (squares_of_rest / rest_ - mean_of_rest * mean_of_rest) / rest_;
  return {std::clamp(value, 0.0, 1.0), std::max(variance, 0.0) / (closing * closing)};
}

double ErrorSpread::half_width(const Beyond& at, double z) const {
  const double unseen = 0.5 * z * z / n_;
  return unseen + std::sqrt(unseen * unseen + z * z * at.variance);
}

/// The first bin where it holds, of those from below the lowest to the highest, and the next one where it holds
/// nowhere. What holds at a bin holds above.
template <typename Condition>
std::int64_t ErrorSpread::first_bin(const Condition& condition) const {
  std::int64_t low = lowest_ - 1, high = highest_ + 1;
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (condition(beyond(middle))) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

double ErrorSpread::quantile(double share) const {
  if (closed_ == 0.0) return std::numeric_limits<double>::quiet_NaN();
  constexpr double kRounding = 1e-12;
  const std::int64_t bin = first_bin([&](const Beyond& at) { return at.value <= 1.0 - share + kRounding; });
  return Histogram::value_of(static_cast<std::uint32_t>(
      std::clamp(bin, std::max(lowest_, std::int64_t{0}), std::min(highest_, std::int64_t{Histogram::kBins} - 1))));
}

Interval ErrorSpread::quantile_interval(double share, double confidence) const {
  if (closed_ == 0.0) return {quantile(share), quantile(share)};
  const double z = detail::two_sided_quantile(confidence);
  const auto low = first_bin([&](const Beyond& at) { return at.value - half_width(at, z) <= 1.0 - share; });
  const auto high = first_bin([&](const Beyond& at) { return at.value + half_width(at, z) <= 1.0 - share; });
  // As wide as the bins at its ends: no percentile is known better.
  return {low < lowest_ ? 0.0 : Histogram::begin_of(static_cast<std::uint32_t>(low)),
          high > highest_ || high >= Histogram::kBins ? std::numeric_limits<double>::infinity()
                                                      : Histogram::begin_of(static_cast<std::uint32_t>(high + 1))};
}

Proportion ErrorSpread::share_within(double value, double confidence) const {
  const Beyond at = beyond(std::int64_t{Histogram::bin_of(value)} - 1);
  const double half = half_width(at, detail::two_sided_quantile(confidence)), within = 1.0 - at.value;
  return {within, {std::max(within - half, 0.0), std::min(within + half, 1.0)}};
}

/// From the lowest bin on; as the estimated probabilities may rise by chance, by the least so far.
std::vector<double> ErrorSpread::machines_by_bin() const {
  std::vector<double> machines(Histogram::kBins, 0.0);
  if (closed_ == 0.0) return machines;
  const double all = (n_ + rest_) * closed_ / n_;
  double least = 1.0;
  for (std::int64_t bin = lowest_; bin <= highest_; ++bin) {
    const double beyond_here = bin == highest_ ? 0.0 : std::min(beyond(bin).value, least);
    machines[static_cast<std::size_t>(std::min(bin, std::int64_t{Histogram::kBins} - 1))] +=
        all * (least - beyond_here);
    least = beyond_here;
  }
  return machines;
}

Histogram ErrorSpread::counts() const {
  const std::vector<double> machines = machines_by_bin();
  Histogram counts;
  for (std::uint32_t bin = 0; bin < Histogram::kBins; ++bin) {
    counts.add(bin, static_cast<std::uint64_t>(std::llround(machines[bin])));
  }
  return counts;
}

ErrorSpread::Moments ErrorSpread::moments() const {
  const std::vector<double> machines = machines_by_bin();
  const double all = std::accumulate(machines.begin(), machines.end(), 0.0);
  double mean = 0.0, variance = 0.0;
  for (std::uint32_t bin = 0; bin < Histogram::kBins; ++bin) mean += machines[bin] / all * Histogram::value_of(bin);
  for (std::uint32_t bin = 0; bin < Histogram::kBins; ++bin) {
    variance += machines[bin] / all * std::pow(Histogram::value_of(bin) - mean, 2);
  }
  return {mean, std::sqrt(variance)};
}

}  // namespace paracal
