// The functions that promise to be real-time safe must not touch the heap.

#include <gtest/gtest.h>

#include "paracal/compensation/parameter_buffer.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "support/allocation_count.hpp"
#include "support/robots.hpp"

namespace paracal::allocation_test {
namespace {

class AllocationLaw : public test::EveryRobot {
 protected:
  test::Random random;
  Pose pose = random.pose(robot);
  DifferentiableMachine machine = differentiable(robot, random.realistic_errors(robot));
  Joints joints = inverse(robot.nominal(), pose).joints;

  template <typename Task>
  static std::size_t count(Task&& task) {
    const std::size_t before = test::allocation_count();
    task();
    return test::allocation_count() - before;
  }
};

TEST_P(AllocationLaw, TheCounterCounts) {
  EXPECT_GE(count([] { std::vector<double>(1000).at(3) = 1.0; }), 1u);
}

TEST_P(AllocationLaw, PoseEvaluationsDoNotAllocate) {
  bool good = true;
  EXPECT_EQ(count([&] { good = good && inverse(robot.nominal(), pose).ok(); }), 0u);
  EXPECT_EQ(count([&] { good = good && inverse(machine, pose).ok(); }), 0u);
  EXPECT_EQ(count([&] { good = good && forward(machine, joints).ok(); }), 0u);
  EXPECT_EQ(count([&] { good = good && error_model(robot, pose).ok(); }), 0u);
  EXPECT_EQ(count([&] { good = good && exact_jacobian(machine, forward(machine, joints).plate, joints).ok; }), 0u);
  EXPECT_TRUE(good);
}

TEST_P(AllocationLaw, CompensationDoesNotAllocate) {
  const auto parameters = compensator_parameters(robot, random.realistic_errors(robot));
  ParameterBuffer<double> buffer(parameters);
  ParameterReader<double> reader(buffer);
  CompensatorJoints<double> compensated{};
  CompensatorTilt<double> tilt;
  bool good = true;
  for (const CompensationWay way : {CompensationWay::linear, CompensationWay::tilt_aware, CompensationWay::exact}) {
    EXPECT_EQ(count([&] {
                buffer.publish(parameters);
                const CompensationStatus status =
                    compensate(reader.latest(), way, closure_pose(pose), compensated, &tilt);
                good = good && status == CompensationStatus::ok;
              }),
              0u);
  }
  EXPECT_TRUE(good);
}

PARACAL_ON_EVERY_ROBOT(AllocationLaw);

}  // namespace
}  // namespace paracal::allocation_test
