#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "information_root.hpp"

namespace paracal {

/// Adds the rows [dr/dp | r] at p, each divided by its standard deviation; false when the model cannot be evaluated
/// there.
using RowModel = std::function<bool(const Eigen::VectorXd& parameters, InformationRoot& rows)>;

enum class LeastSquaresStatus : std::uint8_t {
  converged,      ///< the next step would change the residuals by less than step_tolerance, or rounding hides it
  not_converged,  ///< max_iterations spent, or no step descends; parameters are the best found
  not_evaluable,  ///< the model failed at the start; parameters are the start
};

struct LeastSquaresOptions {
  int max_iterations = 50;
  double step_tolerance = 1e-7;  ///< of the residuals' change |J dp|, relative to 1 + |r|
  double rank_tolerance = 1e-7;  ///< pivots of the column-scaled Jacobian below this share of the largest count as zero
  double initial_damping = 0.0;  ///< lambda of the first step; 0: a full Gauss-Newton step is tried first
};

struct [[nodiscard]] LeastSquaresResult {
  LeastSquaresStatus status = LeastSquaresStatus::not_evaluable;
  Eigen::VectorXd parameters;
  InformationRoot at_answer{0};
  int iterations = 0;
};

/// min over p of |r(p)|^2: Levenberg-Marquardt on the streamed root of the Jacobian,
///
///   \f[ min_{dp} |R dp + q|^2 + lambda |D dp|^2 \f]
///
/// with the largest column lengths of R so far in D, and lambda led by the ratio of the true to the predicted descent
/// (Nielsen 1999). Of all steps that change the residuals alike, the one of minimal length |C dp| is taken, C: the
/// column lengths of R, whatever lambda is: directions which the data do not see stay where they started.
LeastSquaresResult solve_least_squares(const RowModel& model, const Eigen::VectorXd& start,
                                       const LeastSquaresOptions& options = {});

/// How often this process has done so: work that tests count, since times vary.
std::uint64_t least_squares_solved();

}  // namespace paracal
