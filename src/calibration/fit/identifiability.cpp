#include "paracal/calibration/identifiability.hpp"

#include <algorithm>
#include <cmath>

#include "null_space.hpp"
#include "observation.hpp"
#include "paracal/error.hpp"
#include "sought.hpp"
#include "started.hpp"

namespace paracal {
namespace {

std::vector<SoughtSource> default_sought(const Robot& robot, const Measurements& plan,
                                         const CalibrationOptions& options) {
  const bool tilt = std::ranges::any_of(plan.series, [](const PointSeries& series) {
    return std::ranges::any_of(series.readings,
                               [](const PointReading& reading) { return reading.second || reading.orientation; });
  });
  return tilt ? detail::all_with_priors(robot, options) : detail::position_group(robot, options);
}

}  // namespace

Observability observability(const Eigen::VectorXd& singular_values, int rank, Eigen::Index rows) {
  if (rank == 0) return {};
  const Eigen::ArrayXd s = singular_values.head(rank);
  const double largest = s(0), smallest = s(rank - 1);
  return {std::exp(s.log().mean()) / std::sqrt(static_cast<double>(rows)), smallest / largest, smallest,
          smallest * smallest / largest, 1.0 / s.inverse().sum()};
}

Identifiability identifiability(const Robot& robot, const Measurements& plan, const CalibrationOptions& options,
                                std::vector<SoughtSource> errors) {
  check(plan, robot.limb_count());
  if (errors.empty()) errors = default_sought(robot, plan, options);
  detail::Observation observation(robot, plan, options, errors);
  const auto start = observation.start({});
  InformationRoot root(observation.unknown_count());
  if (start) observation.add_set_up_priors(*start, root);
  const Eigen::Index known = root.row_count();
  if (!start || !observation(*start, root)) throw detail::not_closed(robot, robot.nominal(), plan.stations);
  const Eigen::Index n = observation.source_count();
  // Nuisance comes first, so this block is what remains when it has been projected out.
  const Spectrum spectrum =
      analyse(root.root().bottomRightCorner(n, n), detail::kRankTolerance, detail::paper_scales(robot, errors));
  Identifiability result{std::move(errors),        spectrum.singular_values,    spectrum.rank, {}, {},
                         root.row_count() - known, observation.nuisance_count()};
  result.null_space = detail::in_words(robot, spectrum.null_space, result.parameters);
  result.indices = observability(spectrum.singular_values, spectrum.rank, result.rows);
  return result;
}

}  // namespace paracal
