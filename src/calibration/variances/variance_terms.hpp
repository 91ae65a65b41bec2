#pragma once

// Private to calibration: what one variance adds to the covariance of readings, by its structure.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace paracal::detail {

/// What a variance of the table is of.
enum class Spreads : std::uint8_t {
  noise,              ///< of a series, that nobody stated
  stated_noise,       ///< over what was stated
  series_noise,       ///< of a series on trial, besides what it states
  orientation_noise,  ///< likewise, of its angles
  visits,             ///< of a joint, or of all alike, at each visit
  poses,              ///< likewise, at each pose
  drives,             ///< along each joint
  positions,          ///< of parts that move the plate, over their tolerances
  tilts,              ///< of parts that tilt it
};

/// Columns of which most rows are zero: what a joint does to the readings at each pose, or at each visit.
class SparseColumns {
 public:
  /// @param rows  ascending.
  void add(std::span<const Eigen::Index> rows, const Eigen::VectorXd& values);
  void append(const SparseColumns& others);

  /// C C^T: of its multiple the lower triangle is added to M; tr(C C^T P); C C^T z.
  void add_square(double factor, Eigen::MatrixXd& M) const;
  double trace_with(const Eigen::MatrixXd& P) const;
  Eigen::VectorXd square_times(const Eigen::VectorXd& z) const;
  double squared_norm() const;

 private:
  template <typename Look>
  void each(Look&& look) const;

  std::vector<Eigen::Index> rows_;
  std::vector<double> values_;
  std::vector<std::size_t> ends_;  ///< of each column
};

/// One variance: what a variance of 1 adds to the covariance of the readings, K = diag(d) of a noise, C C^T of joints,
/// X D X^T of errors whose covariance is D.
struct VarianceTerm {
  Spreads what;
  Eigen::Index joint = -1;             ///< of visits and poses; -1: all joints alike; of noise: the series
  Eigen::VectorXd diagonal{};          ///< d
  SparseColumns columns{};             ///< C
  std::vector<Eigen::Index> places{};  ///< of the errors that this variance is of; none: of the readings alone
  Eigen::MatrixXd covariance{};        ///< D
  Eigen::MatrixXd with_readings{};     ///< X D
  Eigen::MatrixXd by_errors{};         ///< X D X^T

  /// Adds its part to the lower triangle of a covariance.
  void add_to(Eigen::MatrixXd& V, double variance) const;
  double trace_with(const Eigen::MatrixXd& P) const;      ///< tr(K P), P symmetric
  Eigen::VectorXd times(const Eigen::VectorXd& z) const;  ///< K z
  double trace() const;
};

}  // namespace paracal::detail
