#include "support/virtual_machines.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "paracal/calibration/plan.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/base_motion.hpp"

namespace paracal::test {
namespace {

/// Streams of machines and of noise are kept apart.
constexpr std::uint64_t kMachines = 1, kNoise = 2;

RigidMotion some_frame() {
  return {Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix(), {1500, -2500, 800}};
}

}  // namespace

bool every_machine() {
  static const bool kEvery = std::getenv("PARACAL_EVERY_MACHINE") != nullptr;
  return kEvery;
}

int machines(const Machines& wanted) { return every_machine() ? wanted.claim : wanted.quick; }

double looser(const Machines& wanted) {
  return std::sqrt(static_cast<double>(wanted.claim) / static_cast<double>(machines(wanted)));
}

Measurements measure(const Robot& robot, const SourceErrors& errors, const std::vector<Station>& stations, int number,
                     VirtualInstrument instrument) {
  RandomStream noise(kNoise, static_cast<std::uint64_t>(number));
  instrument.frame = some_frame();
  return simulate(robot, errors, stations, instrument, noise);
}

MeasuredMachine measured_machine(const Robot& robot, const std::vector<Station>& stations, int number,
                                 VirtualInstrument instrument) {
  RandomStream machine(kMachines, static_cast<std::uint64_t>(number));
  const SourceErrors errors = draw_errors(robot, *robot.tolerances(), machine);
  return {errors, measure(robot, errors, stations, number, std::move(instrument))};
}

Measurements body_poses(const Robot& robot, const std::vector<Station>& stations, int number) {
  constexpr double kLength = 0.02, kTurn = 0.01 * std::numbers::pi / 180.0;
  RandomStream random(kMachines, static_cast<std::uint64_t>(number));
  const SourceErrors errors = draw_errors(robot, tolerances_of(robot), random);
  VirtualInstrument instrument{.noise = kLength, .rotation_noise = kTurn, .body = random_body(random)};
  instrument.frame = random_body(random);
  Measurements read =
      simulate(robot, errors, planned(robot, stations, {.measurand = Measurand::poses}), instrument, random);
  for (PointReading& one : read.series[0].readings) one.sigma = kLength, one.orientation_sigma = kTurn;
  return read;
}

void state_sigma(Measurements& measurements, double sigma) {
  for (PointSeries& series : measurements.series) {
    for (PointReading& reading : series.readings) reading.sigma = sigma;
  }
}

SourceErrors as_felt(const Robot& robot, SourceErrors errors) {
  if (robot.actuator() != Actuator::linear) return errors;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    const double up = std::exchange(errors(i, "e_z"), 0.0);
    shift_limb(robot, i, Eigen::Vector3d(0.0, 0.0, up), errors);
  }
  return errors;
}

SourceErrors table4_machine(const Robot& robot, int number) {
  // L theta_offset, e_x, e_y, e_z, arm_length, L alpha0, L beta0, rod_mean, mm
  constexpr std::array<std::array<double, ErrorModel::kPosition>, 4> kTable4{
      {{-0.347, -0.375, -0.128, -0.707, 0.148, 0.370, -0.218, -0.577},
       {0.662, 0, 0.292, 0, 0.144, 0.436, 0.049, 0.171},
       {0.169, -0.290, -0.258, 0, -0.039, -0.372, -0.136, -0.094},
       {-0.187, 0, 0, 0, 0.177, -0.433, -0.415, 0.511}}};
  RandomStream machine(kMachines, static_cast<std::uint64_t>(number));
  SourceErrors errors = draw_errors(robot, *robot.tolerances(), machine);
  for (std::size_t limb = 0; limb < kTable4.size(); ++limb) {
    for (std::size_t k = 0; k < ErrorModel::kPosition; ++k) {
      const Source source = sources_of(robot.actuator())[k];
      errors(limb, source) = kTable4[limb][k] / paper_scale(robot, source);
    }
  }
  return errors;
}

PoseErrorSummary held_out_errors(const Robot& robot, const SourceErrors& truth, const SourceErrors& found,
                                 const std::vector<Station>& stations) {
  const Machine actual = build(robot, truth), believed = build(robot, found);
  std::vector<PosePair> pairs;
  for (const Station& station : stations) {
    const Joints joints = believed_joints(robot, station);
    const ForwardResult is = forward(actual, joints), meant = forward(believed, joints);
    pairs.push_back({{meant.plate.position, believed.rotation_of(meant.plate.slide)},
                     {is.plate.position, actual.rotation_of(is.plate.slide)}});
  }
  return summarize(pairs, true);
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace paracal::test
