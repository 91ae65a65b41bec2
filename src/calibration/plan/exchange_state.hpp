#pragma once

// Private to calibration: what of an exchange of poses has the size of all unknowns, whatever the rows of a candidate.

#include <Eigen/Core>
#include <vector>

#include "exchange_poses.hpp"

namespace paracal::detail {

/// C, the covariance with the chosen poses, and B of the criterion tr(B C).
class ExchangeState {
 public:
  ExchangeState(const Problem& problem, Criterion criterion);

  const Eigen::MatrixXd& covariance() const { return covariance_; }
  void set_covariance(const Eigen::MatrixXd& covariance) { covariance_ = covariance; }
  bool is_volume() const { return criterion_ == Criterion::volume; }
  /// log det C, the largest visible eigenvalue of C, or tr(B C).
  double value() const;

  /// C from the chosen poses alone; the worst direction moves B.
  void refresh(const std::vector<Eigen::Index>& chosen);

  /// A_k C A_k^T and A_k C B C A_k^T of candidates, one below the other, as of the last refresh().
  struct Forms {
    Eigen::MatrixXd near, far;
  };
  Forms forms(Eigen::Index first, Eigen::Index count) const;

  /// U = C A_s^T beside V = C B U, and U^T B U; zeros for V and U^T B U where the volume is sought.
  struct Direction {
    Eigen::MatrixXd both, between;
  };
  Direction direction(Eigen::Index s) const;
  /// A_k [U V] of candidates, one below the other.
  Eigen::MatrixXd products(Eigen::Index first, Eigen::Index count, const Direction& along) const;
  /// C -> C - U inner U^T.
  void move(const Direction& along, const Eigen::MatrixXd& inner);

 private:
  auto rows_of(Eigen::Index first, Eigen::Index count) const {
    return problem_->weighted.middleCols(problem_->rows * first, problem_->rows * count);
  }
  Eigen::MatrixXd visible_covariance() const;
  double worst() const;
  Eigen::MatrixXd towards_worst() const;

  const Problem* problem_;
  Criterion criterion_;
  Eigen::MatrixXd covariance_, goal_, far_;  ///< C, B, C B C
};

}  // namespace paracal::detail
