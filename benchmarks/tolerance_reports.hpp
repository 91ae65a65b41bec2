#pragma once

namespace paracal::benchmark {

/// Machines per second of linear Monte Carlo and of its parts, compared with the matrix product of Eigen and, if
/// installed, OpenTURNS, on the same number of threads.
void report_linear_monte_carlo(unsigned threads);

/// Machines per second of exact Monte Carlo, compared with its forward solutions.
void report_exact_monte_carlo(unsigned threads);

/// Time of an allocation.
void report_allocation();

}  // namespace paracal::benchmark
