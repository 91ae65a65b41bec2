#include "paracal/calibration/simulation.hpp"

#include <fmt/format.h>

#include <Eigen/LU>

#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "readings/points.hpp"

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

}  // namespace

Measurements simulate(const Robot& robot, const SourceErrors& errors, std::vector<Station> stations,
                      const VirtualInstrument& instrument, RandomStream& random) {
  const Machine machine = build(robot, errors);
  Measurements measurements{.stations = std::move(stations), .series = {{"simulation", {}}}};
  for (std::size_t k = 0; k < measurements.stations.size(); ++k) {
    const Station& station = measurements.stations[k];
    const ForwardResult pose = forward(machine, believed_joints(robot, station));
    if (!pose.ok()) throw Unreachable(fmt::format("station \"{}\": the machine does not close there", station.name));
    for (int repeat = 0; repeat < instrument.repeats; ++repeat) {
      const Eigen::Vector3d centre = pose.plate.position + instrument.repeatability * normal_vector(random);
      PointReading reading{.station = k, .point = read_point(instrument, centre, random)};
      if (instrument.second) {
        const double phi = machine.rotation_of(pose.plate.slide);
        const Eigen::Vector3d lever = detail::mount_rotation(pose.plate, phi, instrument.mount) * *instrument.second;
        reading.second = read_point(instrument, centre + lever, random);
      }
      if (instrument.reads_rotation) {
        reading.rotation = machine.rotation_of(pose.plate.slide) + instrument.rotation_noise * random.normal();
      }
      measurements.series.front().readings.push_back(std::move(reading));
    }
  }
  return measurements;
}

}  // namespace paracal
