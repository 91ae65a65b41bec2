#include "scatter.hpp"

#include <map>

namespace paracal::detail {
namespace {

/// Rows of the readings of one station and series.
using VisitMeans = std::vector<Eigen::VectorXd>;

void add_visits(const VisitMeans& visits, Scatter& scatter) {
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

}  // namespace

Scatter scatter_at_answer(const Observation& observation, const Eigen::VectorXd& unknowns,
                          const InformationRoot& at_answer) {
  InformationRoot priors(observation.unknown_count());
  observation.add_priors(unknowns, priors);
  const auto rows = static_cast<double>(at_answer.row_count() - priors.row_count());
  const Eigen::MatrixXd known = priors.root();
  const Eigen::MatrixXd hat = at_answer.root().triangularView<Eigen::Upper>().transpose().solve(known.transpose());
  const double seen = static_cast<double>(known.rows()) - hat.squaredNorm();
  return {at_answer.squared_residuals() - priors.squared_residuals(), rows - seen};
}

Scatter scatter_of_visits(const Observation& observation, const Eigen::VectorXd& unknowns) {
  Scatter scatter;
  const auto states = observation.stations(unknowns);
  if (!states) return scatter;
  Eigen::MatrixXd block;
  for (const std::vector<std::uint32_t>& places : observation.groups_of_stations()) {
    if (places.size() < 2) continue;
    std::map<std::uint32_t, VisitMeans> by_series;
    for (const std::uint32_t g : places) {
      const Group& group = observation.groups()[g];
      if (!group.active) continue;
      observation.rows(group, *states, unknowns, block);
      by_series[group.series].emplace_back(block.col(observation.unknown_count()));
    }
    for (const auto& [series, visits] : by_series) add_visits(visits, scatter);
  }
  return scatter;
}

}  // namespace paracal::detail
