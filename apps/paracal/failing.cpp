#include "failing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace paracal::app {
namespace {

/// So many decimals of a percentage that two digits of what is missing to 100 % show.
int decimals(double missing) {
  constexpr int kFewest = 3, kMost = 14;
  if (!(missing > 0.0)) return kFewest;
  return std::clamp(-static_cast<int>(std::floor(std::log10(100.0 * missing))) + 1, kFewest, kMost);
}

std::string share_text(const WeighedShare& share) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", share.value, share.interval.low, share.interval.high);
}

/// How the yield is known.
std::string source_text(const FailureShare& failures, const MonteCarlo& drawn) {
  const bool is_exact = drawn.model == Model::exact;
  switch (failures.status) {
    case FailureStatus::impossible:
      return fmt::format(
          "  counted: {} machines, none of which fails; by the linear model no machine within its drawings does\n",
          drawn.machines);
    case FailureStatus::unsettled:
      return fmt::format("  counted among the {} machines drawn{}; rarer failures cannot be told: {}\n", drawn.machines,
                         is_exact ? "" : " by the linear model (--model exact draws others)", failures.reason);
    case FailureStatus::settled:
      break;
  }
  const std::string linear = fmt::format("{} machines drawn where limits break; drawn another way {:.3g}",
                                         failures.linear.machines, failures.check.value);
  if (is_counted(failures, drawn)) {
    return fmt::format(
        "  counted: {} machines of the exact model; the linear one has a share of {} fail\n  ({}), but {}\n",
        drawn.machines, share_text(failures.linear), linear, failures.reason);
  }
  if (!failures.exact) {
    return fmt::format(
        "  by the linear model ({}); by the exact one not known: {}\n  (--model exact counts its machines)\n", linear,
        failures.reason);
  }
  return fmt::format("  by the exact model, {} machines tried; the linear one has a share of {} fail\n  ({})\n",
                     failures.exact->machines, share_text(failures.linear), linear);
}

}  // namespace

std::string yield_text(const FailureShare& failures, const MonteCarlo& drawn, double confidence) {
  const Proportion share = yield(failures, drawn, confidence), defects = defects_per_million(share);
  const double missing = is_counted(failures, drawn) ? 1.0 - share.value : failures.best().value;
  const int digits = decimals(missing);
  return fmt::format("yield {:.{}f} % [{:.{}f}, {:.{}f}], {:.3g} defects per million [{:.3g}, {:.3g}]\n",
                     100.0 * share.value, digits, 100.0 * share.interval.low, digits, 100.0 * share.interval.high,
                     digits, defects.value, defects.interval.low, defects.interval.high) +
         source_text(failures, drawn);
}

std::string failure_line(const FailureShare& failures) {
  switch (failures.status) {
    case FailureStatus::impossible:
      return "  breaks a limit:       none within its drawings (linear model)\n";
    case FailureStatus::unsettled:
      return fmt::format("  breaks a limit:       cannot be told: {}\n", failures.reason);
    case FailureStatus::settled:
      break;
  }
  return fmt::format("  breaks a limit:       {} of the machines{}\n", share_text(failures.best()),
                     failures.exact ? "" : " by the linear model");
}

}  // namespace paracal::app
