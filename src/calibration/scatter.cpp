#include "scatter.hpp"

#include <array>
#include <map>

namespace paracal::detail {
namespace {

/// Rows of repeated readings, by station and series.
using Visits = std::map<std::array<std::uint32_t, 2>, std::vector<Eigen::VectorXd>>;

Visits repeated_visits(const Observation& observation, const Eigen::VectorXd& unknowns) {
  Visits visits;
  const auto states = observation.stations(unknowns);
  if (!states) return visits;
  Eigen::MatrixXd block;
  for (const Group& group : observation.groups()) {
    if (!group.active || group.is_relative()) continue;
    observation.rows(group, *states, unknowns, block);
    visits[{group.station, group.series}].push_back(block.col(observation.unknown_count()));
  }
  return visits;
}

}  // namespace

Scatter scatter_of_visits(const Observation& observation, const Eigen::VectorXd& unknowns) {
  Scatter scatter;
  for (const auto& [place, visits] : repeated_visits(observation, unknowns)) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(visits.front().size());
    std::size_t alike = 0;
    for (const Eigen::VectorXd& one : visits) {
      if (one.size() == mean.size()) mean += (one - mean) / static_cast<double>(++alike);
    }
    for (const Eigen::VectorXd& one : visits) {
      if (one.size() == mean.size()) scatter.sum += (one - mean).squaredNorm();
    }
    scatter.redundancy += static_cast<double>(alike - 1) * static_cast<double>(mean.size());
  }
  return scatter;
}

}  // namespace paracal::detail
