#pragma once

#include <vector>

#include "paracal/mechanism/robot.hpp"
#include "paracal/tolerance/monte_carlo.hpp"

namespace paracal::benchmark {

/// Tilt of huang2016 with its tolerances, at the 121 poses of workspace_stations().
struct TiltTask {
  TiltTask();

  Robot robot;
  std::vector<Pose> poses;
  Requirement requirement;

  /// Exactly so many machines: the error asked for is out of reach.
  MonteCarlo monte_carlo(Model model, std::uint64_t machines, unsigned threads) const;
};

}  // namespace paracal::benchmark
