#include "paracal/report/reproduction_rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "numerics/distributions.hpp"
#include "paracal/error.hpp"

namespace paracal::report {
namespace {

/// Values number `rank` from below and from above, counted from 1.
Interval ranked(std::vector<double> sample, std::size_t rank) {
  std::ranges::sort(sample);
  return {sample[rank - 1], sample[sample.size() - rank]};
}

void require(const std::vector<double>& sample, std::size_t least) {
  if (sample.size() < least) {
    throw InvalidArgument(fmt::format("95 % by order statistics needs {} values, got {}", least, sample.size()));
  }
}

/// How far ours may be off on the side where the published number stands.
double towards(double paper, double ours, const Interval& sampling) {
  return paper > ours ? sampling.high - ours : ours - sampling.low;
}

/// Whether nothing at all, or the other sign, would pass as well as the published number does.
bool tells_nothing(double allowed, const Interval& sampling) {
  return sampling.low - allowed <= 0.0 && 0.0 <= sampling.high + allowed;
}

std::string difference(double paper, double ours, double tolerance) {
  const char* sign = paper * ours < 0.0 ? "other sign, " : "";
  return fmt::format("{}off by {:.3g}, allowed {:.3g}", sign, std::abs(ours - paper), tolerance);
}

}  // namespace

std::string_view name(Finding finding) {
  switch (finding) {
    case Finding::reproduced:
      return "reproduced";
    case Finding::not_contradicted:
      return "not contradicted";
    case Finding::not_reproduced:
      return "not reproduced";
    case Finding::cannot_be_tested:
      break;
  }
  return "cannot be tested";
}

std::vector<std::string> rule_in_words() {
  return {
      fmt::format("tolerance = half a unit of the last printed digit + sqrt(n) x {} mm or {} deg, where n readings "
                  "of the published machine make the quantity + the 95 % interval of ours, where it comes from "
                  "virtual twins",
                  kPositionReading, kRotationReading),
      "a published machine beside its twins lies within the central 95 % of them; a median has its 95 % interval",
      std::string("a yes or no of the published machine is reproduced when most twins say so, at 95 % confidence; ") +
          "it is not contradicted when at least 1 in 20 does",
      "a number that comes out again of twins made from it is not contradicted: it could not have failed",
      "a row that a zero or the other sign would pass as well cannot be tested"};
}

double rounding(int decimals) { return 0.5 * std::pow(10.0, -decimals); }

double combined(double reading, int readings) { return reading * std::sqrt(static_cast<double>(readings)); }

Interval central_range(std::vector<double> sample) {
  constexpr double kTail = 0.5 * kRarest, kRounding = 1e-9;
  require(sample, 39);
  const auto rank = static_cast<std::size_t>(kTail * static_cast<double>(sample.size() + 1) + kRounding);
  return ranked(std::move(sample), rank);
}

Interval median_interval(std::vector<double> sample) {
  require(sample, 6);
  const auto count = static_cast<double>(sample.size());
  std::size_t rank = 1;
  while (paracal::detail::binomial_cdf(static_cast<double>(rank), count, 0.5) <= 0.5 * kRarest) ++rank;
  return ranked(std::move(sample), rank);
}

double median(std::vector<double> sample) {
  require(sample, 1);
  const Interval middle = ranked(sample, (sample.size() + 1) / 2);
  return 0.5 * (middle.low + middle.high);
}

Judgement judge(double paper, double ours, double allowed, const Interval& sampling) {
  const double tolerance = allowed + towards(paper, ours, sampling);
  const std::string found = difference(paper, ours, tolerance);
  if (std::abs(ours - paper) > tolerance) return {tolerance, Finding::not_reproduced, found};
  if (tells_nothing(allowed, sampling)) {
    return {tolerance, Finding::cannot_be_tested, found + ": a zero or the other sign would pass as well"};
  }
  return {tolerance, Finding::reproduced, found};
}

Judgement judge(double paper, double ours, double allowed) { return judge(paper, ours, allowed, {ours, ours}); }

Judgement judge_least(double paper, double least, double allowed) {
  if (paper < least - allowed) return {allowed, Finding::not_reproduced, difference(paper, least, allowed)};
  return {allowed, Finding::cannot_be_tested, "only the least value is known, which it keeps"};
}

Judgement found_again(Judgement judgement) {
  if (judgement.finding != Finding::reproduced) return judgement;
  judgement.finding = Finding::not_contradicted;
  judgement.reason += ": ours is made from the published number, so it could not have failed";
  return judgement;
}

Judgement judge_share(const Proportion& share) {
  const std::string found =
      fmt::format("{:.2g} to {:.2g} of all machines (95 %)", share.interval.low, share.interval.high);
  constexpr double kMost = 0.5, kTolerance = 1.0 - kMost;
  if (share.interval.low > kMost) return {kTolerance, Finding::reproduced, found};
  if (share.interval.low >= kRarest) {
    return {kTolerance, Finding::not_contradicted, found + ": not most of them"};
  }
  if (share.interval.high < kRarest) return {kTolerance, Finding::not_reproduced, found};
  return {kTolerance, Finding::cannot_be_tested, found + ": too few twins"};
}

}  // namespace paracal::report
