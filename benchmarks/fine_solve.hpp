#pragma once

#include "calibration/fit/observation.hpp"
#include "fine_fit.hpp"

namespace paracal::benchmark {

/// Only the least-squares part of calibrate()'s fine stage, from the start of a FineFit, without the rough stage before
/// and the evidence after it.
class FineSolve {
 public:
  explicit FineSolve(const FineFit& fit);
  FineSolve(const FineSolve&) = delete;
  FineSolve& operator=(const FineSolve&) = delete;

  FineAnswer operator()() const;

  // The same problem for another solver.

  const Eigen::VectorXd& start() const { return start_; }
  /// Rows [J | r] of the points; false where the machine does not close.
  bool rows(const Eigen::VectorXd& unknowns, Eigen::MatrixXd& rows) const;
  /// 0 where there is none.
  Eigen::VectorXd prior_std() const;
  FineAnswer answer(const Eigen::VectorXd& unknowns, int iterations) const;

 private:
  CalibrationOptions options_;
  detail::Observation observation_;
  Eigen::VectorXd start_;
};

}  // namespace paracal::benchmark
