#pragma once

namespace paracal::benchmark {

/// Time of a fine fit from parsed readings, compared with Ceres Solver and SciPy if installed.
void report_fine_fit();

/// Time per pair and memory of the paper's method with the distances of all pairs of points.
void report_pairs();

/// Time of choosing 20 of 10,000 poses, compared with evaluating every exchange from the start.
void report_selection();

}  // namespace paracal::benchmark
