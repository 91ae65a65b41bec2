#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace paracal::detail {

/// f(x), and its gradient where `gradient` is not empty.
using Objective = std::function<double(const std::vector<double>& x, std::vector<double>& gradient)>;

/// Minimise f(x) with lower <= x <= upper and g(x) <= 0, by NLopt.
struct Minimization {
  enum class Algorithm : std::uint8_t {
    subplex,  ///< without derivatives or constraints g [rowan1990]
    slsqp,    ///< sequential quadratic programming [kraft1994]
  };
  Algorithm algorithm = Algorithm::slsqp;
  Objective objective;
  std::vector<Objective> constraints = {};
  std::vector<double> lower, upper;
  std::vector<double> first_step = {};
  double step_tolerance = 1e-10;
  int max_evaluations = 1000;
};

struct Minimum {
  std::vector<double> x;
  double value = 0.0;
};

/// The best point found; whether it is the minimum, the caller checks (SLSQP says "roundoff limited" both on the answer
/// and where it got stuck).
/// @param start  within the bounds.
Minimum minimize(const Minimization& problem, std::vector<double> start);

}  // namespace paracal::detail
