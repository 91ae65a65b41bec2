#pragma once

namespace paracal::benchmark {

/// Machines a second of linear Monte Carlo and of its parts, beside the matrix product of Eigen and, where it was
/// found, OpenTURNS; all on as many threads.
void report_linear_monte_carlo(unsigned threads);

/// Machines a second of exact Monte Carlo, beside the forward solutions that it consists of.
void report_exact_monte_carlo(unsigned threads);

/// Time of an allocation.
void report_allocation();

}  // namespace paracal::benchmark
