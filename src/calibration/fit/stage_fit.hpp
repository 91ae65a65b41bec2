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

/// Sought errors (by their places) whose prior is widened by a common factor.
struct WidenedPriors {
  std::vector<std::size_t> places;
  double factor = 1.0;
};

/// Which components of variance a fit seeks besides the noise that nobody stated.
struct SoughtComponents {
  bool joint = false, stated_noise = false;
  std::vector<WidenedPriors> priors = {};
};

/// Seeks some source errors from a machine that already has `errors`, and the components of variance asked for.
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
  const SoughtComponents& components() const { return sought_; }

  void solve();
  /// Eq. (19) with the derivative at the nominal machine, p <- p - H^+ (predicted - measured), until p settles. (Plain
  /// repetition: the fixed derivative makes no descent directions that a damped method could rely on.)
  void solve_by_pseudo_inverse();
  /// Solves and finds the components of variance, in turn, until both settle: each variance such that the squares
  /// which it explains equal the degrees of freedom that the fit leaves them,
  ///
  ///   noise^2 <- noise^2 sum / redundancy,   joint^2 <- sum |dq|^2 / (n - tr C_dq / joint^2),
  ///   prior^2 <- prior^2 sum (p / prior)^2 / (n - sum C_pp / prior^2),
  ///
  /// a stationary point of the marginal likelihood.
  void settle();
  /// Names and leaves out gross errors. Where the readings scatter suspiciously, a robust loss first finds those that
  /// hide behind each other; then, one at a time, the reading that contradicts the others most, if chance does not
  /// explain it (data snooping  [baarda1968]).
  void exclude_outliers(double outlier_chance);
  /// Which readings are not left out.
  std::vector<bool> kept() const;
  /// Leaves out the others. To be settled again.
  void keep(const std::vector<bool>& kept);
  /// Begins to seek a component, at `start` (a standard deviation, or a factor of it).
  void seek_joint(double start);
  void seek_stated_noise(double start);
  void seek_wider_priors(std::vector<std::size_t> places, double start);
  /// Factor of the priors of just these errors, where it is sought.
  std::optional<double> widened(const std::vector<std::size_t>& places) const;

  /// Of the active readings. Without priors: residual sum, and rows less unknowns.
  Scatter scatter() const;
  const std::vector<Contradiction>& suspects() const;
  /// Of all unknowns.
  Eigen::MatrixXd covariance() const { return inverse_information(fit_.at_answer.root()); }
  /// -2 log of the marginal likelihood (Laplace's: exact for a linear model) but for a constant.
  double minus_twice_log_likelihood() const;
  /// The same over all readings, those left out as gross ones: one in 1000 is gross, and may then lie anywhere within
  /// 10 mm.
  double minus_twice_log_likelihood_of_all() const;
  /// Degrees of freedom that determine the joints' standard deviation: n - tr C_dq / joint^2.
  double joint_freedom() const;
  /// Squares of sought errors (by their places) over their prior covariance P, and the degrees of freedom that
  /// determine these: p^T P^-1 p and n - tr P^-1 C_pp.
  Scatter prior_squares(const std::vector<std::size_t>& places, const Eigen::MatrixXd& covariance) const;
  /// The fewest degrees of freedom that determine a factor by which the priors of several errors were widened.
  std::optional<double> prior_freedom() const;

  /// What a component tried in vain leaves no trace of.
  struct State {
    VarianceComponents components, solved_with;
    SoughtComponents sought;
    LeastSquaresResult fit;
  };
  State state() const { return {observation_.components(), solved_with_, sought_, fit_}; }
  void restore(State state);

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
  /// @returns empty where noise of several kinds, joints or wider priors are sought, without priors, and where
  /// components have changed since the fit was solved.
  std::optional<Scatter> scatter_at_answer() const;
  Scatter found_scatter() const;
  /// Each returns the factor by which it changed a standard deviation.
  double update_noise(double& factor, bool stated);
  /// As far as orientations scatter more than the positions that were read with them, or less.
  double update_orientation_noise();
  double update_joint();
  /// Never below what the tolerances say: half the machines would seem better than that, by chance.
  double update_priors(WidenedPriors& widened);
  /// By what is sought.
  void widen_priors();
  struct JointSquares {
    double sum = 0.0;      ///< of dq^2
    double freedom = 0.0;  ///< that determine it
  };
  JointSquares joint_squares() const;

  /// What was asked of the fit as it stands, found once.
  struct Known {
    std::optional<Scatter> scatter;
    std::optional<std::vector<Contradiction>> suspects;
  };

  Observation observation_;
  LeastSquaresResult fit_;
  VarianceComponents solved_with_;  ///< the components of variance then
  mutable Known known_;
  SoughtComponents sought_;
  int iterations_ = 0, robust_rounds_ = 0;
};

}  // namespace paracal::detail
