#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/tolerance/statistics.hpp"

namespace paracal::report {

/// The rule for all published numbers. It depends on the kind of a number, not on its value.
///
///   tolerance = half a unit of the last printed digit            the print
///             + sqrt(n) times the error of one reading            n readings in the quantity, e.g. 2 for a difference
///             + from ours to the end of its 95 % interval         if ours is from a sample of simulated machines
///
/// A yes or no of one machine (position of its largest error) is reproduced if most similar machines agree, at 95 %
/// confidence. If at least 1 in 20 agrees, the result is `not_contradicted`.
///
/// A row is reproduced only if it could have failed: with another published number it would have.
enum class Finding : std::uint8_t {
  reproduced,        ///< within the tolerance; zero or the opposite sign would not be
  not_contradicted,  ///< likewise, but ours is made from the published number, or many machines would pass
  not_reproduced,    ///< difference above the tolerance
  cannot_be_tested,  ///< all others; the reason states why
};

/// The words of a finding, e.g. "not reproduced".
std::string_view name(Finding finding);

/// The rule in sentences, to be printed with the rows.
std::vector<std::string> rule_in_words();

/// Error of one reading of the published machine: 95 % of its positioning repeatability of +-0.05 mm (3 sigma), and
/// its rotational repeatability  [huang2016, section 5].
inline constexpr double kPositionReading = 0.03;  // mm
inline constexpr double kRotationReading = 0.3;   // deg
inline constexpr double kConfidence = 0.95;
inline constexpr double kRarest = 1.0 - kConfidence;

/// Rounding error of a number printed with this number of decimals: half a unit of the last. A count has 0.
double rounding(int decimals);

/// Error of a quantity from several readings with independent errors: the root of the sum of
/// squares.
double combined(double reading, int readings);

/// Central range of a sample that holds one more of its kind with 95 %: the order statistics r and n + 1 - r have (n +
/// 1
/// - 2 r) / (n + 1) between them, whatever the distribution  [wilks1941].
/// @throws InvalidArgument for fewer than 39 values, which are not sufficient.
Interval central_range(std::vector<double> sample);

/// 95 % interval of the median of a population, for any distribution: order statistics at binomial
/// ranks. The narrowest pair with at least 95 %, as central_range; throws below 6 values.
Interval median_interval(std::vector<double> sample);

double median(std::vector<double> sample);

struct Judgement {
  double tolerance = 0.0;
  Finding finding = Finding::cannot_be_tested;
  std::string reason;
};

/// Compares a number with ours: `allowed` is print and readings together, `sampling` the interval of ours (without a
/// sample: ours).
Judgement judge(double paper, double ours, double allowed, const Interval& sampling);
Judgement judge(double paper, double ours, double allowed);

/// Compares a published number with a lower bound: not reproduced, or cannot be tested.
Judgement judge_least(double paper, double least, double allowed);

/// For a number of ours that was made from the published one: it is never `reproduced`.
Judgement found_again(Judgement judgement);

/// Compares a yes of the published machine with the fraction of simulated machines that agree.
Judgement judge_share(const Proportion& share);

}  // namespace paracal::report
