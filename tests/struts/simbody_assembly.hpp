#pragma once

// What the test asks of Simbody, whose headers are of an older C++ than ours.

#include <array>

namespace paracal::test {

/// Row by row; metres.
struct AssembledPlate {
  std::array<double, 9> rotation;
  std::array<double, 3> position;
};

/// A rod of fixed length to the plate; metres, rad. Its upper end is a point (arm, 0, 0) of a body that a motor holds
/// in a frame of the ground (columns, row by row, at base): turned about its z, pushed along its x, or not moved at
/// all.
struct AssembledLimb {
  enum class Motor { none, turns, pushes } motor;
  std::array<double, 9> frame;
  std::array<double, 3> base;
  double coordinate;
  double arm;
  std::array<double, 3> plate;
  double length;
};

/// A free plate on six limbs, closed by Simbody's assembler from where it is, with the motors locked.
AssembledPlate assemble(const std::array<AssembledLimb, 6>& limbs, const AssembledPlate& near);

}  // namespace paracal::test
