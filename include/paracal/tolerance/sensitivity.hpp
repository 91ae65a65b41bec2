#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "paracal/mechanism/tolerances.hpp"
#include "paracal/tolerance/characteristic.hpp"
#include "paracal/tolerance/workspace_samples.hpp"

namespace paracal {

/// One number a source error, equal for all limbs.
using PerSource = Eigen::Array<double, static_cast<int>(kSourceCount), 1>;

/// Where a source's number stands.
constexpr Eigen::Index place(Source source) { return static_cast<Eigen::Index>(index(source)); }

/// T of every source, mm or rad.
PerSource half_widths(const Tolerances& tolerances);

/// Squared local sensitivities of a characteristic at a pose  [huang2016, Eq. (11)]:
///
///   \f[ mu_k^2 = sum_ij g_ijk^2,    sigma^2 = sum_k mu_k^2 sigma^2(dp_k) \f]
///
/// over limbs i and components j, in the squared unit of the characteristic over that of the source error (mm or rad).
PerSource squared_sensitivities(const SourceRows& rows);

/// Variances of the source errors within their tolerances.
PerSource variances(const Tolerances& tolerances);

/// sigma at a pose: sqrt(sum_k mu_k^2 sigma^2(dp_k)).
double sigma_of(const PerSource& squared_sensitivities, const PerSource& variances);

/// The workspace's mean of the local sensitivities, (1 / V) int mu_k dV  [huang2016, section 3.1].
struct GlobalSensitivity {
  PerSource mean;
  PerSource error;        ///< of the quadrature: change since half as many points in every direction
  PerSource largest;      ///< over the points of the rule
  std::size_t poses = 0;  ///< of the rule
};

struct GlobalSensitivityOptions {
  bool all_rotations = false;    ///< mean over phi or tilts, too; the paper's is at phi = 0
  double relative_error = 1e-3;  ///< refine until every mean has settled to this
  int max_level = 4;             ///< of cylinder_rule(), whatever the error is then
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

/// What a source error (of all limbs together) adds to the variance, as a share of all of it.
struct Contributor {
  Source source = Source::theta_offset;
  double share = 0.0;
};

/// Of the sources that a kind of limb has, largest first; the shares add up to 1. Empty when nothing varies.
std::vector<Contributor> contributors(const SourceRows& rows, const Tolerances& tolerances, Actuator actuator);

/// A map over the workspace: sigma of a characteristic at points of a polar grid  [huang2016, Fig. 6].
std::vector<ValueAtPose> sigma_map(const Robot& robot, Characteristic characteristic, const Tolerances& tolerances,
                                   const PolarGrid& grid, bool all_rotations);

}  // namespace paracal
