// What a fit does otherwise where readings are very many: kept, looked at or listed less, the numbers the same.

#include <gtest/gtest.h>

#include "calibration/sought.hpp"
#include "observation_derivatives.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test {
namespace {

constexpr double kNoise = 0.017;  // mm

class LargeSets : public testing::Test {
 protected:
  Robot robot = catalogue::rotary_delta();
  CalibrationOptions options;
};

/// The first readings of 5001 stations give the rows that they give alone.
TEST_F(LargeSets, DerivativesThatAreNotKeptAreTheSame) {
  const Measurements few = measured_machine(robot, fine_stations(robot, 9), 3, {.noise = kNoise}).measurements;
  Measurements many = few;
  many.stations.resize(5001, few.stations.back());
  const std::vector<SoughtSource> sought = detail::all_with_priors(robot, options);
  detail::Observation kept(robot, few, options, sought), anew(robot, many, options, sought);
  const Eigen::VectorXd at = kept.start({}).value();
  ASSERT_EQ(anew.start({}).value(), at);
  EXPECT_TRUE(kept.stations(at)->front().motions.has_value());
  EXPECT_FALSE(anew.stations(at)->front().motions.has_value());
  EXPECT_EQ(rows_of(anew, at), rows_of(kept, at));
}

}  // namespace
}  // namespace paracal::test
