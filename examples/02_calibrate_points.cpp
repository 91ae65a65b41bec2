// Simulates a calibration before the measurement: selects poses, draws a machine from the tolerances, simulates tracker
// measurements in an unknown frame, calibrates, predicts a pose, and validates on other poses.

#include <cmath>
#include <cstdio>
#include <paracal/calibration/plan.hpp>
#include <paracal/calibration/pose_selection.hpp>
#include <paracal/calibration/simulation.hpp>
#include <paracal/calibration/validation.hpp>
#include <paracal/paracal.hpp>

using namespace paracal;

int main() {
  const Robot robot = catalogue::huang2016();
  const Selection plan = select_stations(robot, candidate_stations(robot, 2000, 1), {.poses = 20});
  std::printf("plan: %zu poses, uncertainty over the workspace: distances to home below %.3f mm (U, k = 2)\n",
              plan.stations.size(), kCoverageFactor * plan.uncertainty.max_distance);

  RandomStream random(7);
  const SourceErrors truth = draw_errors(robot, *robot.tolerances(), random);
  VirtualInstrument tracker{.noise = 0.017, .repeats = 3};  // mm per coordinate
  tracker.frame.translation = {2500, -800, 300};            // unknown to the fit
  const Calibration calibration = calibrate(robot, simulate(robot, truth, plan.stations, tracker, random));
  std::printf("calibration: %s, noise %.3f mm\n", name(calibration.verdict).data(), calibration.noise);
  if (!calibration.accepted()) return 1;

  const KnownErrors known = known_errors(calibration);
  const Station home = plan.stations.front(), target{"target", {.position = {200, -130, -930}, .rotation = 0.5}};
  const PredictedPose predicted = predict(robot, known, believed_joints(robot, target));
  const PredictedPose at_home = predict(robot, known, believed_joints(robot, home));
  const PoseSpread spread(robot, known.errors, known.parameters, {home, target});
  std::printf("target: x %.3f mm, U %.3f mm; distance to home %.3f mm, U %.3f mm\n", predicted.pose.position.x(),
              kCoverageFactor * std::sqrt(predicted.covariance(0, 0)),
              (predicted.pose.position - at_home.pose.position).norm(),
              kCoverageFactor * spread.uncertainty(known.expanded_covariance()).max_distance);

  const Measurements unseen = simulate(robot, truth, validation_stations(robot), tracker, random);
  const Validation validation = validate(robot, known, unseen, {.limits = {.distance = 0.1}});
  std::printf("validation: largest error of distances to home %.3f mm before, %.3f mm after; limit 0.1 mm: %s\n",
              validation.before.max_abs_distance, validation.after.max_abs_distance,
              name(validation.checks.front().conformity).data());
  return validation.accepted.value_or(false) ? 0 : 1;
}
