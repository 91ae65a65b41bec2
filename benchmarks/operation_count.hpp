#pragma once

#include "counted.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::benchmark {

/// The work of one pose on one robot as the sources of the library spell it; what a compiler may share or drop is
/// counted. Templates of the library and most of Eigen's are run on counting numbers. Lines that the library has for
/// double alone, and factorizations, are counted by hand in operation_count.cpp, and follow the sources by hand. All
/// sums are 0 to 8 % below what the library did when all of it was once rewritten to run on counting numbers.
struct PoseOperations {
  Operations floor;
  Operations inverse;            ///< nominal machine, closed form
  Operations inverse_iteration;  ///< with tilt errors: one more of these an iteration
  Operations forward_start;      ///< default start, first linearization, final evidence
  Operations forward_iteration;  ///< without halved steps
  Operations error_model;
  Operations exact_jacobian;
};

PoseOperations count_operations(const Robot& robot);

}  // namespace paracal::benchmark
