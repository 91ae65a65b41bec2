#pragma once

#include <string>

namespace paracal::benchmark {

/// Time of a fine fit from parsed readings, beside Ceres Solver where that was found.
/// @param tasks  file that calibration_opponent.py reads: the same fits, and our time; empty: none.
void report_fine_fit(const std::string& tasks);

/// Time a pair and memory of the paper's method with the distances of all pairs of points.
void report_pairs();

/// Time of choosing 20 of 10,000 poses, beside evaluating every exchange afresh.
void report_selection();

}  // namespace paracal::benchmark
