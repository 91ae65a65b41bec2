#pragma once

// Private to calibration: what wider priors promise, before they are tried.

#include <Eigen/Core>
#include <vector>

#include "calibration/fit/stage_fit.hpp"

namespace paracal::detail {

/// By how much -2 log likelihood drops where priors are widened, in a linear model of the fit as it stands, and for
/// which factor. With errors z = L^-1 p over their prior L L^T, their covariance K, and s = 1 - 1 / factor^2,
///
///   drop = sum s v_i^2 / (1 - s k_i) - log(1 - s k_i) + log(1 - s),     K = Q diag(k) Q^T,  v = Q^T z
///
/// over the errors that are widened. (Where they share an error with others, these are taken to follow.) Noise that
/// nobody stated is sought anew: what a wrong part bends, the fit as it stands takes for noise, under which no error
/// stands out.
class PriorPromise {
 public:
  explicit PriorPromise(const StageFit& fit);

  struct Drop {
    double drop = 0.0;
    double factor = 1.0;
  };
  /// @param places  of sought errors that have a prior.
  /// @param least  what a drop must reach to be of use: one that cannot is not computed, and returned as 0.
  Drop of(const std::vector<std::size_t>& places, double least = 0.0) const;

 private:
  /// The fit under noise of another size.
  struct Level {
    double objective = 0.0;  ///< -2 log likelihood less that of the fit as it stands
    Eigen::VectorXd errors;
    Eigen::MatrixXd covariance;
  };
  /// The same in numbers that are independent and, but for readings, of variance 1.
  struct Whitened {
    Eigen::VectorXd known;  ///< their variances, 1 where readings tell nothing
    Eigen::VectorXd errors;
    Eigen::MatrixXd axes;  ///< errors of one of each
  };
  static Whitened whitened(const Level& level, const Eigen::MatrixXd& prior);
  /// No drop of these errors at this level is larger.
  double bound(const Level& level, const std::vector<Eigen::Index>& at) const;
  /// @param at  the fit as it stands.
  void add_level(const Whitened& at, const Scatter& scatter, double variance);

  Eigen::MatrixXd prior_;  ///< covariance under the tolerances, as far as they are widened by now
  std::vector<Level> levels_;
};

}  // namespace paracal::detail
