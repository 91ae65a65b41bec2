#include "paracal/calibration/simulation.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "calibration/fit/started.hpp"
#include "calibration/readings/length_model.hpp"
#include "calibration/readings/points.hpp"
#include "kinematics/turns.hpp"
#include "numerics/small.hpp"
#include "paracal/error.hpp"
#include "paracal/interruption.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {
namespace {

Eigen::Vector3d normal_vector(RandomStream& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

Eigen::Vector3d read_point(const VirtualInstrument& instrument, const Eigen::Vector3d& in_robot, RandomStream& random) {
  const Eigen::Vector3d point = instrument.frame(in_robot);
  const Eigen::Vector3d draw = normal_vector(random);
  if (!instrument.tracker) return point + instrument.noise * draw;
  return point + whitening(*instrument.tracker, point).inverse() * draw;
}

/// A machine that is sent to stations and read there.
class Visits {
 public:
  Visits(const Robot& robot, const SourceErrors& errors, std::vector<Station>& stations,
         const VirtualInstrument& instrument, RandomStream& random)
      : machine_(build(robot, errors)), instrument_(instrument), random_(random) {
    for (Station& station : stations) {
      let_interrupt();
      const ForwardResult pose = forward(machine_, believed_joints(robot, station), detail::started(robot, station));
      if (!pose.ok()) throw Unreachable(named(station) + ": no solution: " + why_no_pose(machine_, pose));
      plates_.push_back(pose.plate);
      if (machine_.spare_limbs() > 0) station.believed = read_joints(station);
    }
  }

  void read(PointReading& reading) {
    const Eigen::Matrix3d mount =
        detail::mount_rotation(plates_[reading.station], rotation(reading.station), instrument_.mount);
    Eigen::Vector3d centre = visit(reading.station);
    if (reading.orientation) {
      centre += mount * instrument_.body.translation;
      reading.orientation = read_orientation(mount * instrument_.body.rotation);
    }
    reading.point = read_point(instrument_, centre, random_);
    if (reading.second) reading.second = read_point(instrument_, centre + mount * *instrument_.second, random_);
    if (reading.rotation) reading.rotation = rotation(reading.station) + rotation_noise();
  }

  void read(DistanceReading& reading) {
    const Eigen::Vector3d from = visit(reading.from), to = visit(reading.to);
    // Noise may exceed the distance of two poses at one place, but no instrument shows a distance below zero.
    reading.distance = std::abs((to - from).norm() + instrument_.noise * random_.normal());
    if (reading.rotation) reading.rotation = rotation(reading.to) - rotation(reading.from) + rotation_noise();
  }

  void read(LengthSeries& series, const detail::SetUp& set_up) {
    const detail::LengthModel& model = detail::length_model(series.kind);
    for (LengthReading& reading : series.readings) {
      const double length = model.shown(visit(reading.station), set_up, series).length;
      reading.length = length + instrument_.noise * random_.normal();
    }
  }

 private:
  /// Where the last plate is, joints agree.
  Joints read_joints(const Station& station) {
    Pose pose = pose_of(machine_, plates_.back());
    for (Eigen::Index axis = 0; axis < 3; ++axis) {  // what parallelograms hold is not commanded
      if (!machine_.freedoms.free[static_cast<std::size_t>(axis) + 3]) pose.tilt(axis) = 0.0;
    }
    InverseResult found = inverse(machine_, pose);
    if (!found.ok()) throw Unreachable(named(station) + ": no solution: the machine cannot reach this pose");
    for (double& joint : found.joints) joint += instrument_.joint_noise * random_.normal();
    return found.joints;
  }
  /// Where it stands this time.
  Eigen::Vector3d visit(std::size_t station) {
    return plates_[station].position + instrument_.repeatability * normal_vector(random_);
  }
  Quaternion read_orientation(const Eigen::Matrix3d& in_robot) {
    const Eigen::Vector3d turn = instrument_.rotation_noise * normal_vector(random_);
    return Quaternion(Eigen::Matrix3d(instrument_.frame.rotation * in_robot * detail::turn_by(turn)));
  }
  double rotation(std::size_t station) const { return machine_.rotation_of(plates_[station].slide); }
  double rotation_noise() { return instrument_.rotation_noise * random_.normal(); }

  Machine machine_;
  std::vector<PlateState> plates_;
  const VirtualInstrument& instrument_;
  RandomStream& random_;
};

detail::SetUp set_up_of(const Robot& robot, const LengthSeries& series, const VirtualInstrument& instrument) {
  detail::SetUp typical = detail::length_model(series.kind).typical(robot, series);
  if (instrument.set_up.size() == 0) return typical;
  if (instrument.set_up.size() == typical.size()) return instrument.set_up;
  throw InvalidArgument(
      fmt::format("{}: expected a setup of {} numbers, got {}", series.name, typical.size(), instrument.set_up.size()));
}

}  // namespace

Measurements simulate(const Robot& robot, const SourceErrors& errors, Measurements plan,
                      const VirtualInstrument& instrument, RandomStream& random) {
  Visits visits(robot, errors, plan.stations, instrument, random);
  for (PointSeries& series : plan.series) {
    for (PointReading& reading : series.readings) {
      let_interrupt();
      visits.read(reading);
    }
  }
  for (DistanceReading& reading : plan.distances) {
    let_interrupt();
    visits.read(reading);
  }
  for (LengthSeries& series : plan.lengths) visits.read(series, set_up_of(robot, series, instrument));
  return plan;
}

Measurements simulate(const Robot& robot, const SourceErrors& errors, std::vector<Station> stations,
                      const VirtualInstrument& instrument, RandomStream& random) {
  Measurements plan{.stations = std::move(stations), .series = {{"simulation", {}}}};
  for (std::size_t k = 0; k < plan.stations.size(); ++k) {
    PointReading reading{.station = k, .point = Eigen::Vector3d::Zero(), .second = instrument.second};
    if (instrument.reads_rotation) reading.rotation = 0.0;
    if (instrument.reads_orientation) reading.orientation = Quaternion::Identity();
    for (int repeat = 0; repeat < instrument.repeats; ++repeat) plan.series.front().readings.push_back(reading);
  }
  return simulate(robot, errors, std::move(plan), instrument, random);
}

RigidMotion random_body(RandomStream& random) {
  constexpr double kFar = 50.0;
  const Eigen::Vector3d axis = normal_vector(random).normalized();
  const double angle = std::numbers::pi * random.uniform();
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), kFar * normal_vector(random)};
}

Eigen::VectorXd random_set_up(const Robot& robot, const LengthSeries& series, RandomStream& random) {
  return detail::length_model(series.kind).random(robot, series, random);
}

}  // namespace paracal
