#include "failing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace paracal::app {
namespace {

/// The decimals of a percentage that show two digits of its distance from 100 %.
int decimals(double missing) {
  constexpr int kFewest = 3, kMost = 14;
  if (!(missing > 0.0)) return kFewest;
  return std::clamp(-static_cast<int>(std::floor(std::log10(100.0 * missing))) + 1, kFewest, kMost);
}

std::string share_text(const WeighedShare& share) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", share.value, share.interval.low, share.interval.high);
}

/// Which model and which simulated machines the yield comes from.
std::string source_text(const FailureShare& failures, const MonteCarlo& drawn) {
  const bool is_exact = drawn.model == Model::exact;
  switch (failures.status) {
    case FailureStatus::impossible:
      return fmt::format(
          "  counted: no failure in {} simulated machines; linear model: no machine within its tolerances can fail\n",
          drawn.machines);
    case FailureStatus::unsettled:
      return fmt::format("  counted: {} simulated machines, {} model{}; rarer failures not estimated: {}\n",
                         drawn.machines, is_exact ? "exact" : "linear", is_exact ? "" : " (try --model exact)",
                         failures.reason);
    case FailureStatus::settled:
      break;
  }
  const std::string linear =
      fmt::format("linear model: failure rate {}\n  (importance sampling, {} machines; second estimate {:.3g})",
                  share_text(failures.linear), failures.linear.machines, failures.check.value);
  if (is_counted(failures, drawn)) {
    return fmt::format("  counted: {} simulated machines, exact model; {}\n  no importance sampling: {}\n",
                       drawn.machines, linear, failures.reason);
  }
  if (!failures.exact) {
    return fmt::format("  {}\n  exact model not estimated ({}); use --model exact\n", linear, failures.reason);
  }
  return fmt::format("  exact model, {} simulated machines; {}\n", failures.exact->machines, linear);
}

}  // namespace

std::string yield_text(const FailureShare& failures, const MonteCarlo& drawn, double confidence) {
  const Proportion share = yield(failures, drawn, confidence), defects = defects_per_million(share);
  const double missing = is_counted(failures, drawn) ? 1.0 - share.value : failures.best().value;
  const int digits = decimals(missing);
  return fmt::format("yield {:.{}f} % [{:.{}f}, {:.{}f}]; defects per million {:.3g} [{:.3g}, {:.3g}]\n",
                     100.0 * share.value, digits, 100.0 * share.interval.low, digits, 100.0 * share.interval.high,
                     digits, defects.value, defects.interval.low, defects.interval.high) +
         source_text(failures, drawn);
}

std::string failure_line(const FailureShare& failures) {
  switch (failures.status) {
    case FailureStatus::impossible:
      return "  failure rate         0: no machine within its tolerances can fail (linear model)\n";
    case FailureStatus::unsettled:
      return fmt::format("  failure rate         not estimated: {}\n", failures.reason);
    case FailureStatus::settled:
      break;
  }
  return fmt::format("  failure rate         {}{}\n", share_text(failures.best()),
                     failures.exact ? "" : " (linear model)");
}

}  // namespace paracal::app
