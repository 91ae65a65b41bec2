#pragma once

// Private to io: the fields of proportions and failure rates.

#include "paracal/tolerance/failure.hpp"
#include "part_fields.hpp"

namespace paracal::io {

template <>
inline constexpr std::size_t kNames<FailureStatus> = 3;

template <>
struct List<Proportion> {
  static constexpr Place kPlace{kParts, "proportion", "Proportion",
                                "A fraction, or defects per million, with its interval."};
  static void fields(auto&& field) {
    using Of = Proportion;
    field("value", &Of::value, "estimate");
    field(
        "low", [](const Of& of) { return of.interval.low; }, "lower end of its interval");
    field(
        "high", [](const Of& of) { return of.interval.high; }, "upper end of its interval");
  }
};

template <>
struct List<WeighedShare> {
  static constexpr Place kPlace{kParts, "weighed_share", "Weighed share", "A failure rate from importance sampling."};
  static void fields(auto&& field) {
    using Of = WeighedShare;
    field("value", &Of::value, "failure rate, 0 to 1");
    field(
        "low", [](const Of& of) { return of.interval.low; }, "lower end of its interval");
    field(
        "high", [](const Of& of) { return of.interval.high; }, "upper end of its interval");
    field("machines", &Of::machines, "simulated machines", kNotNegative);
    field("effective", &Of::effective, "effective number of failures (equivalent number with equal weights)");
  }
};

template <>
struct List<FailureShare> {
  static constexpr Place kPlace{kParts, "failure", "Failure",
                                "Failure rate: fraction of the machines that break a limit."};
  static void fields(auto&& field) {
    using Of = FailureShare;
    field("status", &Of::status,
          "settled: the linear failure rate is known; impossible: no machine breaks a limit to first order; unsettled: "
          "the failure rate is not known well enough");
    field("reason", &Of::reason, "in words");
    field("linear", &Of::linear, "linear model");
    field("check", &Of::check, "second estimate with another sampling, to check the first");
    field("exact", &Of::exact, "exact model; null: not known");
    field("not_closed", &Of::not_closed, "machines that cannot reach every pose", kNotNegative);
  }
};

}  // namespace paracal::io
