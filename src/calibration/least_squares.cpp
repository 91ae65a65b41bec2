#include "paracal/calibration/least_squares.hpp"

#include <Eigen/SVD>

namespace paracal {
namespace {

/// Singular value decomposition of a Jacobian whose columns were scaled to length one (all-zero columns stay zero).
class ScaledDecomposition {
 public:
  ScaledDecomposition(const Eigen::MatrixXd& jacobian, double rank_tolerance)
      : scale_((jacobian.colwise().norm().array() > 0.0).select(jacobian.colwise().norm(), 1.0)),
        svd_(jacobian * scale_.cwiseInverse().asDiagonal(), Eigen::ComputeThinU | Eigen::ComputeFullV) {
    const Eigen::VectorXd& s = svd_.singularValues();
    while (rank_ < s.size() && s(rank_) > rank_tolerance * s(0)) ++rank_;
  }

  int rank() const { return rank_; }
  const Eigen::VectorXd& singular_values() const { return svd_.singularValues(); }

  Eigen::VectorXd step(const Eigen::VectorXd& residual, double lambda) const {
    const Eigen::ArrayXd s = singular_values().head(rank_);
    const Eigen::VectorXd filtered =
        (s / (s.square() + lambda) * (svd_.matrixU().leftCols(rank_).transpose() * residual).array()).matrix();
    return -(scale_.cwiseInverse().asDiagonal() * (svd_.matrixV().leftCols(rank_) * filtered));
  }

  Eigen::MatrixXd covariance() const {
    const Eigen::MatrixXd root = scale_.cwiseInverse().asDiagonal() * svd_.matrixV().leftCols(rank_) *
                                 singular_values().head(rank_).cwiseInverse().asDiagonal();
    return root * root.transpose();
  }

  Eigen::MatrixXd null_space() const {
    Eigen::MatrixXd directions =
        scale_.cwiseInverse().asDiagonal() * svd_.matrixV().rightCols(svd_.matrixV().cols() - rank_);
    directions.colwise().normalize();
    return directions;
  }

 private:
  Eigen::VectorXd scale_;
  Eigen::JacobiSVD<Eigen::MatrixXd> svd_;
  int rank_ = 0;
};

/// Shortens the step (raises lambda) until the model can be evaluated and the residuals shrink.
bool descend(const ResidualModel& model, const ScaledDecomposition& decomposition, double& lambda,
             LeastSquaresResult& result) {
  constexpr double kFirstLambda = 1e-6, kLambdaGrowth = 10.0, kLambdaDecay = 0.1, kLargestLambda = 1e12;
  // Near the answer a step of size e changes the cost by e^2, which drowns in rounding long before e does.
  constexpr double kRounding = 1e-9;
  const double highest_cost = result.at_answer.residual.squaredNorm() * (1.0 + kRounding);
  while (lambda < kLargestLambda) {
    const Eigen::VectorXd trial = result.parameters + decomposition.step(result.at_answer.residual, lambda);
    Linearization linearization;
    if (model(trial, linearization) && linearization.residual.squaredNorm() <= highest_cost) {
      result.parameters = trial;
      result.at_answer = std::move(linearization);
      lambda = lambda * kLambdaDecay < kFirstLambda ? 0.0 : lambda * kLambdaDecay;
      return true;
    }
    lambda = lambda == 0.0 ? kFirstLambda : lambda * kLambdaGrowth;
  }
  return false;
}

}  // namespace

LeastSquaresResult solve_least_squares(const ResidualModel& model, const Eigen::VectorXd& start,
                                       const LeastSquaresOptions& options) {
  LeastSquaresResult result;
  result.parameters = start;
  if (!model(start, result.at_answer)) return result;
  result.status = LeastSquaresStatus::not_converged;
  double lambda = 0.0;
  ScaledDecomposition decomposition(result.at_answer.jacobian, options.rank_tolerance);
  while (result.iterations < options.max_iterations) {
    const Eigen::VectorXd full_step = decomposition.step(result.at_answer.residual, 0.0);
    const double change = (result.at_answer.jacobian * full_step).norm();
    if (change <= options.step_tolerance * (1.0 + result.at_answer.residual.norm())) {
      result.status = LeastSquaresStatus::converged;
      break;
    }
    if (!descend(model, decomposition, lambda, result)) break;
    ++result.iterations;
    decomposition = ScaledDecomposition(result.at_answer.jacobian, options.rank_tolerance);
  }
  result.singular_values = decomposition.singular_values();
  result.rank = decomposition.rank();
  result.covariance = decomposition.covariance();
  result.null_space = decomposition.null_space();
  return result;
}

}  // namespace paracal
