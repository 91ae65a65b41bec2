#pragma once

// Private to tolerance: machines that fail at some half-widths, as what they tell of others near by.

#include <Eigen/Core>
#include <vector>

#include "optimizer.hpp"
#include "paracal/tolerance/allocation.hpp"

namespace paracal::detail {

/// log P(T') of allocate(), by the linear model, from machines drawn at T.
class FailingMachines {
 public:
  /// @param half_widths  T of the design variables. @param limits  those by yield.
  FailingMachines(const Robot& robot, const AllocationProblem& problem, const std::vector<Requirement>& limits,
                  const std::vector<Pose>& poses, const Eigen::VectorXd& half_widths);

  /// None: then nothing is known of the share but that it is very small.
  bool empty() const { return log_weights_.size() == 0; }
  /// @param x  log T'. @param gradient  d log P / d x; resized where it is not empty.
  double log_share(const std::vector<double>& x, std::vector<double>& gradient) const;

 private:
  Eigen::VectorXd at_;       ///< log T
  Eigen::ArrayXd counts_;    ///< how many errors share each variable
  Eigen::ArrayXXd squares_;  ///< a row a machine, a column a variable: sum of z^2 over these errors
  Eigen::ArrayXd log_weights_;
};

}  // namespace paracal::detail
