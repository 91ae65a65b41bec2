#pragma once

#include <optional>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/noise.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/numerics/rigid_fit.hpp"

namespace paracal {

/// How a simulated machine is measured: standard deviations, all zero for a perfect instrument and machine.
struct VirtualInstrument {
  double noise = 0.0;                          ///< mm a coordinate, distance or height; no coordinate's with a tracker
  std::optional<TrackerModel> tracker = {};    ///< the instrument stands at the origin of its frame
  double repeatability = 0.0;                  ///< mm a coordinate: the machine comes back somewhere else
  double joint_noise = 0.0;                    ///< rad or mm, of the joints that a machine with spare limbs states
  int repeats = 1;                             ///< visits of every station
  bool reads_rotation = false;                 ///< a rotary encoder reads phi
  bool reads_orientation = false;              ///< poses of a body are read, not points
  double rotation_noise = 0.0;                 ///< rad; of an orientation about each axis
  std::optional<Eigen::Vector3d> second = {};  ///< second reflector, mm, from the first, in the frame of its mount
  RigidMotion frame = {};                      ///< instrument = frame(robot)
  ReflectorMount mount = ReflectorMount::plate;
  RigidMotion body = {};  ///< mount = body(body), mm: where orientations are read
  /// Unknowns of the setup of lengths (FoundSetUp); empty: one to plan for, of heights the plane z = 0.
  Eigen::VectorXd set_up = {};
};

/// Simulated measurements of a machine with these errors, whose controller uses the nominal robot. The instrument
/// contributes noise, tracker, repeatability, frame, mount, setup and the positions of second reflector and body.
/// The plan states what is read, and how often. The joints of a machine with spare limbs do not follow commands that
/// only the nominal robot can close: they agree near these, and are stated as they are read.
/// @throws Unreachable when the nominal robot, or the machine itself, does not reach a station; InvalidArgument for a
/// setup with another number of unknowns.
Measurements simulate(const Robot& robot, const SourceErrors& errors, Measurements plan,
                      const VirtualInstrument& instrument, RandomStream& random);

/// The same for points alone, read at every station as often as the instrument repeats.
Measurements simulate(const Robot& robot, const SourceErrors& errors, std::vector<Station> stations,
                      const VirtualInstrument& instrument, RandomStream& random);

/// A random position of a body on the plate: within some ten mm of the centre, any orientation.
RigidMotion random_body(RandomStream& random);

/// A random setup of a series of lengths; for heights a plane below the robot, about as level as beds and surface
/// plates are.
Eigen::VectorXd random_set_up(const Robot& robot, const LengthSeries& series, RandomStream& random);

}  // namespace paracal
