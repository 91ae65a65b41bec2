#include "fine_solve.hpp"

#include "calibration/fit/sought.hpp"
#include "calibration/readings/points.hpp"
#include "paracal/numerics/least_squares.hpp"

namespace paracal::benchmark {

FineSolve::FineSolve(const FineFit& fit)
    : observation_(fit.robot, fit.measurements, options_, detail::all_with_priors(fit.robot, options_)),
      start_(observation_.start(fit.start).value()) {}

FineAnswer FineSolve::operator()() const {
  const LeastSquaresResult result = solve_least_squares(detail::with_priors(observation_), start_);
  return answer(result.parameters, result.iterations);
}

bool FineSolve::rows(const Eigen::VectorXd& unknowns, Eigen::MatrixXd& rows) const {
  const auto stations = observation_.stations(unknowns);
  if (!stations) return false;
  const std::vector<detail::Group>& groups = observation_.groups();
  rows.resize(3 * static_cast<Eigen::Index>(groups.size()), unknowns.size() + 1);
  Eigen::MatrixXd block;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    observation_.rows(groups[k], *stations, unknowns, block);
    rows.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = block;
  }
  return true;
}

Eigen::VectorXd FineSolve::prior_std() const {
  Eigen::VectorXd std = Eigen::VectorXd::Zero(observation_.unknown_count());
  Eigen::Index next = observation_.nuisance_count();
  for (const SoughtSource& source : observation_.sought()) std(next++) = source.prior_std.value_or(0.0);
  return std;
}

FineAnswer FineSolve::answer(const Eigen::VectorXd& unknowns, int iterations) const {
  const auto& points = dynamic_cast<const detail::Points&>(*observation_.series().front());
  return {observation_.errors(unknowns), points.frame(unknowns), iterations};
}

}  // namespace paracal::benchmark
