#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/length_kind.hpp"
#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// A commanded pose at which the machine was measured.
struct Station {
  std::string name;
  Pose commanded;  ///< of no finite position where a table states the joints alone: with_commands() finds it
  /// Commanded joints; empty: the nominal inverse of the commanded pose.
  std::optional<Joints> believed = {};
  std::string stated_in = {};  ///< "plan.csv:3": file and line, for messages; empty: no file
};

/// plan.csv:3: station "P2": to begin a message with.
std::string named(const Station& station);

/// Measured distance between the plate centres at two stations and, where an encoder read it, the rotation between
/// them.
struct DistanceReading {
  std::size_t from = 0;  ///< index into the stations
  std::size_t to = 0;
  double distance = 0.0;                ///< mm
  std::optional<double> rotation = {};  ///< phi at `to` minus phi at `from`, rad
  std::optional<double> distance_sigma =
      {};  ///< standard deviation of the distance, mm, where the instrument states it
};

/// A quaternion w + x i + y j + z k; its negative is the same rotation.
using Quaternion = Eigen::Quaternion<double, Eigen::DontAlign>;

/// What an instrument read at one visit of a station. Visits of the same station are repeats.
struct PointReading {
  std::size_t station = 0;                     ///< index into the stations
  Eigen::Vector3d point = {};                  ///< reflector at the plate centre, mm, in the instrument's frame
  std::optional<Eigen::Vector3d> second = {};  ///< second reflector, mm, same frame
  std::optional<double> rotation = {};         ///< phi from a rotary encoder, rad
  std::optional<double> sigma = {};            ///< standard deviation of each coordinate, mm, where stated
  /// Of a body that stands somewhere on the plate, whose origin the point is then (motion capture): instrument =
  /// rotation(body). Of unit length within kUnitLength.
  std::optional<Quaternion> orientation = {};
  /// Standard deviation of the orientation, about each axis alike, rad, where stated.
  std::optional<double> orientation_sigma = {};

  static constexpr double kUnitLength = 1e-3;  ///< as far as numbers of four digits are off
};

/// The points read from one place of the instrument: one frame, any rigid motion away from the robot's.
struct PointSeries {
  std::string name;
  std::vector<PointReading> readings;

  /// Points are those of a body, not of a reflector at the plate centre.
  bool is_of_body() const;
};

/// A length that one pose shows by itself.
struct LengthReading {
  std::size_t station = 0;           ///< index into the stations
  double length = 0.0;               ///< mm
  std::optional<double> sigma = {};  ///< standard deviation, mm, where stated
};

/// Lengths of one kind from one setup, which is found with the rest: heights above a printer's bed.
struct LengthSeries {
  std::string name;
  LengthKind kind = LengthKind::height;
  std::vector<LengthReading> readings = {};
  /// What is known of the setup, in the robot's frame: of a ball bar where its fixed point is about, mm; of a dial the
  /// direction in which it reads, of any length.
  std::optional<Eigen::Vector3d> at = {};
};

/// A file that the measurements came from, so that a calibration can name its inputs.
struct InputFile {
  std::string name;
  std::string sha256;
};

struct Measurements {
  std::vector<Station> stations = {};  ///< the first is home
  std::vector<DistanceReading> distances = {};
  std::vector<PointSeries> series = {};
  std::vector<LengthSeries> lengths = {};
  std::vector<InputFile> files = {};
  std::vector<std::string> notes = {};  ///< what the import had to pass over: missing or doubled readings
};

/// @throws InvalidArgument for a station without finite pose or joints. Also for a reading without a station, from a
/// station to itself, that repeats another reading, or with an impossible distance, point or sigma. Messages count
/// readings from 1.
void check(const Measurements& measurements, std::size_t limb_count);

/// The lengths that instrument and machine would have shown at 20 deg C  [iso1]: all lengths read over 1 + expansion.
/// @param expansion  of the machine less that of the instrument, m/m: (a_machine - a_instrument) (T - 20 deg C).
Measurements at_reference_temperature(Measurements measurements, double expansion);

/// Commands that tables did not state: where the nominal robot stands with the commanded joints.
/// @throws Unreachable when it does not close there.
Measurements with_commands(const Robot& robot, Measurements measurements);

/// Commanded joints at a station.
/// @throws Unreachable when they are not stated and the nominal robot does not reach the commanded pose.
Joints believed_joints(const Robot& robot, const Station& station);

/// Every pair of a series' stations (repeats averaged) as a distance, as in [huang2016, Eq. (16)]. They are
/// correlated: N points carry 3 N numbers, however many distances are made of them.
std::vector<DistanceReading> all_distances(const PointSeries& series);

}  // namespace paracal
