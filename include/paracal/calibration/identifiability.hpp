#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"

namespace paracal {

/// Observability indices of an identification Jacobian with m rows and singular values s_1 >= ... >= s_r > 0, all
/// null directions omitted  [sun-hollerbach2008; huang2016, Eq. (18)]:
///
///   \f[ O_1 = (s_1 ... s_r)^{1/r} / \sqrt{m},   O_2 = s_r / s_1,   O_3 = s_r
///       O_4 = s_r^2 / s_1,   O_5 = 1 / (1/s_1 + ... + 1/s_r) \f]
struct Observability {
  double O1 = 0.0, O2 = 0.0, O3 = 0.0, O4 = 0.0, O5 = 0.0;
};

Observability observability(const Eigen::VectorXd& singular_values, int rank, Eigen::Index rows);

/// A rigid motion of the robot, or of the slide zero, as geometric errors: readings may not determine it.
struct GaugeMotion {
  std::string text;
  SourceErrors direction;  ///< to first order, per mm or per rad
};

/// For every robot:
///
///   translation along k    e_i = k                               the base moved
///   rotation w             turned_base(w): e_i = w x (b_i - a_i), alpha0 = w.u0, ...  (mechanism/base_motion.hpp)
///   slide zero             e_i = mu_i shat                       r stays, s changes by a constant (-1 mm per mm)
///   a rail along itself    e_i = v1, theta_offset = -1           of one that leans
///   a rail about itself    alpha0 = 1, e_i = L u0 x u1           of one that leans by 90 deg, where v1 = -u0
///
/// A rotation does not turn the slide axis, so only that about the slide axis (any, for a rigid plate) stays open.
std::vector<GaugeMotion> gauge_motions(const Robot& robot);

/// What readings at the nominal machine determine of the geometric errors. Only where and how they are taken counts,
/// not their values.
struct [[nodiscard]] Identifiability {
  std::vector<SoughtSource> parameters;
  Eigen::VectorXd singular_values;  ///< columns scaled as in [huang2016, Eq. (4)]: L theta_offset, ..., mm
  int rank = 0;
  std::vector<NullDirection> null_space;
  Observability indices;
  Eigen::Index rows = 0;
  Eigen::Index nuisance = 0;  ///< unknowns of frames, encoder zeros, second reflectors and bodies
};

/// Frame, encoder zero, second reflector and body are projected out first (they are estimated with the errors).
/// @param errors  to be estimated; empty: the position group, and the tilt group where second reflectors or
/// orientations are read.
/// @throws Unreachable, InvalidArgument as calibrate().
Identifiability identifiability(const Robot& robot, const Measurements& plan, const CalibrationOptions& options = {},
                                std::vector<SoughtSource> errors = {});

}  // namespace paracal
