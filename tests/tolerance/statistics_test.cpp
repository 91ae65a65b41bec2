#include "paracal/tolerance/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "paracal/mechanism/random.hpp"

namespace paracal::statistics_test {
namespace {

/// 0 of 20, 5 of 20: limits of the 95 % interval as tables print them.
TEST(ProportionInterval, IsClopperAndPearson) {
  EXPECT_NEAR(proportion_interval(0, 20, 0.95).high, 1.0 - std::pow(0.025, 1.0 / 20.0), 1e-12);
  const Interval quarter = proportion_interval(5, 20, 0.95);
  EXPECT_NEAR(quarter.low, 0.0866, 1e-4);
  EXPECT_NEAR(quarter.high, 0.4910, 1e-4);
  EXPECT_EQ(proportion_interval(20, 20, 0.95).high, 1.0);
  EXPECT_EQ(proportion_interval(0, 0, 0.95).high, 1.0);
}

TEST(Histogram, KnowsQuantilesMeanAndSpread) {
  Histogram histogram;
  for (int k = 1; k <= 10000; ++k) histogram.add(k * 1e-4);
  EXPECT_EQ(histogram.total(), 10000U);
  for (const double share : {0.01, 0.5, 0.95, 1.0}) {
    EXPECT_NEAR(histogram.quantile(share) / share, 1.0, 0.002) << share;
  }
  EXPECT_NEAR(histogram.mean(), 0.50005, 1e-4);
  EXPECT_NEAR(histogram.std(), std::sqrt(1.0 / 12.0), 1e-4);
}

TEST(Histogram, PartsAddUpToTheWhole) {
  Histogram whole, one, other;
  RandomStream random(3);
  for (int k = 0; k < 1000; ++k) {
    const double value = std::exp(3.0 * random.normal());
    whole.add(value);
    (k % 3 == 0 ? one : other).add(value);
  }
  Histogram copied;
  for (const auto& [bin, count] : one.counts()) copied.add(bin, count);
  other.add(copied);
  EXPECT_EQ(other.counts(), whole.counts());
}

TEST(Histogram, TakesExtremes) {
  Histogram histogram;
  for (const double value : {0.0, 1e-300, 1e300, 1.0}) histogram.add(value);
  EXPECT_EQ(histogram.total(), 4U);
  EXPECT_NEAR(histogram.quantile(0.75), 1.0, 0.002);
  EXPECT_TRUE(std::isnan(Histogram().quantile(0.5)));
}

/// The interval of the median of 400 machines holds the true median in about 95 % of 500 such batches.
TEST(Histogram, QuantileIntervalCovers) {
  int covered = 0;
  constexpr int kBatches = 500;
  for (int batch = 0; batch < kBatches; ++batch) {
    Histogram histogram;
    RandomStream random(4, static_cast<std::uint64_t>(batch));
    for (int k = 0; k < 400; ++k) histogram.add(std::abs(random.normal()));
    const Interval interval = histogram.quantile_interval(0.5, 0.95);
    covered += Interval{0.998 * interval.low, 1.002 * interval.high}.contains(0.67449) ? 1 : 0;
  }
  EXPECT_GE(covered, kBatches * 92 / 100);
  EXPECT_LT(covered, kBatches);
}

}  // namespace
}  // namespace paracal::statistics_test
