#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// A nominal limb; mm and rad. The drive moves the upper end of its rod, or of the bar of its parallelogram; the lower
/// end is a joint of the plate, or the middle of the bar there. Both bars lie along w_0 of frame_of().
struct LimbDescription {
  /// In the base frame. Of a strut the joint at the base; of an arm the centre of the circle on which the rod's upper
  /// end goes; of a rail where a carriage without an arm stands at joint coordinate 0.
  Eigen::Vector3d base = Eigen::Vector3d::Zero();
  Eigen::Vector3d plate = Eigen::Vector3d::Zero();  ///< joint at the plate, in the plate frame
  double length = 0.0;                              ///< of the rod; of a strut at joint coordinate 0
  double arm = 0.0;  ///< of an arm: the radius of that circle; of a rail: from the carriage inward to the rod, may be 0
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< of an arm's motor, turning right-handed; of a rail along it
  /// Where an arm points at joint coordinate 0, square to its axis. Of a rail: its normal; zero: see frame_of().
  Eigen::Vector3d at_zero = Eigen::Vector3d::Zero();
  bool behind = false;  ///< a carriage that stands behind the joint at the plate, along the rail, and not ahead of it
  Actuator kind = Actuator::strut;
  double width = 0.0;  ///< of a parallelogram
  /// Of limbs that stand around z, from x towards y, where the file states it; see SharedDimensions.
  std::optional<double> azimuth = {};
  double zero = 0.0;    ///< added to the joint coordinate, rad or mm
  double gain = 0.0;    ///< excess travel of a linear drive, mm/m
  double alpha0 = 0.0;  ///< the limb leans in its frame by these angles, as by the errors of the same names
  double beta0 = 0.0;
  /// Joint coordinate of a turn of the screw or the encoder, mm or rad, where kind.has_harmonics; else 0.
  double pitch = 0.0;
  double turn_sine = 0.0, turn_cosine = 0.0;  ///< of what repeats with each turn, as by the errors of the same names
};
using Limbs = std::vector<LimbDescription>;

/// A length that limbs of a kind have: its key in files, what people call it, and the error that changes it.
struct LimbLength {
  std::string_view key, words;
  double LimbDescription::*member;
  Source error;
};
/// The rod, the width of its parallelogram, and the arm.
std::span<const LimbLength> lengths_of(Actuator kind);

/// Key of LimbDescription::pitch in files.
std::string_view pitch_key(Actuator kind);

/// Directions of the drive, and their keys in files.
struct LimbDirection {
  std::string_view key;
  Eigen::Vector3d LimbDescription::*member;
};
std::span<const LimbDirection> directions_of(Actuator kind);

/// Base of a limb, before it leans: columns u_0, v_0, w_0 in {O}. Of an arm: where it points at joint coordinate 0,
/// where it goes from there, the motor's axis. Of a rail: its upward normal (of one that stands upright: outward from
/// the z axis), along it, and w_0 = u_0 x v_0.
Eigen::Matrix3d frame_of(const LimbDescription& limb);
/// Its first column: outward from z, or of a rail upward from it. alpha0 and alpha3 turn about it.
inline Eigen::Vector3d radial_of(const LimbDescription& limb) { return frame_of(limb).col(0); }

/// The same limb with harmonics, or without where the pitch is 0.
LimbDescription with_pitch(LimbDescription limb, double pitch);

/// "gamma": where the limb stands around z, from x towards y; that of its joint at the base where the file says none.
double azimuth_of(const LimbDescription& limb);

/// The limbs with errors of the position group as nominal dimensions.
/// @throws InvalidArgument for an error of the tilt group, or one that is no number.
Limbs with_errors(Limbs limbs, const SourceErrors& errors);

/// The size of things: radii of the joints (root mean square), mean lengths of arms and rods, the width of the first
/// parallelogram; without one that of the plate; of a plate that is a point a tenth of a rod. mm.
struct LimbSizes {
  double base_radius = 0.0, plate_radius = 0.0, arm = 0.0, rod = 0.0, parallelogram_width = 0.0;
};
LimbSizes sizes_of(const Limbs& limbs);

/// The kinds of all limbs.
std::vector<Actuator> kinds_of(const Limbs& limbs);

/// That of the first limb; all joint coordinates have its unit.
inline Actuator actuator_of(const Limbs& limbs) { return limbs.front().kind; }

/// The names of the source errors that some limb has, in column order.
std::vector<Source> sources_of(const Limbs& limbs);

/// The source with that name; empty when no limb has it.
std::optional<Source> source_named(std::string_view name, const Limbs& limbs);

/// The sources that share the name of this one: itself, or the coordinates of a point.
std::vector<Source> sharing(Source leading, const Limbs& limbs);

/// The short form of a robot file: what limbs on parallelograms around z share; mm and rad [huang2016, Table 1, in
/// brackets]. Files are read into limbs; this is for reading, writing and naming alone.
struct SharedDimensions {
  double base_radius = 0.0;               ///< circle of the base joints [b]
  double plate_radius = 0.0;              ///< circle of the plate joints [a]
  double arm = 0.0;                       ///< arm (proximal link) [L]; of a rail: inward from it to the elbow, may be 0
  double rod = 0.0;                       ///< rod of the parallelogram [l]
  double parallelogram_width = 0.0;       ///< short side of the parallelogram [c]
  std::vector<double> limb_azimuth = {};  ///< gamma_i, from x towards y
  Actuator actuator = Actuator::revolute;
  double pitch = 0.0;             ///< see LimbDescription
  SourceErrors differences = {};  ///< of single limbs from that
};

/// @throws InvalidArgument naming the quantity and the limit that it breaks.
Limbs limbs_of(const SharedDimensions& shared);

/// Limbs that state where they stand around z have a short form. What they differ in counts from the dimension that
/// most of them have.
std::optional<SharedDimensions> shared_dimensions(const Limbs& limbs);

}  // namespace paracal
