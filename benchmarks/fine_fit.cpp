#include "fine_fit.hpp"

#include <Eigen/Geometry>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::benchmark {
namespace {

constexpr double kNoise = 0.017;  // mm a coordinate
constexpr int kCircle = 9;        // stations on each of the two rims
constexpr std::uint64_t kSeed = 1;

RigidMotion somewhere() {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.1, -0.2, 0.97).normalized();
  return {Eigen::AngleAxisd(2.1, axis).toRotationMatrix(), {1800.0, -1200.0, 400.0}};
}

Measurements measure(const Robot& robot, std::uint64_t machine) {
  RandomStream random(kSeed, machine);
  const SourceErrors errors = draw_errors(robot, *robot.tolerances(), random);
  const VirtualInstrument instrument{.noise = kNoise, .frame = somewhere()};
  Measurements measurements = simulate(robot, errors, fine_stations(robot, kCircle), instrument, random);
  for (PointReading& reading : measurements.series.front().readings) reading.sigma = kNoise;
  return measurements;
}

std::vector<Eigen::Vector3d> plate_centres(const FineFit& fit, const SourceErrors& errors) {
  const Machine machine = build(fit.robot, errors);
  std::vector<Eigen::Vector3d> centres;
  for (const Joints& joints : fit.joints) centres.push_back(forward(machine, joints).plate.position);
  return centres;
}

Eigen::VectorXd prior_std_of(const Robot& robot) {
  Eigen::VectorXd std(kSources);
  for (Eigen::Index k = 0; k < kSources; ++k) {
    std(k) = robot.tolerances()->std(
        sources_of(Actuator::revolute)[static_cast<std::size_t>(k) % sources_of(Actuator::revolute).size()]);
  }
  return std;
}

}  // namespace

FineFit make_fine_fit(std::uint64_t machine) {
  const Robot robot = catalogue::huang2016();
  FineFit fit{.robot = robot,
              .measurements = measure(robot, machine),
              .joints = {},
              .points = {},
              .sigma = kNoise,
              .prior_std = prior_std_of(robot),
              .start = {},
              .frame = {}};
  for (const PointReading& reading : fit.measurements.series.front().readings) {
    fit.joints.push_back(believed_joints(robot, fit.measurements.stations[reading.station]));
    fit.points.push_back(reading.point);
  }
  fit.start = calibrate(robot, fit.measurements, {.stage = Stage::rough}).errors();
  fit.frame = robust_rigid_fit(plate_centres(fit, fit.start), fit.points);
  return fit;
}

double squared_residuals(const FineFit& fit, const FineAnswer& answer) {
  const std::vector<Eigen::Vector3d> centres = plate_centres(fit, answer.errors);
  double sum = 0.0;
  for (std::size_t k = 0; k < centres.size(); ++k) {
    sum += (answer.frame(centres[k]) - fit.points[k]).squaredNorm() / (fit.sigma * fit.sigma);
  }
  for (std::size_t k = 0; k < kSources; ++k) {
    const double error = answer.errors(k / sources_of(Actuator::revolute).size(),
                                       sources_of(Actuator::revolute)[k % sources_of(Actuator::revolute).size()]);
    sum += std::pow(error / fit.prior_std(static_cast<Eigen::Index>(k)), 2);
  }
  return sum;
}

}  // namespace paracal::benchmark
