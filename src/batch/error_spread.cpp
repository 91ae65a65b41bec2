#include "paracal/batch/error_spread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "batch_surrogate.hpp"
#include "numerics/distributions.hpp"

namespace paracal {
namespace {

constexpr std::size_t kFewest = 10;  // pairs that tell a stratum's ratios; with fewer it joins the one below

double first_order(const MachinePair& pair, Measure measure) {
  if (measure.used_up) return pair.first_order_used_up;
  return (measure.after ? pair.first_order_after : pair.first_order_before)[measure.kind];
}

double produced(const MachinePair& pair, Measure measure) {
  if (measure.used_up) return pair.used_up;
  return (measure.after ? pair.outcome.after : pair.outcome.before)[measure.kind];
}

const Histogram& first_order(const SurrogateTally& tally, Measure measure) {
  if (measure.used_up) return tally.used_up;
  return (measure.after ? tally.after : tally.before)[measure.kind];
}

/// A stratum before it is known whether its pairs are all of it.
struct Part {
  std::vector<Histogram::Bin> linear;
  std::uint64_t machines = 0;
  std::vector<const MachinePair*> pairs;

  void take(Part&& other) {
    linear.insert(linear.begin(), other.linear.begin(), other.linear.end());
    machines += other.machines;
    pairs.insert(pairs.end(), other.pairs.begin(), other.pairs.end());
  }
};

/// Strata from below, the pairs put where their linear values lie.
std::vector<Part> parts_of(const SurrogateTally& tally, Measure measure) {
  const Histogram& linear = first_order(tally, measure);
  std::array<std::uint32_t, kRanks.size()> ends{};
  std::ranges::transform(kRanks, ends.begin(), [&](double rank) { return Histogram::bin_of(linear.quantile(rank)); });
  const auto place = [&](std::uint32_t bin) {
    return static_cast<std::size_t>(std::ranges::lower_bound(ends, bin) - ends.begin());
  };
  std::vector<Part> parts(kRanks.size() + 1);
  for (const Histogram::Bin& bin : linear.counts()) {
    Part& part = parts[place(bin.number)];
    part.linear.push_back(bin);
    part.machines += bin.count;
  }
  for (const MachinePair& pair : tally.pairs) {
    parts[place(Histogram::bin_of(first_order(pair, measure)))].pairs.push_back(&pair);
  }
  return parts;
}

bool all_were_produced(const Part& part) { return part.pairs.size() == part.machines; }

/// Those with few pairs joined with the ones below, the lowest with the one above.
std::vector<Part> joined(std::vector<Part> parts) {
  const auto knows_little = [](const Part& part) { return part.pairs.size() < kFewest && !all_were_produced(part); };
  for (std::size_t k = parts.size(); k-- > 1;) {
    if (!knows_little(parts[k])) continue;
    parts[k - 1].take(std::move(parts[k]));
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(k));
  }
  while (parts.size() > 1 && knows_little(parts[0])) {
    parts[1].take(std::move(parts[0]));
    parts.erase(parts.begin());
  }
  return parts;
}

}  // namespace

ErrorSpread::ErrorSpread(const Tally& tally, Measure measure) : machines_(Histogram::kBins, 0.0) {
  if (!tally.surrogate) {
    for (const Histogram::Bin& bin : (measure.after ? tally.after : tally.before)[measure.kind].counts()) {
      machines_[bin.number] = static_cast<double>(bin.count);
    }
  } else {
    for (const Part& part : joined(parts_of(*tally.surrogate, measure))) {
      Stratum stratum{part.linear, static_cast<double>(part.machines), {}, {}};
      double sum = 0.0, closed = 0.0;
      for (const MachinePair* pair : part.pairs) {
        sum += 1.0 / pair->chance;
        if (pair->outcome.fate == Fate::does_not_close) continue;
        closed += 1.0 / pair->chance;
        if (all_were_produced(part)) {
          machines_[Histogram::bin_of(produced(*pair, measure))] += 1.0;
          continue;
        }
        const double linear = first_order(*pair, measure);
        stratum.ratios.push_back(linear > 0.0 ? produced(*pair, measure) / linear : 1.0);
        stratum.weights.push_back(1.0 / pair->chance);
      }
      if (all_were_produced(part) || closed == 0.0) continue;
      for (double& weight : stratum.weights) weight /= closed;
      stratum.machines *= closed / sum;  // the rest is scrap
      add(stratum);
      corrected_.push_back(std::move(stratum));
    }
  }
  total_ = std::accumulate(machines_.begin(), machines_.end(), 0.0);
}

