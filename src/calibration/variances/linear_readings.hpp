#pragma once

// Private to calibration: all readings of a fit as one linear model of what the machine and its set-up may be.

#include <Eigen/Core>
#include <vector>

#include "reading_blocks.hpp"

namespace paracal::detail {

/// How drives may be uneven, f(q) = sum b_k B((q - centre_k) / spacing): Gaussian, of variance 1 and with a correlation
/// exp(-(q - q')^2 / (2 length^2)) to what is left out of the splines. A B-spline spreads what it multiplies like a
/// Gaussian of variance spacing^2 / 3, so that numbers b with
///
///   cov(b_j, b_k) = length / narrow exp(-(c_j - c_k)^2 / (2 narrow^2)),   narrow^2 = length^2 - 2 spacing^2 / 3
///
/// have that correlation.
struct DriveSplines {
  std::vector<SoughtSource> knots;
  Eigen::MatrixXd covariance;  ///< of b
};

/// Over the joints of the workspace and of the stations that were measured.
/// @param length  as a share of each joint's stroke.
DriveSplines drive_splines(const Robot& robot, const std::vector<Station>& stations, double length);

/// y = S a + X x + A (joints that are off) + noise, each divided by the standard deviations with which it entered: a
/// the set-up, x errors of parts and the splines of the drives.
struct LinearReadings {
  Eigen::VectorXd y = {};
  Eigen::MatrixXd by_set_up = {}, by_errors = {};  ///< S, X
  Eigen::MatrixXd set_up_root = {};                ///< R, |R a + q|^2: what is known of the set-up beforehand
  Eigen::VectorXd set_up_reach = {};               ///< q
  Eigen::VectorXd fitted = {};                     ///< errors of parts from their expectation, as the fit has them
  Eigen::MatrixXd prior = {};                      ///< of errors of parts, covariance
  double joint_per_mm = 0.0;                       ///< standard deviation of every joint that moves the plate by 1 mm
  std::vector<ReadingBlock> blocks = {};           ///< without their rows
  std::vector<Eigen::Index> first = {};            ///< row of each
};

/// By the splines of the drives, as by the joints where they are: rows of a block.
Eigen::MatrixXd by_drives(const ReadingBlock& block, const std::vector<Joints>& joints,
                          const std::vector<SoughtSource>& knots);

/// @param stride  of the places that are taken.
LinearReadings linear_readings(const StageFit& fit, const ReadingPlaces& places, std::size_t stride,
                               const DriveSplines& drives);

/// What the joints do to some of the readings.
struct ByJoints {
  std::vector<Eigen::Index> rows;
  Eigen::MatrixXd by_joint;  ///< a row of each of these

  void add(Eigen::Index first, const Eigen::MatrixXd& more);
};

/// At each visit by itself, as their mean.
std::vector<ByJoints> by_visits(const LinearReadings& all);
/// At each pose that is read here: of very many poses these are few.
std::vector<ByJoints> by_poses(const LinearReadings& all);

}  // namespace paracal::detail
