#include "paracal/compensation/parameter_buffer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <thread>

#include "paracal/compensation/parameters.hpp"
#include "paracal/mechanism/catalogue.hpp"

namespace paracal::parameter_buffer_test {
namespace {

using Parameters = CompensatorParameters<double>;

bool same(const Parameters& one, const Parameters& other) { return std::memcmp(&one, &other, sizeof one) == 0; }

/// Parameters that show a mixture: every word says which publication it belongs to.
Parameters stamped(std::uint32_t stamp) {
  Parameters parameters;
  auto* bytes = reinterpret_cast<unsigned char*>(&parameters);
  for (std::size_t k = 0; k < sizeof parameters; k += sizeof stamp) std::memcpy(bytes + k, &stamp, sizeof stamp);
  return parameters;
}

std::uint32_t stamp_of(const Parameters& parameters) { return parameters.limb_count; }

class ParameterBufferTest : public testing::Test {
 protected:
  static Parameters some_machine() {
    SourceErrors errors;
    errors(1, "e_x") = 0.5;
    errors(2, "alpha2") = 1e-4;
    return compensator_parameters(catalogue::huang2016(), errors);
  }

  Parameters machine = some_machine();
  ParameterBuffer<double> buffer{machine};
  ParameterReader<double> reader{buffer};
};

TEST_F(ParameterBufferTest, StartsWithTheNominalRobot) {
  EXPECT_TRUE(same(reader.latest(), compensator_parameters(catalogue::huang2016(), SourceErrors())));
}

TEST_F(ParameterBufferTest, GivesWhatWasPublishedLast) {
  buffer.publish(stamped(1));
  buffer.publish(machine);
  EXPECT_TRUE(same(reader.latest(), machine));
  EXPECT_TRUE(same(reader.latest(), machine));
}

TEST_F(ParameterBufferTest, FallsBackToTheNominalRobot) {
  buffer.publish(machine);
  EXPECT_TRUE(same(reader.latest(), machine));
  buffer.fall_back();
  EXPECT_TRUE(same(reader.latest(), without_errors(machine)));
}

/// Joints go in equal parts, wherever the plate moves meanwhile, and a publication during a change waits.
TEST_F(ParameterBufferTest, ChangesInEqualParts) {
  constexpr std::uint32_t kCycles = 4;
  ChangingCompensator<double> changing(buffer, kCycles);
  const auto exact = [](const Parameters& parameters, const CompensatorPose<double>& pose) {
    CompensatorJoints<double> joints{};
    EXPECT_EQ(compensate(parameters, CompensationWay::exact, pose, joints), CompensationStatus::ok);
    return joints;
  };
  Parameters later = machine;
  later.identified[0].arm += 1.0;
  buffer.publish(machine);
  for (std::uint32_t k = 1; k <= 2 * kCycles + 1; ++k) {
    const CompensatorPose<double> pose{.x = 10.0 * k, .y = -50.0, .z = -900.0, .phi = 0.1};
    CompensatorJoints<double> joints{};
    ASSERT_EQ(changing.compensate(pose, joints), CompensationStatus::ok);
    if (k == 2) buffer.publish(later);
    const bool is_second = k > kCycles;
    const auto from = exact(is_second ? machine : buffer.nominal(), pose),
               to = exact(is_second ? later : machine, pose);
    const double share = std::min(1.0, static_cast<double>(is_second ? k - kCycles : k) / kCycles);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(joints[i], from[i] + share * (to[i] - from[i]), 1e-14) << k;
    EXPECT_EQ(changing.is_changing(), k % kCycles != 0 && k < 2 * kCycles);
  }
  CompensatorJoints<double> kept{7.0};
  EXPECT_EQ(changing.compensate({.x = 0.0, .y = 0.0, .z = -5000.0}, kept), CompensationStatus::unreachable);
  EXPECT_EQ(kept[0], 7.0);
}

/// One thread publishes as fast as it can, two others read: never a mixture, never an older one after a newer one.
TEST_F(ParameterBufferTest, IsNeverTorn) {
#ifdef PARACAL_SANITIZED
  constexpr std::uint32_t kPublications = 2'000;
#else
  constexpr std::uint32_t kPublications = 20'000;
#endif
  std::atomic<bool> done = false;
  std::atomic<int> torn = 0, backwards = 0, seen = 0;
  buffer.publish(stamped(1));
  const auto read = [&] {
    ParameterReader<double> own(buffer);
    std::uint32_t last = 0;
    while (!done) {
      const Parameters& parameters = own.latest();
      const std::uint32_t stamp = stamp_of(parameters);
      if (same(parameters, buffer.nominal())) continue;
      torn += same(parameters, stamped(stamp)) ? 0 : 1;
      backwards += stamp < last ? 1 : 0;
      seen += stamp != last ? 1 : 0;
      last = stamp;
    }
  };
  std::thread one(read), other(read);
  for (std::uint32_t k = 2; k < kPublications; ++k) {
    buffer.publish(stamped(k));
    if (k % 64 == 0) std::this_thread::yield();
  }
  while (seen < 2) std::this_thread::yield();
  done = true;
  one.join();
  other.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backwards, 0);
  buffer.publish(machine);
  EXPECT_TRUE(same(reader.latest(), machine));
}

}  // namespace
}  // namespace paracal::parameter_buffer_test
