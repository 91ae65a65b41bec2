#include "optimizer.hpp"

#include <nlopt.h>

#include <memory>
#include <new>

#include "paracal/interruption.hpp"

namespace paracal::detail {
namespace {

double call(unsigned n, const double* x, double* gradient, void* objective) {
  std::vector<double> slope(gradient == nullptr ? 0 : n);
  const double value = (*static_cast<const Objective*>(objective))({x, x + n}, slope);
  for (std::size_t k = 0; k < slope.size(); ++k) gradient[k] = slope[k];
  return value;
}

/// NLopt takes a pointer to mutable data, which call() does not change.
void* data(const Objective& objective) { return const_cast<Objective*>(&objective); }

/// NLopt says what C++ throws; that it cannot get any closer is no failure.
void require_memory(nlopt_result result) {
  if (result == NLOPT_OUT_OF_MEMORY) throw std::bad_alloc();
}

}  // namespace

Minimum minimize(const Minimization& problem, std::vector<double> start) {
  let_interrupt();
  const nlopt_algorithm algorithm =
      problem.algorithm == Minimization::Algorithm::slsqp ? NLOPT_LD_SLSQP : NLOPT_LN_SBPLX;
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(
      nlopt_create(algorithm, static_cast<unsigned>(start.size())), &nlopt_destroy);
  if (!search) throw std::bad_alloc();
  require_memory(nlopt_set_lower_bounds(search.get(), problem.lower.data()));
  require_memory(nlopt_set_upper_bounds(search.get(), problem.upper.data()));
  if (!problem.first_step.empty()) require_memory(nlopt_set_initial_step(search.get(), problem.first_step.data()));
  nlopt_set_xtol_rel(search.get(), problem.step_tolerance);
  nlopt_set_maxeval(search.get(), problem.max_evaluations);
  nlopt_set_min_objective(search.get(), call, data(problem.objective));
  for (const Objective& constraint : problem.constraints) {
    require_memory(nlopt_add_inequality_constraint(search.get(), call, data(constraint), 1e-12));
  }
  Minimum minimum{.x = std::move(start)};
  require_memory(nlopt_optimize(search.get(), minimum.x.data(), &minimum.value));
  return minimum;
}

}  // namespace paracal::detail
