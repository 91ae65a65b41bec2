#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "paracal/mechanism/tolerances.hpp"
#include "paracal/tolerance/characteristic.hpp"
#include "paracal/tolerance/workspace_samples.hpp"

namespace paracal {

/// One number per geometric error, equal for all limbs; zero where no limb has it.
using PerSource = Eigen::Array<double, static_cast<int>(kSourceNames), 1>;

/// Its place.
constexpr Eigen::Index place(Source source) { return static_cast<Eigen::Index>(index(source)); }

/// T of every geometric error, mm or rad.
PerSource half_widths(const Tolerances& tolerances);

/// Squared local sensitivities of a characteristic at a pose  [huang2016, Eq. (11)]:
///
///   \f[ mu_k^2 = sum_ij g_ijk^2,    sigma^2 = sum_k mu_k^2 sigma^2(dp_k) \f]
///
/// over limbs i and components j; unit: (unit of the characteristic / unit of the error)^2.
PerSource squared_sensitivities(const Robot& robot, const SourceRows& rows);

/// Variances of the geometric errors within their tolerances.
PerSource variances(const Tolerances& tolerances);

/// sigma at a pose: sqrt(sum_k mu_k^2 sigma^2(dp_k)).
double sigma_of(const PerSource& squared_sensitivities, const PerSource& variances);

/// The workspace's mean of the local sensitivities, (1 / V) int mu_k dV  [huang2016, section 3.1].
struct GlobalSensitivity {
  PerSource mean;
  PerSource error;        ///< of the quadrature: change from half as many points in every direction
  PerSource largest;      ///< over the points of the rule
  std::size_t poses = 0;  ///< of the rule
};

struct GlobalSensitivityOptions {
  bool all_rotations = false;    ///< also mean over phi or tilts; the paper uses phi = 0
  double relative_error = 1e-3;  ///< refine until every mean changes by less than this
  int max_level = 4;             ///< of volume_rule(); the largest refinement
};

GlobalSensitivity global_sensitivity(const Robot& robot, Characteristic characteristic,
                                     const GlobalSensitivityOptions& options = {});

/// The same over given points, e.g. the Cartesian grid that reproduces [huang2016, Table 2]; no error is stated.
GlobalSensitivity mean_sensitivity(const Robot& robot, Characteristic characteristic,
                                   const std::vector<WeightedPose>& points);

/// Size of the paper's unit of a source error in mm or rad: c for rod and width differences, whose dp_e is over c, and
/// 1 for the rest. A sensitivity times it is the paper's.
PerSource paper_units(const Robot& robot);

/// A pose of the workspace and the value of something there.
struct ValueAtPose {
  Pose pose;
  double value = 0.0;  ///< mm or rad
};

/// Contribution of a geometric error (all limbs together) to the variance, as a fraction.
struct Contributor {
  Source source = "theta_offset";
  double share = 0.0;
};

/// Of the errors of a robot, largest first; the sum is 1. Empty if the variance is zero.
std::vector<Contributor> contributors(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances);

/// A map over the workspace: sigma of a characteristic at points of a polar grid  [huang2016, Fig. 6].
std::vector<ValueAtPose> sigma_map(const Robot& robot, Characteristic characteristic, const Tolerances& tolerances,
                                   const PolarGrid& grid, bool all_rotations);

}  // namespace paracal
