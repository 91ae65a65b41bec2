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
  bool reads_orientation = false;              ///< poses of a body are read, not points
  double rotation_noise = 0.0;                 ///< rad; of an orientation about each axis
  std::optional<Eigen::Vector3d> second = {};  ///< second reflector, mm, from the first, in the frame of its mount
  RigidMotion frame = {};                      ///< instrument = frame(robot)
  ReflectorMount mount = ReflectorMount::plate;
  RigidMotion body = {};  ///< mount = body(body), mm: where orientations are read
  /// Unknowns of the set-up of lengths (FoundSetUp); empty: one to plan for, of heights the plane z = 0.
  Eigen::VectorXd set_up = {};
};

/// The readings of a plan as a machine with these errors gives them to an instrument when its controller, which
/// believes the nominal robot, sends it to the stations. Of the instrument count noise, tracker, repeatability, frame,
/// mount, set-up and the places of second reflector and body; what is read, and how often, is the plan's.
/// @throws Unreachable when the nominal robot, or the machine itself, does not reach a station; InvalidArgument for a
/// set-up of another number of unknowns.
Measurements simulate(const Robot& robot, const SourceErrors& errors, Measurements plan,
                      const VirtualInstrument& instrument, RandomStream& random);

/// The same for points alone, read at every station as often as the instrument repeats.
Measurements simulate(const Robot& robot, const SourceErrors& errors, std::vector<Station> stations,
                      const VirtualInstrument& instrument, RandomStream& random);

/// A place that a body may have on the plate: within some ten mm of the centre, turned anyhow.
RigidMotion random_body(RandomStream& random);

/// A set-up that a series of lengths may have: of heights a plane about as level as beds and surface plates are,
/// somewhere under the robot.
Eigen::VectorXd random_set_up(const Robot& robot, const LengthSeries& series, RandomStream& random);

}  // namespace paracal
