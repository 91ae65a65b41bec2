#pragma once

namespace paracal::benchmark {

/// Time of a fine fit from parsed readings, beside Ceres Solver and SciPy where they were found.
void report_fine_fit();

/// Time a pair and memory of the paper's method with the distances of all pairs of points.
void report_pairs();

/// Time of choosing 20 of 10,000 poses, beside evaluating every exchange afresh.
void report_selection();

}  // namespace paracal::benchmark
