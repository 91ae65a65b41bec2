#include "paracal/calibration/pose_selection.hpp"

#include <fmt/format.h>

#include <vector>

#include "calibration/fit/observation.hpp"
#include "calibration/fit/sought.hpp"
#include "exchange_poses.hpp"
#include "numerics/dense.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/interruption.hpp"
#include "paracal/numerics/information_root.hpp"

namespace paracal {
namespace {

using detail::Problem;

/// Directions of the errors that are to be found (`all`, or the position group) that all candidates together see.
Eigen::MatrixXd visible_directions(const Problem& problem, const std::vector<SoughtSource>& sought, bool all) {
  constexpr double kRankTolerance = 1e-6;
  const Eigen::Index unknowns = problem.weighted.rows(), sources = problem.scale.size();
  std::vector<Eigen::Index> wanted;
  for (Eigen::Index k = 0; k < sources; ++k) {
    if (all || !tilts_plate(sought[static_cast<std::size_t>(k)].source)) wanted.push_back(unknowns - sources + k);
  }
  const Eigen::Index n = static_cast<Eigen::Index>(wanted.size()), setup = unknowns - sources;
  Eigen::MatrixXd rows(problem.weighted.cols(), setup + n + 1);
  rows << problem.weighted.topRows(setup).transpose(), problem.weighted(wanted, Eigen::all).transpose(),
      Eigen::VectorXd::Zero(rows.rows());
  InformationRoot root(setup + n);
  Eigen::MatrixXd known = Eigen::MatrixXd::Zero(problem.known_setup.rows(), setup + n + 1);
  known.leftCols(setup) = problem.known_setup;
  root.add(known);
  root.add(rows);
  const Spectrum spectrum = analyse(root.root().bottomRightCorner(n, n), kRankTolerance, Eigen::VectorXd::Ones(n));
  const Eigen::MatrixXd whole = detail::orthonormal_basis(spectrum.null_space);
  Eigen::MatrixXd visible = Eigen::MatrixXd::Zero(unknowns, spectrum.rank);
  visible(wanted, Eigen::all) = whole.rightCols(spectrum.rank);
  return visible;
}

Eigen::MatrixXd known_of_set_up(const detail::Observation& observation, const Eigen::VectorXd& unknowns) {
  InformationRoot known(observation.unknown_count());
  observation.add_set_up_priors(unknowns, known);
  const Eigen::Index n = observation.nuisance_count();
  return known.root().topLeftCorner(n, n);
}

Problem make_problem(const Robot& robot, const std::vector<Station>& candidates, const SelectionOptions& options) {
  CalibrationOptions calibration;
  calibration.noise = options.noise;
  calibration.tolerances = options.tolerances;
  calibration.reflectors = options.readings.mount;
  calibration.rotation_zero = options.rotation_zero;
  const Measurements plan = planned(robot, candidates, options.readings);
  detail::Observation observation(robot, plan, calibration, detail::all_with_priors(robot, calibration), true);
  const auto unknowns = observation.start({});
  const auto stations = unknowns ? observation.stations(*unknowns) : nullptr;
  if (!stations) throw Unreachable("no solution: the nominal machine cannot reach a candidate pose");

  const Eigen::Index n = observation.unknown_count();
  Problem problem;
  // The set-up has no priors as a rule: units that say little beside readings of hundredths of a mm keep the updates of
  // C well-conditioned.
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(n);
  for (const auto& series : observation.series()) series->set_units(unit);
  for (std::size_t k = 0; k < observation.sought().size(); ++k) {
    unit(observation.nuisance_count() + static_cast<Eigen::Index>(k)) = observation.sought()[k].prior_std.value_or(1.0);
  }
  for (const Eigen::Index scale : observation.scale_columns()) unit(scale) = calibration.scale_std;
  problem.known_setup = known_of_set_up(observation, *unknowns) * unit.head(observation.nuisance_count()).asDiagonal();
  problem.scale = unit.tail(observation.source_count());
  Eigen::MatrixXd block;
  for (const detail::Group& group : observation.groups()) {  // one a candidate; home has none of its own distance
    let_interrupt();
    observation.rows(group, *stations, *unknowns, block);
    if (problem.rows == 0) {
      problem.rows = static_cast<int>(block.rows());
      problem.weighted.setZero(n, problem.rows * static_cast<Eigen::Index>(candidates.size()));
    }
    auto columns = problem.weighted.middleCols(problem.rows * static_cast<Eigen::Index>(group.station), problem.rows);
    columns = unit.asDiagonal() * block.leftCols(n).transpose();
  }
  const bool all =
      options.readings.second || options.readings.measurand == Measurand::poses || !observation.robot().is_level();
  problem.visible = visible_directions(problem, observation.sought(), all);
  return problem;
}

/// B of the criterion; the worst direction sets its own as it goes.
Eigen::MatrixXd goal_of(const Robot& robot, const SelectionOptions& options, const Problem& problem,
                        const PoseSpread& spread) {
  if (options.criterion != Criterion::pose_uncertainty) return problem.visible * problem.visible.transpose();
  const double lever = robot.slide() ? robot.slide()->pinion_radius : 0.0;
  const Eigen::Index unknowns = problem.weighted.rows(), n = problem.scale.size();
  Eigen::MatrixXd goal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  goal.bottomRightCorner(n, n) = problem.scale.asDiagonal() * spread.mean_square(lever) * problem.scale.asDiagonal();
  return goal;
}

}  // namespace

Selection select_stations(const Robot& robot, const std::vector<Station>& candidates, const SelectionOptions& options) {
  if (options.poses < 2 || candidates.size() < static_cast<std::size_t>(options.poses)) {
    throw InvalidArgument(
        fmt::format("pose selection: expected 2 to {} poses, got {}", candidates.size(), options.poses));
  }
  if (options.readings.measurand == Measurand::distances) {
    throw InvalidArgument("pose selection: expected one reading per pose, got distances of all pairs");
  }
  Problem problem = make_problem(robot, candidates, options);
  CalibrationOptions calibration;
  calibration.tolerances = options.tolerances;
  const PoseSpread spread(robot, {}, detail::all_with_priors(robot, calibration), workspace_stations(robot));
  problem.goal = goal_of(robot, options, problem, spread);
  // Points alone are the usual case; a size of its own for every other would take minutes to compile.
  if (problem.rows == 3) return detail::exchange_poses<3>(robot, candidates, options, problem, spread);
  return detail::exchange_poses<Eigen::Dynamic>(robot, candidates, options, problem, spread);
}

}  // namespace paracal
