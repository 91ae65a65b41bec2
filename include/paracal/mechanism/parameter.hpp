#pragma once

#include <cstdint>

#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// One unknown of a robot: a source error of one limb. Robot::parameters() lists them all, limb by limb; columns of
/// derivatives and covariances are in that order.
struct Parameter {
  Source source;           ///< its name and group
  std::size_t limb = 0;    ///< from 0
  Unit unit = Unit::mm;    ///< inside the library
  double lever = 1.0;      ///< times the error is the paper's dp [huang2016, Eq. (4)]: mm, or rad of the tilt group
  double tolerance = 0.0;  ///< half-width: the robot's, or a default
  /// Where its effect on the limb is that of the joint zero, as of e_z on an upright rail: so much of it per unit. 0
  /// where it has an effect of its own, as nearly all have.
  double as_joint_zero = 0.0;
  std::uint64_t number = 0;  ///< which normal number of a machine's random stream draws it
};

/// The normal number that draws a source error of a limb: 14 limb + k for names with a reserved number k. A name
/// without has one from a hash of limb and name, far above these, so that it changes no other draw.
std::uint64_t number_of(std::size_t limb, Source source);

/// Numbers at the head of each stream that are reserved for the errors of a limb.
inline constexpr std::uint64_t kReservedNumbers = 14;

}  // namespace paracal
