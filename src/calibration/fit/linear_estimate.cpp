#include "linear_estimate.hpp"

#include "numerics/dense.hpp"
#include "observation.hpp"
#include "paracal/error.hpp"
#include "sought.hpp"

namespace paracal::detail {
namespace {

/// [J | r] of all readings at the nominal machine.
Eigen::MatrixXd all_rows(Observation& observation) {
  const std::optional<Eigen::VectorXd> start = observation.start({});
  const auto stations = start ? observation.stations(*start) : nullptr;
  if (!stations)
    throw Unreachable("no solution: the nominal machine cannot reach every station with its commanded joints");
  std::vector<Eigen::MatrixXd> blocks(observation.groups().size());
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    observation.rows(observation.groups()[k], *stations, *start, blocks[k]);
    count += blocks[k].rows();
  }
  Eigen::MatrixXd rows(count, observation.unknown_count() + 1);
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd& block : blocks) {
    rows.middleRows(first, block.rows()) = block;
    first += block.rows();
  }
  return rows;
}

}  // namespace

LinearEstimate linear_estimate(const Robot& robot, const Measurements& at_nominal, const CalibrationOptions& options,
                               const std::vector<SoughtSource>& errors) {
  LinearEstimate estimate;
  estimate.sought = all_with_priors(robot, options);
  Observation observation(robot, at_nominal, options, estimate.sought,
                          true);  // the scale with its prior, as the fit does
  const Eigen::MatrixXd rows = all_rows(observation);
  InformationRoot root(observation.unknown_count());
  observation.add_priors(observation.start({}).value(), root);
  root.add(rows);
  const Eigen::MatrixXd covariance = inverse_information(root.root());
  estimate.by_reading = product(covariance, rows.leftCols(observation.unknown_count()).transpose())
                            .bottomRows(observation.source_count());
  Observation asked(robot, at_nominal, options, errors);
  estimate.by_error = estimate.by_reading * all_rows(asked).middleCols(asked.nuisance_count(), asked.source_count());
  return estimate;
}

Eigen::VectorXd weighed_readings(const Robot& robot, const Measurements& readings, const CalibrationOptions& options) {
  Observation observation(robot, readings, options, {});
  return -all_rows(observation).rightCols<1>();
}

}  // namespace paracal::detail
