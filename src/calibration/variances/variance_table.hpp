#pragma once

// Private to calibration: every variance of the readings, estimated together.

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "linear_readings.hpp"
#include "numerics/dense.hpp"
#include "variance_terms.hpp"

namespace paracal::detail {

/// A single fact that may be otherwise than stated: errors far outside their tolerances, or a pose that was not what
/// was commanded.
struct Fact {
  std::vector<std::size_t> errors = {};  ///< places
  double factor = 1.0;                   ///< of their tolerances; of a pose: its size, noises of its readings
  std::optional<std::size_t> pose = {};
};

/// One Gaussian model of the readings with unknown variances  [rue2009],
///
///   y ~ N(S a, V),   V = sum_k exp(2 u_k) K_k
///
/// with priors (Discrepancies) of u, logarithms of standard deviations, and a flat but for what is known of it.
class VarianceTable {
 public:
  /// @param readings  must live as long.
  VarianceTable(const StageFit& fit, const LinearReadings& readings, const DriveSplines& drives,
                const Discrepancies& expected);

  const LinearReadings& readings() const { return *readings_; }
  const std::vector<VarianceTerm>& terms() const { return terms_; }
  /// Places of those of a kind.
  std::vector<std::size_t> terms_of(Spreads what) const;
  /// The same readings where one fact is otherwise.
  VarianceTable with(const Fact& fact) const;

  /// V of one block by itself: readings that share a pose share how far its joints are off; here each has its own.
  Eigen::MatrixXd covariance_of(const ReadingBlock& block, const Eigen::VectorXd& u) const;
  /// N(u): V without the errors, which is what noise, visits and poses add. Its lower triangle alone.
  Eigen::MatrixXd covariance_beside_errors(const Eigen::VectorXd& u) const;
  /// L(u): all errors are L t with t ~ N(0, I) before any reading.
  Eigen::MatrixXd root_of_errors(const Eigen::VectorXd& u) const;

  /// Terms of errors with their standard deviations; last what a fact adds, which no variance scales.
  std::vector<std::pair<const VarianceTerm*, double>> error_terms(const Eigen::VectorXd& u) const;
  /// Variances of the noise of each reading.
  Eigen::VectorXd noise_variances(const Eigen::VectorXd& u) const;

  struct At {
    double cost = 0.0;               ///< minus the logarithm of the posterior density of u, but for a constant
    Eigen::VectorXd gradient = {};   ///< d cost / d u
    Eigen::MatrixXd curvature = {};  ///< average information  [gilmour1995], and that of the priors
    Eigen::VectorXd z = {};          ///< P y
    Eigen::MatrixXd P = {};          ///< V^-1 but for what the set-up takes up
    Eigen::VectorXd set_up = {};     ///< a
  };
  At at(const Eigen::VectorXd& u, bool derivatives) const;

  struct Mode {
    Eigen::VectorXd u;
    Eigen::MatrixXd curvature;
    double log_density = 0.0;   ///< at the mode
    double log_evidence = 0.0;  ///< integrated, by Laplace's approximation
  };
  /// By Newton's method from two starts: where a joint is loose there are two modes.
  Mode mode() const;
  /// The mode where nothing spreads in these ways, from a start.
  Mode mode_without(const std::vector<Spreads>& ways, Eigen::VectorXd start) const;
  /// Standard deviation of the visits' scatter over the noise with which readings entered, where poses were visited
  /// twice.
  std::optional<double> noise_of_visits() const;
  /// Something tells noise from joints that stop elsewhere: visits, a statement, or orientations beside positions. Else
  /// a single visit of each pose shows their sum.
  bool tells_noise() const;

 private:
  /// How visits scatter about their mean: W = sum_k exp(2 u_k) R_k, R = h h^T of a joint or of the rows of a noise.
  struct Visits {
    Eigen::MatrixXd squares;
    double freedom = 0.0;
    std::vector<std::pair<std::size_t, Eigen::VectorXd>> joints;  ///< term, h
    std::vector<std::size_t> noise;                               ///< term of each row
  };
  void add_noise();
  void add_joints(Spreads what);
  void add_errors(const StageFit& fit, const DriveSplines& drives);
  VarianceTerm term_of_errors(Spreads what, std::vector<Eigen::Index> places, const Eigen::MatrixXd& covariance) const;
  void list_visits();
  std::size_t term_of(Spreads what, Eigen::Index joint = -1) const;
  /// Term of the noise of each row of a block.
  std::vector<std::size_t> noise_of(const ReadingBlock& block) const;
  Cholesky root_of_covariance(const Eigen::VectorXd& variances) const;
  /// Takes the set-up out of P = V^-1, with its cost; false where the readings leave the set-up open.
  bool take_up_set_up(const Cholesky& root, At& at) const;
  void add_slopes(const Eigen::VectorXd& variances, At& at) const;
  void add_prior(const Eigen::VectorXd& u, At& at) const;
  void add_visits(const Eigen::VectorXd& variances, bool derivatives, At& at) const;
  std::vector<Eigen::VectorXd> starts() const;
  /// @param held  places of variances that stay as they are.
  Mode mode_from(const Eigen::VectorXd& start, const std::vector<std::size_t>& held = {}) const;

  const LinearReadings* readings_;
  Discrepancies expected_;
  double noise_mm_;     ///< with which readings entered
  double least_noise_;  ///< of that: what no instrument is below
  std::vector<VarianceTerm> terms_;
  std::optional<VarianceTerm> fixed_;  ///< what a fact adds, of variance 1
  std::vector<Visits> visits_;
};

}  // namespace paracal::detail
