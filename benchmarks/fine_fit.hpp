#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/numerics/rigid_fit.hpp"

namespace paracal::benchmark {

/// Source errors of huang2016: 14 of each of 4 limbs.
inline constexpr Eigen::Index kSources = 56;
/// Unknowns of a frame: a turn w (rad) and a shift t (mm), instrument = exp([w]) Q_0 robot + t.
inline constexpr Eigen::Index kFrame = 6;

/// The least-squares problem of a fine calibration, with a start, written out for any solver:
///
///   min over p, w, t of  sum_k |(exp([w]) Q_0 r_k(p) + t - point_k) / sigma|^2 + sum_j (p_j / prior_std_j)^2,
///
/// r_k: exact plate centre at the joints that the controller believed at station k.
struct FineFit {
  Robot robot;
  Measurements measurements;  ///< as calibrate() takes them
  std::vector<Joints> joints;
  std::vector<Eigen::Vector3d> points;
  double sigma = 0.0;
  Eigen::VectorXd prior_std;
  SourceErrors start;  ///< encoder offsets as the rough stage finds them; all others zero
  RigidMotion frame;   ///< fits best (robustly) at the start; its rotation is Q_0
};

/// An answer of any solver.
struct FineAnswer {
  SourceErrors errors;
  RigidMotion frame;
  int iterations = 0;
};

/// Machine m of the batch that the tolerances of huang2016 allow, measured with 0.017 mm a coordinate at home and 18
/// fine stations by an instrument that stands somewhere.
FineFit make_fine_fit(std::uint64_t machine);

/// The sum that is to be made small, formed for all solvers by the same few lines.
double squared_residuals(const FineFit& fit, const FineAnswer& answer);

}  // namespace paracal::benchmark