void ErrorSpread::add(const Stratum& stratum) {
  const double all = std::accumulate(stratum.linear.begin(), stratum.linear.end(), 0.0,
                                     [](double sum, const auto& bin) { return sum + static_cast<double>(bin.count); });
  for (const Histogram::Bin& bin : stratum.linear) {
    const double share = static_cast<double>(bin.count) * stratum.machines / all;
    for (std::size_t k = 0; k < stratum.ratios.size(); ++k) {
      machines_[Histogram::bin_of(Histogram::value_of(bin.number) * stratum.ratios[k])] += share * stratum.weights[k];
    }
  }
}

Histogram ErrorSpread::counts() const {
  Histogram counts;
  for (std::uint32_t bin = 0; bin < Histogram::kBins; ++bin) {
    counts.add(bin, static_cast<std::uint64_t>(std::llround(machines_[bin])));
  }
  return counts;
}

double ErrorSpread::mean() const {
  double sum = 0.0;
  for (std::uint32_t bin = 0; bin < Histogram::kBins; ++bin) sum += machines_[bin] * Histogram::value_of(bin);
  return sum / total_;
}

double ErrorSpread::std() const {
  const double centre = mean();
  double sum = 0.0;
  for (std::uint32_t bin = 0; bin < Histogram::kBins; ++bin) {
    sum += machines_[bin] * std::pow(Histogram::value_of(bin) - centre, 2);
  }
  return std::sqrt(sum / total_);
}

/// The value that so many machines do not exceed.
double ErrorSpread::at_rank(double rank) const {
  double seen = 0.0;
  std::uint32_t last = 0;
  for (std::uint32_t bin = 0; bin < Histogram::kBins; ++bin) {
    if (machines_[bin] == 0.0) continue;
    last = bin;
    if ((seen += machines_[bin]) >= rank) break;
  }
  return Histogram::value_of(last);
}

double ErrorSpread::quantile(double share) const {
  if (total_ == 0.0) return std::numeric_limits<double>::quiet_NaN();
  const double rank = share * total_;
  return at_rank(corrected_.empty() ? std::max(std::ceil(rank), 1.0) : rank);  // counted: of whole machines
}

/// Of the share of machines up to a value.
double ErrorSpread::variance_within(double value) const {
  double within = 0.0;
  for (std::uint32_t bin = 0; bin <= Histogram::bin_of(value); ++bin) within += machines_[bin];
  const double share = std::min(within / total_, 1.0);
  double variance = share * (1.0 - share) / total_;
  for (const Stratum& stratum : corrected_) {
    std::vector<double> below(stratum.ratios.size());  // of the stratum's machines, were they all of this ratio
    for (std::size_t k = 0; k < below.size(); ++k) {
      double sum = 0.0, all = 0.0;
      for (const Histogram::Bin& bin : stratum.linear) {
        all += static_cast<double>(bin.count);
        if (Histogram::value_of(bin.number) * stratum.ratios[k] <= value) sum += static_cast<double>(bin.count);
      }
      below[k] = sum / all;
    }
    const double mean = std::inner_product(below.begin(), below.end(), stratum.weights.begin(), 0.0);
    double of_mean = 0.0;
    for (std::size_t k = 0; k < below.size(); ++k) of_mean += std::pow(stratum.weights[k] * (below[k] - mean), 2);
    variance += std::pow(stratum.machines / total_, 2) * of_mean;
  }
  return variance;
}

Interval ErrorSpread::quantile_interval(double share, double confidence) const {
  if (total_ == 0.0) return {quantile(share), quantile(share)};
  const double z = detail::two_sided_quantile(confidence);
  const double half = z * std::sqrt(variance_within(quantile(share)));
  return {quantile(std::max(share - half, 0.0)), quantile(std::min(share + half, 1.0))};
}

Proportion ErrorSpread::share_within(double value, double confidence) const {
  double within = 0.0;
  for (std::uint32_t bin = 0; bin < Histogram::bin_of(value); ++bin) within += machines_[bin];
  const double share = std::min(within / total_, 1.0), variance = variance_within(value);
  // The exact interval of as many counted machines as would have this variance; all of them where none is beyond.
  const double n = share > 0.0 && share < 1.0 && variance > 0.0 ? share * (1.0 - share) / variance : total_;
  const auto trials = std::max<std::int64_t>(std::llround(n), 1);
  const auto hits = static_cast<std::uint64_t>(std::llround(share * static_cast<double>(trials)));
  return {share, proportion_interval(hits, static_cast<std::uint64_t>(trials), confidence)};
}

}  // namespace paracal
