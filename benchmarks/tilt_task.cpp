#include "tilt_task.hpp"

#include "paracal/calibration/plan.hpp"
#include "paracal/mechanism/catalogue.hpp"

namespace paracal::benchmark {

TiltTask::TiltTask() : robot(catalogue::huang2016()), requirement{.characteristic = {Quantity::tilt}, .limit = 1e-3} {
  for (const Station& station : workspace_stations(robot)) poses.push_back(station.commanded);
}

MonteCarlo TiltTask::monte_carlo(Model model, std::uint64_t machines, unsigned threads) const {
  return paracal::monte_carlo(robot, *robot.tolerances(), {requirement}, poses,
                              {.model = model, .sigma_error = 1e-9, .max_machines = machines, .threads = threads});
}

}  // namespace paracal::benchmark
