// The grades of ISO 286-1: the table against the standard's own formulae, its scaling and its ranges.

#include "paracal/tolerance/standard_grade.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <string>

namespace paracal::standard_grade_test {
namespace {

constexpr std::array<double, 22> kEnds{0,   3,   6,   10,  18,  30,   50,   80,   120,  180,  250,
                                       315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150};

StandardGrade grade(int number) { return static_cast<StandardGrade>(number + 1); }

double micrometres(StandardGrade grade, double size) { return 1e3 * standard_tolerance(grade, size).value(); }

/// Geometric mean of a range; the first one counts from 1 mm.
double mean_of(std::size_t range) { return std::sqrt(std::max(kEnds[range], 1.0) * kEnds[range + 1]); }

/// What the standard computes from: i = 0.45 D^(1/3) + 0.001 D up to 500 mm, I = 0.004 D + 2.1 above, micrometres.
double factor_of(double D) { return D <= 500.0 ? 0.45 * std::cbrt(D) + 0.001 * D : 0.004 * D + 2.1; }

TEST(StandardGrade, TheTableIsWhatTheFormulaGivesBeforeItsRounding) {
  constexpr std::array kMultiples{7, 10, 16, 25, 40, 64, 100, 160, 250, 400, 640, 1000, 1600, 2500};  // IT5 ... IT18
  for (std::size_t range = 0; range + 1 < kEnds.size(); ++range) {
    const double share = kEnds[range + 1] <= 6.0 ? 0.155 : 0.06;  // small sizes were rounded up to scale better
    for (std::size_t k = 0; k < kMultiples.size(); ++k) {
      const StandardGrade it = grade(5 + static_cast<int>(k));
      const double computed = kMultiples[k] * factor_of(mean_of(range));
      EXPECT_NEAR(micrometres(it, kEnds[range + 1]) / computed, 1.0, share) << name(it) << " " << kEnds[range + 1];
    }
  }
}

TEST(StandardGrade, TheFinestFollowTheirOwnFormulae) {
  for (std::size_t range = 0; range < 13; ++range) {
    const double D = mean_of(range), size = kEnds[range + 1];
    EXPECT_NEAR(micrometres(StandardGrade::IT01, size), 0.3 + 0.008 * D, 0.3) << size;
    EXPECT_NEAR(micrometres(StandardGrade::IT0, size), 0.5 + 0.012 * D, 0.6) << size;
    EXPECT_NEAR(micrometres(StandardGrade::IT1, size), 0.8 + 0.020 * D, 1.9) << size;
  }
  constexpr std::array kMultiples{2.0, 2.7, 3.7, 5.0};  // of I, IT1 ... IT4
  for (std::size_t range = 13; range + 1 < kEnds.size(); ++range) {
    for (int k = 0; k < 4; ++k) {
      const double computed = kMultiples[static_cast<std::size_t>(k)] * factor_of(mean_of(range));
      EXPECT_NEAR(micrometres(grade(1 + k), kEnds[range + 1]) / computed, 1.0, 0.065) << k << " " << kEnds[range + 1];
    }
  }
}

/// IT2 to IT4 up to 500 mm have no formula: they lie about evenly in the ratio of IT1 to IT5.
TEST(StandardGrade, BetweenIT1AndIT5TheySpreadInGeometricProgression) {
  for (std::size_t range = 0; range < 13; ++range) {
    const double size = kEnds[range + 1], first = micrometres(StandardGrade::IT1, size);
    const double ratio = std::pow(micrometres(StandardGrade::IT5, size) / first, 0.25);
    for (int k = 2; k <= 4; ++k) {
      EXPECT_NEAR(micrometres(grade(k), size) / (first * std::pow(ratio, k - 1)), 1.0, 0.2) << k << " " << size;
    }
  }
}

TEST(StandardGrade, FromIT6EveryFifthIsTenTimesAsWide) {
  for (std::size_t range = 0; range + 1 < kEnds.size(); ++range) {
    const double size = kEnds[range + 1];
    for (int number = 6; number + 5 <= 18; ++number) {
      if (number == 6 && size == 6.0) continue;  // 8 and 75: the one exception of the standard's table
      EXPECT_DOUBLE_EQ(micrometres(grade(number + 5), size), 10.0 * micrometres(grade(number), size)) << size;
    }
  }
}

TEST(StandardGrade, CoarserGradesAndLargerSizesAreWider) {
  for (std::size_t range = 0; range + 1 < kEnds.size(); ++range) {
    for (int number = 1; number < 18; ++number) {
      const double size = kEnds[range + 1], width = micrometres(grade(number), size);
      EXPECT_GT(micrometres(grade(number + 1), size), width) << name(grade(number)) << " " << size;
      const double of_smaller = range > 0 ? micrometres(grade(number), kEnds[range]) : 0.0;
      EXPECT_GE(width, of_smaller) << name(grade(number)) << " " << size;
    }
  }
}

TEST(StandardGrade, ASizeIsOfTheRangeThatItEnds) {
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT8, 18.0), 27.0);
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT8, std::nextafter(18.0, 19.0)), 33.0);
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT8, 10.0), 22.0);
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT8, 375.0), 89.0);
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT7, 950.0), 90.0);
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT5, 100.0), 15.0);
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT12, 500.0), 630.0);
  EXPECT_DOUBLE_EQ(micrometres(StandardGrade::IT12, 500.1), 700.0);
}

