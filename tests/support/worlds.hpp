#pragma once

// Virtual machines whose truth the model does not hold, and what a calibration then says of them.

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::test {

/// What is measured of a machine.
enum class Readings {
  points,
  two_trackers,
  points_and_lengths,
  seven_points,
  six_distances,
  heights,
  heights_and_distances
};

/// A world that a machine may live in; by default the one that the model believes in.
struct World {
  std::string name;
  Readings readings = Readings::points;                     ///< points: at 20 selected poses
  int visits = 3;                                           ///< of each of the selected poses
  bool noise_is_known = false;                              ///< and stated as kWorldNoise
  double position_tolerances = 1.0, tilt_tolerances = 1.0;  ///< errors over their tolerances
  bool table4_sized = false;  ///< all errors but the offsets as small as those of [huang2016, Table 4]
  int wrong_parts = 0;        ///< so many errors of the position group are ten tolerances off
  // Of a carriage an angle is what it takes at the end of a rod.
  double backlash = 0.0;         ///< rad: each joint stands this much to one side at a pose, at every visit the same
  double loose = 0.0;            ///< rad: one joint stands this much to one side, anew at each visit
  double sticks = 0.0;           ///< rad: one joint stands this much to one side at a tenth of the visits
  double uneven = 0.0;           ///< rad, root mean square of three harmonics of each joint's stroke
  double uneven_fast = 0.0;      ///< rad: drives are off by this at most, once up and down in a tenth of the stroke
  double counts_per_turn = 0.0;  ///< of encoders; 0: they read any angle
  double guides_aside = 0.0;     ///< mm: guides lead carriages aside by this at most, as a cubic of the stroke
  double wobble = 0.0;           ///< rad: axes lean by this, as the second and third harmonic of the arm's angle
  double compliance = 0.0;       ///< mm: joints give way under the plate's weight, by this much at most
  double encoder_once_a_turn = 0.0;  ///< rad: q + this sin q; of a carriage once a turn of its pulley
  bool one_drive = false;            ///< the encoder of the first drive alone is so
  double warm_drives = 0.0;          ///< arms are longer, or carriages run farther, by this share, from half way on
  bool in_passes = false;            ///< every pose is visited once before any is visited again
  double warming_rod = 0.0;          ///< mm: one rod of one limb is longer by as much at the last reading
  double backlash_by_side = 0.0;     ///< rad: each joint stands this much on the side from which it came
  double sag_at_rim = 0.0;           ///< mm, proportional to the radius
  double bow_at_rim = 0.0;           ///< mm sideways, as the square of the height: guides that are bowed
  double scale = 0.0;                ///< of the instrument, m/m
  double drift = 0.0;                ///< mm: the instrument moves by as much from the first reading to the last
  double wrong_pose = 0.0;           ///< mm: some poses were others, at all visits
  int wrong_poses = 1;               ///< as many of them
  double reflector_off = 0.0;        ///< mm: the reflector is as far from the axis of phi, and turns with it
  double noise_factor = 1.0;         ///< true noise over kWorldNoise
  bool states_sigmas = true;         ///< where several instruments are used
  double last_series_factor = 1.0;   ///< true noise of the last series over what it states
  bool student = false;              ///< noise has Student's t distribution of 3 degrees of freedom
  double gross_share = 0.0;          ///< of the readings have five times the noise
  /// Geometry imitates it so well that no reading can tell: predicted distances must hold, the errors need not.
  bool errors_cannot_be_told = false;
};

inline constexpr double kWorldNoise = 0.017;  // mm a coordinate

/// The worlds that a calibration is judged in.
std::vector<World> wrong_worlds();

/// A robot, its plans and where it is judged: made once, for selecting poses takes seconds.
struct Bench {
  Robot robot;
  std::vector<Station> selected;  ///< 20 poses
  std::vector<Station> others;    ///< home and 39 poses that were not measured
};
/// @param candidates  from which the plan is selected.
Bench bench_of(Robot robot, int candidates = 1000);

/// What happened to the machines of a world.
struct Judgement {
  int machines = 0, accepted = 0, noted = 0;  ///< noted: accepted with a note
  int errors = 0, errors_held = 0;            ///< identified errors, and those whose 95 % interval holds the truth
  int distances = 0, distances_held = 0;      ///< to home, at the other poses
  std::vector<double> largest_distance_error = {}, largest_U = {};  ///< of each accepted machine, mm
  /// Largest U of a distance, of the mean of many visits and of a single one, over that of a fit that was told the
  /// truth.
  std::vector<double> U_over_oracle = {}, use_over_oracle = {};
  /// Machines whose mean place, or a single visit, is somewhere off by more than U over the workspace: distance,
  /// aligned position, rotation.
  std::array<int, 3> use_exceeded = {}, visit_exceeded = {};
  int visits_held = 0;                                ///< distances of single visits
  std::vector<std::string> notes = {}, reasons = {};  ///< all of them
  /// Accepted machines of which notes name every fault; or name or list it among what may be; and those of which a note
  /// names something else.
  int named = 0, listed = 0, blamed = 0;

  double error_coverage() const { return errors == 0 ? 1.0 : static_cast<double>(errors_held) / errors; }
  double distance_coverage() const { return distances == 0 ? 1.0 : static_cast<double>(distances_held) / distances; }
};

/// Machines `first` ... `first + count - 1` of a world, measured and calibrated with `options`.
Judgement judge_world(const Bench& bench, const World& world, int first, int count, bool with_oracle = false);

}  // namespace paracal::test
