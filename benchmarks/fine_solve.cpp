#include "fine_solve.hpp"

#include "calibration/readings/points.hpp"
#include "calibration/sought.hpp"
#include "paracal/calibration/least_squares.hpp"

namespace paracal::benchmark {

FineSolve::FineSolve(const FineFit& fit)
    : observation_(fit.robot, fit.measurements, options_, detail::all_with_priors(fit.robot, options_)),
      start_(observation_.start(fit.start).value()) {}

FineAnswer FineSolve::operator()() const {
  const LeastSquaresResult result = solve_least_squares(detail::with_priors(observation_), start_);
  const auto& points = dynamic_cast<const detail::Points&>(*observation_.series().front());
  return {observation_.errors(result.parameters), points.frame(result.parameters), result.iterations};
}

}  // namespace paracal::benchmark
