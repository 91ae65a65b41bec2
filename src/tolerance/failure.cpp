#include "paracal/tolerance/failure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "limits.hpp"
#include "numerics/distributions.hpp"
#include "paracal/error.hpp"
#include "weighed_sample.hpp"

namespace paracal {
namespace {

using detail::FailureMode;
using detail::Limits;
using detail::WeighedSample;
using detail::Weights;

constexpr std::uint64_t kMostToCheck = 65536;
constexpr double kCheckError = 0.1;  // the second mixture need not know the share better
constexpr double kEnough = 100.0;    // effective failures: below, an estimate of the weights' own scatter is a guess
constexpr double kDisagrees = 1e-3;  // chance of two sound mixtures
constexpr double kFirstBand = 0.1, kWidestBand = 0.4;  // below a limit, as a share of it: what the exact model looks at
constexpr double kNoLongerCounts = 0.01;               // of the failures, what may come from the outer half of the band
/// Where the streams of both mixtures begin: beyond those of any batch.
constexpr std::uint64_t kMain = std::uint64_t{1} << 60, kCheck = std::uint64_t{2} << 60;

class Analysis {
 public:
  Analysis(const Limits& limits, const FailureOptions& options, const Progress& progress)
      : limits_(limits), options_(options), progress_(progress) {}

  FailureShare run() {
    const std::vector<FailureMode> modes = limits_.modes();
    if (modes.empty())
      return {.status = FailureStatus::impossible, .reason = "no machine within its tolerances breaks a limit"};
    // What is asked is shared by the two sampling errors of the exact share.
    const double part =
        options_.max_exact > 0 ? options_.relative_error / std::numbers::sqrt2 : options_.relative_error;
    WeighedSample main = sample(detail::likeliest_apart(modes, limits_.errors()), kMain);
    WeighedSample check = sample(detail::likeliest(modes), kCheck);
    if (!main.draw(part, options_.max_machines, progress_)) return stopped();
    if (!check.draw(std::max(kCheckError, part), std::min(kMostToCheck, options_.max_machines), progress_))
      return stopped();
    share_.linear = share_of(main);
    share_.check = share_of(check);
    judge(main.sums().linear_error(), check.sums().linear_error());
    if (share_.status == FailureStatus::settled && options_.max_exact > 0) correct(main, part);
    return share_;
  }

 private:
  WeighedSample sample(std::vector<FailureMode> modes, std::uint64_t first) const {
    return {limits_, detail::TiltedMixture(limits_.errors(), std::move(modes)), first, options_};
  }

  double half_widths() const { return detail::two_sided_quantile(options_.confidence); }

  /// value * exp(-+ z error), no share beyond 1.
  Interval around(double value, double error) const {
    const double factor = std::exp(half_widths() * error);
    return {value / factor, std::min(value * factor, 1.0)};
  }

  /// The error that around() was given.
  double error_of(const Interval& interval) const {
    return 0.5 * std::log(interval.high / interval.low) / half_widths();
  }

  WeighedShare share_of(const WeighedSample& sample) const {
    const Weights& sums = sample.sums();
    WeighedShare share{.machines = sums.machines};
    if (sums.failures == 0) return share;
    share.value = std::min(sums.linear / static_cast<double>(sums.machines), 1.0);
    share.effective = sums.linear * sums.linear / sums.linear_squares;
    share.interval = sample.is_plain() ? proportion_interval(sums.failures, sums.machines, options_.confidence)
                                       : around(share.value, sums.linear_error());
    return share;
  }

  void judge(double error, double check_error) {
    const double fewest = std::min(share_.linear.effective, share_.check.effective);
    if (fewest < kEnough) {
      share_.reason = fmt::format("only {:.0f} effective failures in {} machines", fewest, share_.linear.machines);
      return;
    }
    const double apart = std::abs(std::log(share_.linear.value / share_.check.value));
    if (apart > detail::two_sided_quantile(1.0 - kDisagrees) * std::hypot(error, check_error)) {
      share_.reason = fmt::format("two importance-sampling estimates disagree: {:.3g} and {:.3g}", share_.linear.value,
                                  share_.check.value);
      return;
    }
    share_.status = FailureStatus::settled;
  }

  void correct(WeighedSample& main, double part) {
    for (double band = kFirstBand; band <= kWidestBand; band *= 2.0) {
      const std::optional<Weights> tried = main.try_exactly(band, part, progress_);
      if (!tried) return;
      share_.not_closed = tried->not_closed;
      const double effective = tried->exact * tried->exact / tried->exact_squares;
      if (!(effective >= kEnough)) {
        share_.reason =
            fmt::format("only {:.0f} effective failures in the exact model", tried->exact > 0.0 ? effective : 0.0);
        return;
      }
      if (tried->outer > kNoLongerCounts * tried->exact) continue;
      const double value = std::min(share_.linear.value * tried->exact / tried->linear, 1.0);
      const double error = std::hypot(error_of(share_.linear.interval), tried->ratio_error());
      share_.exact = {value, around(value, error), tried->tried, effective};
      share_.reason.clear();
      return;
    }
    share_.reason = "the exact model differs too much from the linear model that importance sampling uses";
  }

  static FailureShare stopped() { return {.reason = "stopped"}; }

  const Limits& limits_;
  const FailureOptions& options_;
  const Progress& progress_;
  FailureShare share_;
};

}  // namespace

std::string_view name(FailureStatus status) {
  switch (status) {
    case FailureStatus::settled:
      return "settled";
    case FailureStatus::impossible:
      return "impossible";
    case FailureStatus::unsettled:
      return "unsettled";
  }
  return "";
}

bool is_counted(const FailureShare& failures, const MonteCarlo& drawn) {
  return failures.status != FailureStatus::settled || (!failures.exact && drawn.model == Model::exact);
}

Proportion yield(const FailureShare& failures, const MonteCarlo& drawn, double confidence) {
  if (is_counted(failures, drawn)) return drawn.yield(confidence);
  const WeighedShare& share = failures.best();
  return {1.0 - share.value, {1.0 - share.interval.high, 1.0 - share.interval.low}};
}

bool is_proven(const FailureShare& failures, const MonteCarlo& drawn) {
  return failures.exact || drawn.model == Model::exact || failures.status == FailureStatus::impossible;
}

FailureShare failure_share(const Robot& robot, const Tolerances& tolerances,
                           const std::vector<Requirement>& requirements, const std::vector<Pose>& poses,
                           const FailureOptions& options, const Progress& progress) {
  if (requirements.empty() || poses.empty()) throw InvalidArgument("failures: expected requirements and poses");
  if (!(options.relative_error > 0.0) || !(options.confidence > 0.0) || !(options.confidence < 1.0)) {
    throw InvalidArgument("failures: expected an error above 0 and a confidence between 0 and 1");
  }
  const Limits limits(robot, tolerances, requirements, poses);
  return Analysis(limits, options, progress).run();
}

}  // namespace paracal
