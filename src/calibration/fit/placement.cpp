#include "placement.hpp"

#include "paracal/error.hpp"
#include "started.hpp"

namespace paracal::detail {

CalibrationOptions as_for_a_fit(const ValidationOptions& options) {
  CalibrationOptions fit;
  fit.noise = options.noise;
  fit.noise_is_known = options.noise_is_known;
  fit.frame = options.frame;
  fit.body = options.body;
  fit.rotation_zero = options.rotation_zero;
  fit.reflectors = options.reflectors;
  fit.scale_std = options.scale_std;
  return fit;
}

Placement::Placement(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
                     const SourceErrors& errors)
    : observation(robot, measurements, options, {}) {
  const auto start = observation.start(errors);
  if (!start) throw not_closed(robot, build(robot, errors), measurements.stations);
  setup = *start;
  if (setup.size() > 0) setup = solve_least_squares(with_priors(observation), *start).parameters;
  stations = observation.stations(setup);
}

PoseErrorSummary Placement::summary() const {
  ErrorTally tally, points;
  for (std::size_t s = 0; s < observation.series().size(); ++s) {
    const ReadingSeries& series = *observation.series()[s];
    const bool of_points = series.quantity() == Quantity::coordinate;
    series.add_to(of_points ? points : tally, observation.groups_of(s), placed());
  }
  PoseErrorSummary all = tally.finished();
  all.max_orientation = points.summary.max_orientation;
  return all;
}

}  // namespace paracal::detail
