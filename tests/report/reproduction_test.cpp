#include "paracal/report/reproduction.hpp"

#include <gtest/gtest.h>

#include "paracal/units.hpp"

namespace paracal::report {
namespace {

TEST(Reproduction, EveryPublishedNumberWithinItsTolerance) {
  const Reproduction reproduction = reproduce_huang2016(io::published_huang2016());
  // Offsets, Table 3 before and after, Figures 7 and 8, Table 5 before, Table 4, Table 5 after, Figure 9.
  EXPECT_EQ(reproduction.rows.size(), 4u + 18u + 6u + 6u + 4u + 2u + 3u + 25u + 3u + 3u);
  for (const ReproductionRow& row : reproduction.rows) {
    EXPECT_TRUE(row.ok()) << row.id << ": paper " << row.paper << ", ours " << row.ours << ", tolerance "
                          << row.tolerance;
  }
}

TEST(Reproduction, ADifferentMachineIsNotable) {
  io::PublishedHuang2016 published = io::published_huang2016();
  published.offsets(0, Source::theta_offset) += to_radians(0.3);
  EXPECT_FALSE(reproduce_huang2016(published).ok());
}

TEST(PublishedData, DistancesAreTable3) {
  const io::PublishedHuang2016 published = io::published_huang2016();
  ASSERT_EQ(published.rough.distances.size(), published.before.size());
  for (std::size_t k = 0; k < published.before.size(); ++k) {
    EXPECT_NEAR(published.rough.distances[k].distance, 500.0 + published.before[k].error.distance, 1e-9);
  }
  EXPECT_EQ(published.after.size(), 6u);
}

}  // namespace
}  // namespace paracal::report
