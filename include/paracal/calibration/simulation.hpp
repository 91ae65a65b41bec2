#pragma once

#include <optional>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/noise.hpp"
#include "paracal/calibration/rigid_fit.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// How a virtual machine is measured; standard deviations, all zero for a perfect instrument and machine.
struct VirtualInstrument {
  double noise = 0.0;                          ///< mm a coordinate, distance or height; no coordinate's with a tracker
  std::optional<TrackerModel> tracker = {};    ///< the instrument stands at the origin of its frame
  double repeatability = 0.0;                  ///< mm a coordinate: the machine comes back somewhere else
  int repeats = 1;                             ///< visits of every station
  bool reads_rotation = false;                 ///< a rotary encoder reads phi
  double rotation_noise = 0.0;                 ///< rad
  std::optional<Eigen::Vector3d> second = {};  ///< second reflector, mm, from the first, in the frame of its mount
  RigidMotion frame = {};                      ///< instrument = frame(robot)
  ReflectorMount mount = ReflectorMount::plate;
  /// That heights are read above, in the robot's frame: z = plane . (1, x, y), mm.
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
};

/// The readings of a plan as a machine with these errors gives them to an instrument when its controller, which
/// believes the nominal robot, sends it to the stations. Of the instrument count noise, tracker, repeatability, frame,
/// mount, plane and the second reflector's place; what is read, and how often, is the plan's.
/// @throws Unreachable when the nominal robot, or the machine itself, does not reach a station.
Measurements simulate(const Robot& robot, const SourceErrors& errors, Measurements plan,
                      const VirtualInstrument& instrument, RandomStream& random);

/// The same for points alone, read at every station as often as the instrument repeats.
Measurements simulate(const Robot& robot, const SourceErrors& errors, std::vector<Station> stations,
                      const VirtualInstrument& instrument, RandomStream& random);

}  // namespace paracal
