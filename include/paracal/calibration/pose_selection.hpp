#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// What a set of poses should make small. C is the covariance after measuring, in units of the priors; "found" are the
/// source errors of the position group (all of them where tilt is read), without directions that no candidate sees.
enum class Criterion : std::uint8_t {
  volume,            ///< det C of all unknowns, frame and tilt errors included  [D-optimal, O1]
  mean_variance,     ///< tr C of the errors to be found  [A-optimal]
  worst_direction,   ///< largest eigenvalue of C of the errors to be found  [E-optimal, O3]
  pose_uncertainty,  ///< mean variance of aligned position and rotation over the workspace  [I-optimal]
};

/// A tracker sees a reflector within a cone about the direction in which it faces.
struct Visibility {
  Eigen::Vector3d tracker = {};  ///< mm, in the robot's frame
  Eigen::Vector3d facing = {};   ///< unit, in the frame of what carries the reflector
  double half_angle = 0.0;       ///< rad
  ReflectorMount mount = ReflectorMount::end_effector;

  bool sees(const Pose& pose) const;
};

struct SelectionOptions {
  int poses = 20;  ///< home included
  Criterion criterion = Criterion::pose_uncertainty;
  NoiseModel noise = {};
  PlannedReadings readings = {};                       ///< at every pose; not distances of all pairs
  RotationZero rotation_zero = RotationZero::unknown;  ///< of phi, where it is read
  std::optional<Tolerances> tolerances = {};           ///< priors; default: the robot's, or generous_tolerances()
  int largest_sweeps = 20;
  unsigned threads = 0;  ///< 0: all; the poses are the same
  /// Told after each pose that was added or compared with all candidates: how many so far, and how many there will be
  /// if this sweep is the last.
  std::function<void(std::uint64_t done, std::uint64_t expected)> progress = {};
};

/// A plan and its predicted uncertainty.
struct [[nodiscard]] Selection {
  std::vector<Station> stations;  ///< home first, then in the order of the shortest way found
  double criterion = 0.0;         ///< log det, trace, eigenvalue or mm^2
  int sweeps = 0, exchanges = 0;
  WorkspaceUncertainty uncertainty;  ///< at workspace_stations(), after measuring
  /// The same with 2, 3, ... poses, each added where it helps most.
  std::vector<WorkspaceUncertainty> curve;
  double travel = 0.0;  ///< sum over the way of the largest joint motion, rad, back to home
};

/// Poses that machines within the tolerances reach, spread over the workspace and its rotations, half of them on its
/// boundary, where errors show most; the same for the same seed. Home is the first.
std::vector<Station> candidate_stations(const Robot& robot, int count, std::uint64_t seed,
                                        const std::optional<Visibility>& visibility = {});

/// What an instrument can show, mm.
struct LengthRange {
  double shortest = 0.0, longest = 0.0;
};

/// Candidates moved along what is measured to where an instrument of this range shows them, spread over it as they were
/// over the workspace; those that leave workspace or reach are omitted. The plate then goes where a dial's plunger, or
/// a bar that gives by a millimetre, can follow.
/// @throws InvalidArgument unless lengths are read and the range is one.
std::vector<Station> within_range(const Robot& robot, const std::vector<Station>& candidates,
                                  const PlannedReadings& readings, const LengthRange& range);

/// Chooses poses by exchange (Fedorov 1972): from a set grown one by one, every chosen pose is compared with every
/// candidate, and the best exchange made, until none helps. With A_s, A_k the weighted rows of a chosen pose and a
/// candidate, C the covariance of all unknowns,
///
///   \f[ C_- = C + C A_s^T (I - A_s C A_s^T)^-1 A_s C
///       C_{-+} = C_- - C_- A_k^T (I + A_k C_- A_k^T)^-1 A_k C_- \f]
///
/// so an exchange is judged by matrices of a pose's few rows; A_k C A_k^T of all candidates is kept up to date instead
/// of being formed afresh.
/// @param candidates  home first; it is always chosen.
/// @throws InvalidArgument when there are fewer candidates than poses, and for distances of all pairs, which no pose
/// has alone.
Selection select_stations(const Robot& robot, const std::vector<Station>& candidates,
                          const SelectionOptions& options = {});

/// Orders stations (home stays first) so that the way through all of them and back is short: nearest neighbour, then
/// 2-opt, by the largest motion of a joint.
/// @returns the length of the way, rad.
double shorten_way(const Robot& robot, std::vector<Station>& stations);

}  // namespace paracal
