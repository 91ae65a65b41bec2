#include "guided_scatter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "numerics/distributions.hpp"

namespace paracal::detail {
namespace {

/// The points of a series at one pose: sum of the weights, and of the weighted residuals.
struct Mean {
  double weight = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
};

/// Weighted squares of the means of poses, across the plane and within it.
struct Squares {
  double across = 0.0, within = 0.0, weight = 0.0;
  double poses = 0.0, series = 0.0;

  void add(const std::map<std::size_t, Mean>& means) {
    for (const auto& [station, one] : means) {
      across += one.sum.z() * one.sum.z() / one.weight;
      within += one.sum.head<2>().squaredNorm() / one.weight;
      weight += one.weight;
    }
    poses += static_cast<double>(means.size());
    series += means.empty() ? 0.0 : 1.0;
  }
};

Squares squares_of(const Observation& observation, const Placed& at) {
  Squares squares;
  for (std::size_t s = 0; s < observation.series().size(); ++s) {
    std::map<std::size_t, Mean> means;
    for (const Group& group : observation.groups_of(s)) {
      const Residual off = observation.residual(group, at);
      if (!group.active || off.length.size() != 3) continue;
      const double weight = std::pow(observation.sigma_of(group), -2);
      Mean& mean = means[group.station];
      mean.weight += weight;
      mean.sum += weight * off.length;
    }
    squares.add(means);
  }
  return squares;
}

}  // namespace

std::optional<std::string> scatter_across_guides(const Observation& observation, const Placed& at, double found,
                                                 double tell_chance) {
  constexpr double kFewest = 3.0, kSeen = 1e-6;  // degrees of freedom, mm
  const Robot& robot = observation.robot();
  if (!robot.nominal().has_guides || !robot.freedoms().holds_z()) return std::nullopt;
  const Squares squares = squares_of(observation, at);
  const double across = squares.poses - 3.0 * squares.series;
  const double within = 2.0 * squares.poses - found - 3.0 * squares.series;
  if (across < kFewest || within < kFewest) return std::nullopt;
  const double of_across = squares.across / across, of_within = squares.within / within;
  const double mm = std::sqrt(squares.poses / squares.weight);  // a typical standard deviation of a pose's mean
  if (!(mm * std::sqrt(of_across) > kSeen) || !(of_within > 0.0)) return std::nullopt;
  if (fisher_tail(of_across / of_within, across, within) >= tell_chance) return std::nullopt;
  return fmt::format(
      "points scatter {:.3g} mm across the plane of the guides, {:.3g} mm in it. Check the flatness of the "
      "guides and the instrument. U is valid in the plane only",
      mm * std::sqrt(of_across), mm * std::sqrt(of_within));
}

}  // namespace paracal::detail