TEST(StandardGrade, WhereTheStandardHasNoneThereIsNone) {
  EXPECT_FALSE(standard_tolerance(StandardGrade::IT8, 0.0));
  EXPECT_FALSE(standard_tolerance(StandardGrade::IT8, -5.0));
  EXPECT_FALSE(standard_tolerance(StandardGrade::IT8, std::nan("")));
  EXPECT_TRUE(standard_tolerance(StandardGrade::IT8, kLargestGradedSize));
  EXPECT_FALSE(standard_tolerance(StandardGrade::IT8, 3150.1));
  EXPECT_TRUE(standard_tolerance(StandardGrade::IT0, 500.0));
  EXPECT_FALSE(standard_tolerance(StandardGrade::IT0, 501.0));
  EXPECT_FALSE(standard_tolerance(StandardGrade::IT14, 1.0));
  EXPECT_TRUE(standard_tolerance(StandardGrade::IT14, 1.1));
  EXPECT_TRUE(standard_tolerance(StandardGrade::IT13, 1.0));
}

TEST(StandardGrade, TheCoarsestIsNeverWider) {
  EXPECT_EQ(coarsest_grade(375.0, 0.089), StandardGrade::IT8);
  EXPECT_EQ(coarsest_grade(375.0, 0.0889), StandardGrade::IT7);
  EXPECT_EQ(coarsest_grade(375.0, 1000.0), StandardGrade::IT18);
  EXPECT_EQ(coarsest_grade(375.0, 0.003), StandardGrade::IT01);
  EXPECT_EQ(coarsest_grade(375.0, 0.0029), std::nullopt);
  EXPECT_EQ(coarsest_grade(950.0, 0.011), StandardGrade::IT1);
  EXPECT_EQ(coarsest_grade(950.0, 0.0109), std::nullopt);
  EXPECT_EQ(coarsest_grade(4000.0, 10.0), std::nullopt);
}

TEST(StandardGrade, NamesAreThoseOfTheStandard) {
  EXPECT_EQ(name(StandardGrade::IT01), "IT01");
  EXPECT_EQ(name(StandardGrade::IT18), "IT18");
  EXPECT_EQ(standard_grade_named("IT8"), StandardGrade::IT8);
  for (const char* other : {"IT19", "it8", "H7", "IT", "8", ""}) EXPECT_FALSE(standard_grade_named(other)) << other;
}

}  // namespace
}  // namespace paracal::standard_grade_test
