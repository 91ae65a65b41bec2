#pragma once

#include <vector>

#include "paracal/tolerance/sensitivity.hpp"

namespace paracal {

enum class Spread : std::uint8_t {
  statistical,  ///< 3 sigma, root sum of squares  [huang2016, Eq. (11)]
  worst_case,   ///< all parts at the worst limits of their tolerances
  yield,        ///< at most the failure rate that the problem states
};

/// A limit for the whole workspace.
struct Requirement {
  Characteristic characteristic = {};
  double limit = 1e-3;  ///< mm or rad
  Spread criterion = Spread::statistical;
  bool is_in_degrees = false;  ///< as a file stated the limit: texts say it so
};

/// The characteristics of requirements.
std::vector<Characteristic> characteristics_of(const std::vector<Requirement>& requirements);

/// "statistical", "worst-case", "yield".
std::string_view name(Spread criterion);

/// Worst case at a pose of parts within their tolerances, and its direction.
///
///   \f[ max_{|dp_k| \le T_k} |rows dp| = max_{|n| = 1} sum_k |n . g_k| T_k \f]
///
/// Exact for one and two components (all vertices of the zonotope are visited); for three, refined from the best of
/// many directions.
struct WorstCase {
  double value = 0.0;         ///< mm or rad
  Eigen::Vector3d direction;  ///< n, in the components of the characteristic; zeros beyond them
};
WorstCase worst_case(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances);

/// Weights of the tolerances in that direction: value = sum_k weight_k T_k, w_k = sum over limbs |n . g_ik|.
PerSource worst_case_weights(const Robot& robot, const SourceRows& rows, const Eigen::Vector3d& direction);

/// The worst case at a pose, or 3 sigma.
double spread_at(const Robot& robot, const SourceRows& rows, const Tolerances& tolerances, Spread criterion);

/// The pose of the workspace where this is largest.
ValueAtPose worst_spread(const Robot& robot, Characteristic characteristic, const Tolerances& tolerances,
                         Spread criterion);

}  // namespace paracal
