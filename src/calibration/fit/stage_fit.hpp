#pragma once

// Private to calibration: one stage of the fit.

#include <optional>
#include <string>
#include <vector>

#include "observation.hpp"
#include "outliers.hpp"
#include "paracal/numerics/least_squares.hpp"
#include "scatter.hpp"

namespace paracal::detail {

/// Seeks some source errors from a machine that already has `errors`, and the noise that nobody stated.
class StageFit {
 public:
  StageFit(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
           std::vector<SoughtSource> sought, const SourceErrors& errors, bool seeks_scale = false);

  const Observation& observation() const { return observation_; }
  /// To be solved or settled again when it has been changed.
  Observation& observation_to_change() { return observation_; }
  const LeastSquaresResult& fit() const { return fit_; }
  bool converged() const { return fit_.status == LeastSquaresStatus::converged; }
  int iterations() const { return iterations_; }
  /// Of the robust loss, in all.
  int robust_rounds() const { return robust_rounds_; }

  void solve();
  /// Eq. (19) with the derivative at the nominal machine, p <- p - H^+ (predicted - measured), until p settles. (Plain
  /// repetition: the fixed derivative makes no descent directions that a damped method could rely on.)
  void solve_by_pseudo_inverse();
  /// Solves and finds the noise that nobody stated, in turn, until both settle: the squares of the residuals then equal
  /// the degrees of freedom that the fit leaves them, noise^2 <- noise^2 sum / redundancy, a stationary point of the
  /// marginal likelihood.
  void settle();
  /// Names and leaves out gross errors. Where the readings scatter suspiciously, a robust loss first finds those that
  /// hide behind each other; then, one at a time, the reading that contradicts the others most, if chance does not
  /// explain it (data snooping  [baarda1968]).
  void exclude_outliers(double outlier_chance);
  /// Which readings are not left out.
  std::vector<bool> kept() const;
  /// Leaves out the others. To be settled again.
  void keep(const std::vector<bool>& kept);
  /// Multiplies the prior standard deviations of some sought errors (by their places). To be settled again.
  void widen_priors(const std::vector<std::size_t>& places, double factor);

  /// Of the active readings. Without priors: residual sum, and rows less unknowns.
  Scatter scatter() const;
  const std::vector<Contradiction>& suspects() const;
  /// Of all unknowns.
  Eigen::MatrixXd covariance() const { return inverse_information(fit_.at_answer.root()); }

 private:
  bool may_exclude() const;
  std::optional<Contradiction> most_contradicting() const;
  bool is_suspicious() const;
  /// To a thousandth of a standard deviation: enough where the next round changes what is solved.
  void solve_roughly();
  void solve_to(double step_tolerance);
  void mark_by_robust_loss(double outlier_chance);
  /// Solves with Cauchy's weights until it settles.
  /// @returns the studentised sizes that gave the last weights.
  std::vector<double> settle_by_robust_loss();
  void exclude_one_by_one(double outlier_chance);
  /// Takes back readings that were left out and do not contradict the rest.
  /// @returns whether there was one.
  bool readmit(double outlier_chance);
  /// @returns empty where noise of several kinds is sought, without priors, and where the noise has changed since the
  /// fit was solved.
  std::optional<Scatter> scatter_at_answer() const;
  Scatter found_scatter() const;
  /// Each returns the factor by which it changed a standard deviation. All series alike: what tells them apart is found
  /// when gross errors are left out.
  double update_noise();
  /// As far as orientations scatter more than the positions that were read with them, or less.
  double update_orientation_noise();

  /// What was asked of the fit as it stands, found once.
  struct Known {
    std::optional<Scatter> scatter;
    std::optional<std::vector<Contradiction>> suspects;
  };

  Observation observation_;
  LeastSquaresResult fit_;
  NoiseOfSeries solved_with_;  ///< the noise then
  mutable Known known_;
  Eigen::VectorXd prior_factors_;
  int iterations_ = 0, robust_rounds_ = 0;
};

}  // namespace paracal::detail
