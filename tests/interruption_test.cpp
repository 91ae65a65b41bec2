#include "paracal/interruption.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "paracal/calibration/pose_selection.hpp"
#include "paracal/mechanism/catalogue.hpp"

namespace paracal::interruption_test {
namespace {

struct Stopped {};

[[noreturn]] void stop() { throw Stopped(); }

TEST(Interruption, WhatTheCheckThrowsEndsTheComputation) {
  const Robot robot = catalogue::huang2016();
  const Interruptible interruptible(&stop);
  EXPECT_THROW((void)candidate_stations(robot, 1000, 1), Stopped);
}

TEST(Interruption, IsOfOneThreadAndEndsWithTheObject) {
  {
    const Interruptible interruptible(&stop);
    std::thread(&let_interrupt).join();  // would end the program
  }
  EXPECT_NO_THROW(let_interrupt());
}

TEST(Interruption, TheEarlierCheckCountsAgain) {
  int asked = 0;
  const Interruptible outer([&] { ++asked; });
  {
    const Interruptible inner([] {});
  }
  while (asked == 0) let_interrupt();  // for ever, if it were forgotten
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace paracal::interruption_test
