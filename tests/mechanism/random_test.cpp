#include "paracal/mechanism/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/robots.hpp"

#include "paracal/mechanism/catalogue.hpp"

namespace paracal::random_test {
namespace {

TEST(RandomStream, IsPhilox4x32AtTheKnownAnswer) {
  // Known-answer test of the generator's authors: counter 0, key 0 gives 6627e8d5 e169c58d bc57ac4c 9b00dbd8.
  RandomStream random(0, 0);
  const std::uint64_t first = 0x6627e8d5e169c58dULL >> 11, second = 0xbc57ac4c9b00dbd8ULL >> 11;
  EXPECT_EQ(random.uniform(), (static_cast<double>(first) + 0.5) * 0x1p-53);
  EXPECT_EQ(random.uniform(), (static_cast<double>(second) + 0.5) * 0x1p-53);
}

TEST(RandomStream, StreamsDoNotDependOnEachOther) {
  RandomStream one(7, 17), same(7, 17), other(7, 18), seed(8, 17);
  const double drawn = one.normal();
  EXPECT_EQ(drawn, same.normal());
  EXPECT_NE(drawn, other.normal());
  EXPECT_NE(drawn, seed.normal());
}

TEST(RandomStream, NormalHasItsMoments) {
  RandomStream random(1);
  constexpr int kDraws = 200000;
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    const double z = random.normal();
    sum += z;
    squares += z * z;
    fourth += z * z * z * z;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 4.0 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0, 4.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(fourth / kDraws, 3.0, 4.0 * std::sqrt(96.0 / kDraws));
}

/// Standard deviation of what is drawn, against what Tolerances states for it.
TEST(DrawErrors, SpreadAsTheTolerancesSay) {
  for (const Distribution distribution :
       {Distribution::normal, Distribution::uniform, Distribution::truncated_normal}) {
    const Robot robot = catalogue::rotary_delta();
    Tolerances tolerances;
    tolerances["e_x"] = 3.0;
    tolerances.distribution = distribution;
    RandomStream random(3);
    constexpr int kMachines = 20000;
    double squares = 0.0, largest = 0.0;
    for (int k = 0; k < kMachines; ++k) {
      const double e = draw_errors(robot, tolerances, random)(1, "e_x");
      squares += e * e / kMachines;
      largest = std::max(largest, std::abs(e));
    }
    EXPECT_NEAR(std::sqrt(squares) / tolerances.std("e_x"), 1.0, 0.02);
    EXPECT_EQ(largest <= 3.0, distribution != Distribution::normal);
  }
}

TEST(DrawErrors, MeasuredPartsReplaceTheDistribution) {
  const Robot robot = catalogue::rotary_delta();
  Tolerances tolerances;
  tolerances["rod_mean"] = 1.0;
  tolerances.measured["rod_mean"] = {0.2, 0.3, 0.7};
  EXPECT_NEAR(tolerances.mean("rod_mean"), 0.4, 1e-15);
  EXPECT_NEAR(tolerances.std("rod_mean"), std::sqrt((0.04 + 0.01 + 0.09) / 3.0), 1e-15);
  EXPECT_EQ(tolerances.largest("rod_mean"), 1.0);
  RandomStream random(5);
  constexpr int kMachines = 30000;
  double sum = 0.0;
  for (int k = 0; k < kMachines; ++k) sum += draw_errors(robot, tolerances, random)(0, "rod_mean");
  EXPECT_NEAR(sum / kMachines, 0.4, 4.0 * tolerances.std("rod_mean") / std::sqrt(kMachines));
}

/// What lets a batch draw only the sources that it needs.
TEST(DrawErrors, EveryErrorIsANumberOfItsStream) {
  Tolerances tolerances;
  tolerances.half_width.values.fill(3.0);
  const Robot robot = catalogue::huang2016();
  RandomStream random(11, 42);
  const SourceErrors errors = draw_errors(robot, tolerances, random);
  for (std::size_t k = 0; k < robot.parameters().size(); ++k) {
    const Parameter& one = robot.parameters()[k];
    EXPECT_DOUBLE_EQ(errors(one.limb, one.source), normal_pair(11, 42, k / 2)[k % 2]);
    EXPECT_DOUBLE_EQ(errors(one.limb, one.source), RandomStream(11, 42).normal_at(one.number));
  }
}

TEST(DrawErrors, ExactSourcesStayZero) {
  RandomStream random(3);
  EXPECT_EQ(draw_errors(catalogue::huang2016(), {}, random)(2, "beta2"), 0.0);
}

}  // namespace
}  // namespace paracal::random_test
