#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/tolerance/statistics.hpp"

namespace paracal::report {

/// The one rule by which a published number counts as reproduced; it knows the kind of a number, never its value.
///
///   tolerance = half a unit of the last printed digit            the print
///             + sqrt(n) times what one reading may be off         n readings in the quantity, e.g. 2 for a difference
///             + from ours to the end of its 95 % interval         where ours comes from a sample of virtual machines
///
/// A yes or no of one machine (where its largest error stands) is reproduced when most machines like it say so, at 95 %
/// confidence. Where only 1 in 20 does, it is not contradicted.
///
/// A row counts as reproduced only where it could have failed: with another published number it would have.
enum class Finding : std::uint8_t {
  reproduced,        ///< within the tolerance, which a zero or the other sign would not be
  not_contradicted,  ///< likewise, but ours is made from the published number, or machines of many kinds would pass
  not_reproduced,    ///< off by more than the tolerance
  cannot_be_tested,  ///< anything else; the reason says what is missing
};

/// "reproduced", "not contradicted", "not reproduced", "cannot be tested".
std::string_view name(Finding finding);

/// What the rule says, a sentence each, for whoever prints rows.
std::vector<std::string> rule_in_words();

/// What one reading of the published machine may be off: 95 % of its positioning repeatability of +-0.05 mm, which are
/// 3 sigma, and its rotational repeatability  [huang2016, section 5].
inline constexpr double kPositionReading = 0.03;  // mm
inline constexpr double kRotationReading = 0.3;   // deg
inline constexpr double kConfidence = 0.95;
inline constexpr double kRarest = 1.0 - kConfidence;

/// Largest error of a number printed with so many decimals: half a unit of the last. A count has 0.
double rounding(int decimals);

/// What a quantity made of several readings may be off: their errors are independent, so the root of the sum of
/// squares.
double combined(double reading, int readings);

/// Central range of a sample that holds one more of its kind with 95 %: the order statistics r and n + 1 - r have (n +
/// 1
/// - 2 r) / (n + 1) between them, whatever the distribution  [wilks1941].
/// @throws InvalidArgument for fewer than 39 values, which cannot say so much.
Interval central_range(std::vector<double> sample);

/// 95 % interval of the median of what a sample comes from, whatever the distribution: order statistics at binomial
/// ranks. As central_range, at least 95 % and no narrower pair has that; throws likewise below 6 values.
Interval median_interval(std::vector<double> sample);

double median(std::vector<double> sample);

struct Judgement {
  double tolerance = 0.0;
  Finding finding = Finding::cannot_be_tested;
  std::string reason;
};

/// A number beside ours: `allowed` is print and readings together, `sampling` the interval of ours (ours alone without
/// a sample).
Judgement judge(double paper, double ours, double allowed, const Interval& sampling);
Judgement judge(double paper, double ours, double allowed);

/// A published number of which we know only that it cannot be below `least`: refuted or not, but never reproduced.
Judgement judge_least(double paper, double least, double allowed);

/// Of a number of ours that was made from the published one: it is found again or not, but never reproduced.
Judgement found_again(Judgement judgement);

/// A yes of the published machine beside the share of virtual machines that say so.
Judgement judge_share(const Proportion& share);

}  // namespace paracal::report
