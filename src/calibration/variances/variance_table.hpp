#pragma once

// Private to calibration: every variance of the readings, estimated together.

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "linear_readings.hpp"
#include "numerics/dense.hpp"
#include "variance_terms.hpp"

namespace paracal::detail {

/// A single fact that may be otherwise than stated, one of these, and what it then adds to the readings.
struct Fact {
  std::vector<std::size_t> errors = {};      ///< far outside their tolerances, by their places
  std::optional<std::size_t> pose = {};      ///< was not what was commanded
  std::optional<std::size_t> series = {};    ///< is noisier than it states
  std::optional<ReflectorMount> mount = {};  ///< carries the reflector beside its axis or centre
  Eigen::MatrixXd effect = {};               ///< of a mount: readings by the reflector's place on it, 1/mm
  /// Standard deviation of what it adds: times the tolerances of errors; noises of a pose's readings; of a place, mm;
  /// of a series about that over what it states.
  double size = 1.0;
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
  /// With which readings entered.
  const NoiseOfSeries& entered() const { return entered_; }
  /// Places of those of a kind.
  std::vector<std::size_t> terms_of(Spreads what) const;
  /// Sum of the squares of what all terms of these kinds do to the mean readings, over their noise.
  double squares(const Eigen::VectorXd& u, std::initializer_list<Spreads> kinds) const;
  /// The same readings where these facts are otherwise.
  VarianceTable with(const std::vector<const Fact*>& facts) const;

  /// Adds an effect on the readings (rows x sizes) whose sizes have this standard deviation.
  void add_effect(const Eigen::MatrixXd& effect, double size);

  /// Visits scatter like this about their mean: of each block of the readings, as its `scatter`.
  void take_scatter(const std::vector<Eigen::MatrixXd>& of_blocks);

  /// V of one block by itself: readings that share a pose share how far its joints are off; here each has its own.
  Eigen::MatrixXd covariance_of(const ReadingBlock& block, const Eigen::VectorXd& u) const;
  /// How the visits of one block scatter about what is the same at each of them.
  Eigen::MatrixXd covariance_of_visits(const ReadingBlock& block, const Eigen::VectorXd& u) const;
  /// N(u): V without the errors, which is what noise, visits and poses add. Its lower triangle alone.
  Eigen::MatrixXd covariance_beside_errors(const Eigen::VectorXd& u) const;
  /// L(u): all errors are L t with t ~ N(0, I) before any reading.
  Eigen::MatrixXd root_of_errors(const Eigen::VectorXd& u) const;

  /// Terms of errors with their standard deviations; last what a fact adds, which no variance scales.
  std::vector<std::pair<const VarianceTerm*, double>> error_terms(const Eigen::VectorXd& u) const;
  /// Variances of the noise of each reading.
  Eigen::VectorXd noise_variances(const Eigen::VectorXd& u) const;

  /// u of a machine that is its geometry, with errors within their tolerances, and noise as stated, else as in u.
  Eigen::VectorXd of_exact_machine(Eigen::VectorXd u) const;

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
  /// All that visits scatter is noise; or most of it is the joints'.
  std::vector<Eigen::VectorXd> starts() const;
  /// By Newton's method from two starts: where a joint is loose there are two modes.
  Mode mode() const;
  /// The mode where nothing spreads in these ways, from a start.
  Mode mode_without(const std::vector<Spreads>& ways, Eigen::VectorXd start) const;
  /// Of series that state none, over what is expected of such instruments; 0 where all state it.
  double largest_unstated_noise(const Eigen::VectorXd& u) const;
  /// What the visits of a pose scatter about their mean, over the variances of the noise alone, and by how many degrees
  /// of freedom.
  /// @param series  of this series alone.
  Scatter scatter_of_visits(const Eigen::VectorXd& u, std::optional<std::size_t> series = {}) const;
  /// Standard deviation of the visits' scatter over the noise with which readings entered, where poses were visited
  /// twice.
  std::optional<double> noise_of_visits() const;
  /// Something tells noise from joints that stop elsewhere: visits, a statement, or orientations beside positions. Else
  /// a single visit of each pose shows their sum.
  bool tells_noise() const;

 private:
  static constexpr double kLeastNoise = 0.01;  ///< of what was expected of it

  /// How visits scatter about their mean: W = sum_k exp(2 u_k) R_k, R = h h^T of a joint or of the rows of a noise.
  struct Visits {
    Eigen::MatrixXd squares;
    double freedom = 0.0;
    std::vector<std::pair<std::size_t, Eigen::VectorXd>> joints;  ///< term, h
    std::vector<std::size_t> noise;                               ///< term of each row
    std::size_t series = 0;
  };
  void add_series_noise(std::size_t series, double size);
  void add_noise();
  void add_joints(Spreads what);
  void add_errors(const StageFit& fit, const DriveSplines& drives);
  VarianceTerm term_of_errors(Spreads what, std::vector<Eigen::Index> places, const Eigen::MatrixXd& covariance) const;
  void list_visits();
  /// What the joints of a block do by these terms.
  void add_joints_to(const ReadingBlock& block, const Eigen::VectorXd& u, Spreads what, Eigen::MatrixXd& V) const;
  std::size_t term_of(Spreads what, Eigen::Index joint = -1) const;
  /// Term of the noise of each row of a block.
  std::vector<std::size_t> noise_of(const ReadingBlock& block) const;
  Cholesky root_of_covariance(const Eigen::VectorXd& variances) const;
  /// Takes the set-up out of P = V^-1, with its cost; false where the readings leave the set-up open.
  bool take_up_set_up(const Cholesky& root, At& at) const;
  void add_slopes(const Eigen::VectorXd& variances, At& at) const;
  void add_prior(const Eigen::VectorXd& u, At& at) const;
  /// Of the noise of a series over that with which it entered: what no instrument is below.
  double least_noise(Eigen::Index series) const {
    return kLeastNoise / entered_[static_cast<std::size_t>(series)].unstated;
  }
  void add_visits(const Eigen::VectorXd& variances, bool derivatives, At& at) const;
  /// @param held  places of variances that stay as they are.
  Mode mode_from(const Eigen::VectorXd& start, const std::vector<std::size_t>& held = {}) const;

  const LinearReadings* readings_;
  Discrepancies expected_;
  double noise_mm_;        ///< with which readings entered
  NoiseOfSeries entered_;  ///< of that over what was expected
  std::vector<VarianceTerm> terms_;
  std::vector<VarianceTerm> fixed_;  ///< what facts add, of variance 1
  double series_size_ = 1.0;         ///< about the size of the noise of a series on trial, over what it states
  std::vector<Visits> visits_;
};

}  // namespace paracal::detail
