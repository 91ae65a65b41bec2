#include "reproduction_rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
    throw InvalidArgument(
        fmt::format("order statistics at 95 %: expected at least {} values, got {}", least, sample.size()));
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
  const char* sign = paper * ours < 0.0 ? "opposite sign, " : "";
  return fmt::format("{}difference {:.3g}, allowed {:.3g}", sign, std::abs(ours - paper), tolerance);
}

}  // namespace

std::string_view name(Finding finding) {
  constexpr std::array<std::string_view, 4> kNames{"reproduced", "not contradicted", "not reproduced",
                                                   "cannot be tested"};
  return kNames.at(static_cast<std::size_t>(finding));
}

std::vector<std::string> rule_in_words() {
  return {
      fmt::format("tolerance: half a unit of the last printed digit + sqrt(n) x {} mm or {} deg for a quantity from n "
                  "readings of the published machine",
                  kPositionReading, kRotationReading),
      "results from twins (simulated copies of the machine) add their 95 % interval to the tolerance",
      "the published machine must lie within the central 95 % of its twins; a median has its 95 % interval",
      fmt::format("a yes or no of the published machine is reproduced if most twins agree (95 % confidence); "
                  "it is {} if at least 1 in 20 agrees",
                  name(Finding::not_contradicted)),
      fmt::format("a number recovered from twins that were made from it is {}: this test could not have failed",
                  name(Finding::not_contradicted)),
      "a row cannot be tested if zero or the opposite sign would also pass"};
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
    return {tolerance, Finding::cannot_be_tested, found + ": zero or the opposite sign would also pass"};
  }
  return {tolerance, Finding::reproduced, found};
}

Judgement judge(double paper, double ours, double allowed) { return judge(paper, ours, allowed, {ours, ours}); }

Judgement judge_least(double paper, double least, double allowed) {
  if (paper < least - allowed) return {allowed, Finding::not_reproduced, difference(paper, least, allowed)};
  return {allowed, Finding::cannot_be_tested, "only a lower bound is known; the number is above it"};
}

Judgement found_again(Judgement judgement) {
  if (judgement.finding != Finding::reproduced) return judgement;
  judgement.finding = Finding::not_contradicted;
  judgement.reason += ": ours was made from the published number, so this test could not have failed";
  return judgement;
}

Judgement judge_share(const Proportion& share) {
  const std::string found =
      fmt::format("fraction {:.2g} to {:.2g} of all machines (95 % interval)", share.interval.low, share.interval.high);
  constexpr double kMost = 0.5, kTolerance = 1.0 - kMost;
  if (share.interval.low > kMost) return {kTolerance, Finding::reproduced, found};
  if (share.interval.low >= kRarest) {
    return {kTolerance, Finding::not_contradicted, found + ": not proven for most machines"};
  }
  if (share.interval.high < kRarest) return {kTolerance, Finding::not_reproduced, found};
  return {kTolerance, Finding::cannot_be_tested, found + ": too few twins"};
}

}  // namespace paracal::report
