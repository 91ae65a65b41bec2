// When a calibration asks what is wrong with its input: one machine for each doubt, of which no other doubt arises.

#include <gmock/gmock.h>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::doubt_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNoise = 0.017;  // mm

/// By a controller that knew the limbs in another order.
Measurements of_other_limbs(const Robot& robot) {
  Measurements measured = measure(robot, {}, fine_stations(robot, 9), 1, {.noise = kNoise});
  for (Station& station : measured.stations) {
    station.believed = believed_joints(robot, station);
    std::swap((*station.believed)(0), (*station.believed)(1));
  }
  return measured;
}

std::string first_reason(const Calibration& calibration) {
  return calibration.reasons.empty() ? "accepted" : calibration.reasons.front();
}

/// The rough stage seeks no components and leaves nothing out.
class RoughDoubts : public testing::Test {
 protected:
  Robot robot = catalogue::rotary_delta();
  CalibrationOptions options{.stage = Stage::rough, .states_use = false};
};

TEST_F(RoughDoubts, ReadingsScatterMoreThanTheyState) {
  Measurements stated = of_other_limbs(robot);
  state_sigma(stated, kNoise);
  options.noise.point = 1e6;  // is not asked
  EXPECT_THAT(first_reason(calibrate(robot, stated, options)), HasSubstr("limbs are in another order"));
}

/// By the noise that was expected of what was read.
TEST_F(RoughDoubts, ReadingsScatterMoreThanWasExpected) {
  const Measurements points = of_other_limbs(robot);
  options.noise.distance = options.noise.height = 1e6;
  options.noise.point = 1e-2 * calibrate(robot, points, {.stage = Stage::rough, .diagnose = false}).noise;
  EXPECT_THAT(first_reason(calibrate(robot, points, options)), HasSubstr("limbs are in another order"));
}

/// The controller knew its rods; the file has others.
Robot misprinted(const Robot& robot, Measurements& measured) {
  for (Station& station : measured.stations) station.believed = believed_joints(robot, station);
  RobotDescription description = robot.description();
  description.workspace.radius = description.workspace.height = 1.0;
  test::redimension(description, [&](SharedDimensions& shared) { shared.rod += 10.0; });
  return Robot(std::move(description));
}

TEST(Doubts, AnErrorIsFarOutsideItsTolerance) {
  const Robot robot = catalogue::huang2016();
  Measurements measured = measured_machine(robot, fine_stations(robot, 9), 9, {.noise = kNoise}).measurements;
  const Robot wrong = misprinted(robot, measured);
  const CalibrationOptions options{
      .stage = Stage::fine, .noise_is_known = true, .seeks_discrepancies = false, .states_use = false};
  EXPECT_THAT(first_reason(calibrate(wrong, measured, options)), HasSubstr("with rod_mm = "));
}

/// What the fit took for a fault of the machine was the mistake's doing: nothing is said of it. Its U is stated.
TEST(Doubts, NothingOfTheConsequencesIsSaid) {
  const Robot robot = catalogue::huang2016();
  Measurements measured = measured_machine(robot, fine_stations(robot, 9), 9, {.noise = kNoise}).measurements;
  measured.notes = {"of the import"};
  const Robot wrong = misprinted(robot, measured);
  const Calibration fooled = calibrate(wrong, measured, {.diagnose = false}), told = calibrate(wrong, measured);
  ASSERT_FALSE(fooled.components.empty());
  ASSERT_GT(fooled.notes.size(), 1u);
  EXPECT_EQ(told.verdict, Verdict::rejected);
  EXPECT_THAT(told.reasons, ElementsAre(HasSubstr("with rod_mm = ")));
  EXPECT_THAT(told.components, IsEmpty());
  EXPECT_THAT(told.notes, ElementsAre("of the import"));
  EXPECT_TRUE(told.use);
}

}  // namespace
}  // namespace paracal::test::doubt_test
