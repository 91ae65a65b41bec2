#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace paracal {

/// Residuals r(p) and their Jacobian dr/dp; each residual divided by its standard deviation.
struct Linearization {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

/// Fills the linearization at p; false when the model cannot be evaluated there.
using ResidualModel = std::function<bool(const Eigen::VectorXd& parameters, Linearization& linearization)>;

enum class LeastSquaresStatus : std::uint8_t {
  converged,      ///< the next step would change the residuals by less than step_tolerance
  not_converged,  ///< max_iterations spent, or no step descends; parameters are the best found
  not_evaluable,  ///< the model failed at the start; parameters are the start
};

struct LeastSquaresOptions {
  int max_iterations = 50;
  double step_tolerance = 1e-7;  ///< of the residuals' change |J dp|, relative to 1 + |r|
  double rank_tolerance =
      1e-7;  ///< singular values of the column-scaled Jacobian below this share of the largest count as zero
};

struct [[nodiscard]] LeastSquaresResult {
  LeastSquaresStatus status = LeastSquaresStatus::not_evaluable;
  Eigen::VectorXd parameters;
  Linearization at_answer;
  Eigen::VectorXd singular_values;  ///< of the Jacobian with columns scaled to length one, largest first
  int rank = 0;
  Eigen::MatrixXd covariance;  ///< (J^T J)^+ for unit standard deviation: nothing is said about null directions
  Eigen::MatrixXd null_space;  ///< unit columns of parameter directions that the residuals do not see
  int iterations = 0;
};

/// min over p of |r(p)|^2: Levenberg-Marquardt through the singular value decomposition of the column-scaled Jacobian,
///
///   J D^-1 = U S V^T,   dp = -D^-1 V diag(s / (s^2 + lambda)) U^T r,   singular values below the rank tolerance left
///   out,
///
/// so that directions which the data do not see stay where they started.
LeastSquaresResult solve_least_squares(const ResidualModel& model, const Eigen::VectorXd& start,
                                       const LeastSquaresOptions& options = {});

}  // namespace paracal
