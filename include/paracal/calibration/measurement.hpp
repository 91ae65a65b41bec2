#pragma once

#include <optional>
#include <string>
#include <vector>

#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// A commanded pose at which the machine was measured.
struct Station {
  std::string name;
  Pose commanded;
  /// Joint coordinates that the controller believed; empty: the nominal inverse of the commanded pose.
  std::optional<Joints> believed = {};
};

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

/// A file that the measurements came from, so that a calibration can name its inputs.
struct InputFile {
  std::string name;
  std::string sha256;
};

struct Measurements {
  std::vector<Station> stations;  ///< the first is home
  std::vector<DistanceReading> distances;
  std::vector<InputFile> files;
};

/// @throws InvalidArgument when a station has no finite pose or joints, or a reading names no station, joins a station
/// with itself, repeats another reading, or holds a distance or sigma that is not positive and finite. Readings count
/// from 1 in messages.
void check(const Measurements& measurements, std::size_t limb_count);

}  // namespace paracal
