#pragma once

// Private to batch: thousands of machines to first order, in the time of one.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "paracal/batch/production.hpp"

namespace paracal {

/// What a customer gets of many machines at once, to first order: errors drawn, readings, fit, compensation and
/// validation as one chain of matrices. With the standard normal numbers z of a machine, its errors e(z) and
///
///   left = e - found = (I - C J_s^T J) e - C J_s^T D z,        (LinearEstimate; D: what readings do with z)
///
/// poses before and after compensation are off by G e and G left; a plate that stays level keeps the tilt of e.
/// It knows nothing of calibrations that are rejected, of readings left out and of poses that cannot be taken.
class Surrogate {
 public:
  /// Of the fit of all errors under their priors: method best, fine stage.
  /// @param plan  settled(). @throws InvalidArgument for a plan that calibrates otherwise, Unreachable as settled().
  Surrogate(const Robot& robot, const ProductionPlan& plan);
  /// Whether a plan calibrates as a surrogate does.
  static bool follows(const ProductionPlan& plan);

  /// A machine's, counted.
  double multiplications() const;

  struct Values {
    Accuracy before, after;
  };
  /// Machines first, first + 1, ..., as produce() makes them of the seed.
  std::vector<Values> machines(std::uint64_t seed, std::uint64_t first, std::uint64_t count) const;

 private:
  using Block = Eigen::MatrixXd;  ///< a column a machine

  void ask_readings(const Robot& robot, const ProductionPlan& plan);
  void ask_validation(const Robot& robot, const std::vector<Station>& validation);
  Block drawn_normals(std::uint64_t seed, std::uint64_t first, Eigen::Index count) const;
  Block drawn_errors(const Block& normals, std::uint64_t seed, std::uint64_t first) const;
  void look(const Block& off, Values* machines, Accuracy Values::*when) const;
  void look_at_tilt(const Block& off, Values* machines, Accuracy Values::*when) const;

  Tolerances tolerances_;
  std::uint64_t reserved_ = 0;        ///< so many numbers of a stream draw errors; noise follows
  std::vector<SoughtSource> errors_;  ///< that vary
  Eigen::MatrixXd left_by_error_, left_by_normal_;
  /// Rows of every pose by the errors: x of all poses, y of all, z of all; how far the plate is turned likewise.
  Eigen::MatrixXd position_, rotation_, tilt_;
  bool stays_level_ = true;
  Eigen::Matrix3Xd directions_;           ///< from home to each pose, mm
  Eigen::MatrixXd motions_, motion_fit_;  ///< what rigid motions do to x, y, z of all poses, and the motion that fits
};

}  // namespace paracal
