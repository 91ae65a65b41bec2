#include "fine_solve.hpp"

#include "calibration/sought.hpp"
#include "paracal/calibration/least_squares.hpp"

namespace paracal::benchmark {

FineSolve::FineSolve(const FineFit& fit)
    : observation_(fit.robot, fit.measurements, options_, detail::all_with_priors(fit.robot, options_)),
      start_(observation_.start(fit.start).value()) {}

FineAnswer FineSolve::operator()() const {
  const LeastSquaresResult result = solve_least_squares(detail::with_priors(observation_), start_);
  return {observation_.errors(result.parameters), observation_.frame(0, result.parameters), result.iterations};
}

}  // namespace paracal::benchmark
