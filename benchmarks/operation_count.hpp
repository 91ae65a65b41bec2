#pragma once

#include "counted.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::benchmark {

/// The operations of one pose on one robot as written in the sources, including those that a compiler may share or
/// omit. Templates of the library and most of Eigen's run on counting numbers. Code for double alone and factorizations
/// are counted by hand in operation_count.cpp, which must follow the sources. All sums are 0 to 8 % below a complete
/// count of the library on counting numbers.
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
