#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "paracal/calibration/identifiability.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// Azimuth of the first point on each circle, rad: the one that reproduces Table 3.
inline constexpr double kStartAzimuth = to_radians(270.0);

/// Home and n evenly spaced points on the rim of the middle layer, without rotation  [huang2016, section 4.2.2]. Where
/// machines within the tolerances may not reach the rims of the workspace, this and fine_stations() use a smaller one.
std::vector<Station> rough_stations(const Robot& robot, int n, double start_azimuth = kStartAzimuth);

/// Home and n evenly spaced points on the rims of the top and bottom layers. The plate has its largest rotation on top
/// and its smallest at the bottom  [huang2016, section 4.2.1].
std::vector<Station> fine_stations(const Robot& robot, int n, double start_azimuth = kStartAzimuth);

/// Home and eight points on circles of a fifth to the whole of the radius in the top, middle and bottom layers, without
/// rotation: 120 poses  [huang2016, section 5.2.2].
std::vector<Station> validation_stations(const Robot& robot);

/// The same 121 positions, turned in turn to the smallest, no and the largest rotation: the whole workspace in a few
/// poses.
std::vector<Station> workspace_stations(const Robot& robot);

/// One number of points and what it makes visible.
struct CurvePoint {
  int n = 0;
  Observability indices;
  double change = 0.0;  ///< |O2(n) - O2(n - 1)| / O2(n)
};

/// A scheme of the paper, carried to the number of points at which O2 settles.
struct [[nodiscard]] PaperPlan {
  int n = 0;  ///< smallest number with a change below the threshold; 0: none up to kLargest
  std::vector<CurvePoint> curve;
  std::vector<Station> stations;  ///< of that n
  static constexpr int kLargest = 40;
};

/// [huang2016, Eqs. (18), (20)]: O2 of the unweighted distances between all pairs, over the smallest singular value
/// above zero. Rough: for the encoder offsets alone; fine: for the whole position group. The curve continues to
/// `show_up_to` points.
/// @throws InvalidArgument for a plate with six degrees of freedom.
PaperPlan paper_plan(const Robot& robot, Stage stage, double start_azimuth = kStartAzimuth, double threshold = 0.01,
                     int show_up_to = 12);

/// What is measured at the poses of a plan.
enum class Measurand : std::uint8_t {
  coordinates,     ///< of the plate centre, in an unknown frame
  poses,           ///< position and orientation of a body on the plate, likewise
  distances,       ///< of the plate centre between all pairs of poses
  home_distances,  ///< from the first pose to each other
  lengths,         ///< that each pose shows by itself, of one kind and setup
};

struct PlannedReadings {
  Measurand measurand = Measurand::coordinates;
  bool rotation = false;                         ///< phi is read, too: not with lengths or poses
  bool second = false;                           ///< a second reflector is read, too: with coordinates alone
  ReflectorMount mount = ReflectorMount::plate;  ///< of the second reflector or the body
  LengthKind length = LengthKind::height;        ///< where lengths are read
  std::optional<Eigen::Vector3d> at = {};        ///< and what is known of their setup (LengthSeries)
};

/// Readings that a plan would give, taken from the nominal machine: for identifiability(), select_stations() and
/// simulate().
/// @throws InvalidArgument for a rotation or a second reflector with what has none, or shows it by itself.
Measurements planned(const Robot& robot, const std::vector<Station>& stations, const PlannedReadings& readings = {});

}  // namespace paracal
