#include "paracal/spelling.hpp"

#include <gmock/gmock.h>

namespace paracal::spelling_test {
namespace {

TEST(Spelling, TheNearestWordWasMeant) {
  const std::vector<std::string> known{"x_mm", "y_mm", "sigma_mm"};
  EXPECT_EQ(meant_by("sigma_m", known), "sigma_mm");    // left out
  EXPECT_EQ(meant_by("sigmaa_mm", known), "sigma_mm");  // inserted
  EXPECT_EQ(meant_by("zigma-mm", known), "sigma_mm");   // changed, twice
  EXPECT_EQ(meant_by("xm_m", known), "x_mm");           // swapped: one mistake
  EXPECT_EQ(meant_by("_xmm", known), "x_mm");
  EXPECT_EQ(meant_by("mm_x", known), std::nullopt);
  EXPECT_EQ(meant_by("y-mm", known), "y_mm");
  EXPECT_EQ(meant_by("y_mm", known), "y_mm");
  EXPECT_EQ(did_you_mean("sigma_m", known), " (did you mean sigma_mm?)");
}

TEST(Spelling, WhatIsFarFromAllMeantNone) {
  const std::vector<std::string> known{"x_mm", "sigma_mm"};
  EXPECT_EQ(meant_by("operator", known), std::nullopt);
  EXPECT_EQ(meant_by("xyz", known), std::nullopt);
  EXPECT_EQ(meant_by("-----ab", {"-----cd"}), std::nullopt);  // two of two letters: hyphens are none
  EXPECT_EQ(meant_by("", known), std::nullopt);
  EXPECT_EQ(meant_by("x_mm", {}), std::nullopt);
  EXPECT_EQ(meant_by(std::string(101, 'x'), {std::string(100, 'x')}), std::nullopt);  // a file may hold anything
  EXPECT_EQ(did_you_mean("operator", known), "");
}

}  // namespace
}  // namespace paracal::spelling_test
