// Fits the position errors of one measured machine N times: fine_fits N. tools/costs.sh counts its instructions.
#include <cstdlib>

#include "calibration/fit/sought.hpp"
#include "calibration/fit/stage_fit.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/random.hpp"

int main(int argc, char** argv) {
  using namespace paracal;
  if (argc != 2) return 2;
  const Robot robot = catalogue::huang2016();
  RandomStream random(1);
  VirtualInstrument instrument;
  instrument.noise = 0.017;
  const Measurements measured = simulate(robot, {}, fine_stations(robot, 20), instrument, random);
  const CalibrationOptions options;
  for (int k = 0; k < std::atoi(argv[1]); ++k) {
    detail::StageFit stage(robot, measured, options, detail::all_with_priors(robot, options), {});
    stage.settle();
    if (!stage.converged()) return 1;
  }
  return 0;
}
