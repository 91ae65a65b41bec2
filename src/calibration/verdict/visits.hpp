#pragma once

// Private to calibration: what repeated visits of a pose say of the noise, and how sure their means are.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/scatter.hpp"
#include "paracal/calibration/validation.hpp"

namespace paracal::detail {

/// How many times as large a noise is as it is taken for, and by how many degrees of freedom that is told.
struct NoiseOfVisits {
  double factor = 1.0;
  double dof = std::numeric_limits<double>::infinity();  ///< infinite: believed as stated
};

/// Visits decide where nobody stated the noise, or where they contradict what was stated (one in a thousand).
/// @param visits  squares over the noise as it is taken, and their degrees of freedom.
/// @returns empty where nothing tells it: neither stated nor seen in three degrees of freedom.
std::optional<NoiseOfVisits> noise_of_visits(const Scatter& visits, bool stated);

/// Standard uncertainty of a coordinate, and by how many degrees of freedom it is known  [gum].
struct Uncertainty {
  double standard = 0.0;
  double dof = std::numeric_limits<double>::infinity();

  double coverage() const { return coverage_factor(dof); }
  double expanded() const { return coverage() * standard; }
  /// What all of `count` errors of so many coordinates keep at once, as probably as one of a coordinate keeps 2 of its
  /// standard uncertainty, whatever they have in common  [royen2014].
  double expanded_of_all(std::size_t count, double coordinates) const;
  /// Of what varies so many times as much.
  Uncertainty times(double factor) const { return {factor * standard, dof}; }
  /// With another part, known as it is stated  [gum, G.4].
  Uncertainty with(double other) const;
};

/// The one whose expanded uncertainty is larger.
inline Uncertainty larger(const Uncertainty& one, const Uncertainty& other) {
  return one.expanded() < other.expanded() ? other : one;
}

/// Of the means of a station's n visits, largest over the stations: a coordinate of a point, mm, and a rotation or an
/// orientation about each axis, rad:
///
///   u = factor s / sqrt(n),   k = t(dof),   s as readings, instrument or options state it
///
/// with the factor and its degrees of freedom from the visits of all stations (noise_of_visits), for lengths and angles
/// apart. Where nothing tells a noise its default is taken, and a note says so (of rotations where they are judged).
struct MeansOfVisits {
  Uncertainty point, rotation;
  std::vector<std::string> notes;
};
MeansOfVisits means_of_visits(const Measurements& measurements, const ValidationOptions& options);

}  // namespace paracal::detail
