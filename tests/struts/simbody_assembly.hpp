#pragma once

// What the test asks of Simbody, whose headers are of an older C++ than ours.

#include <array>
#include <vector>

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

/// What of x, y, z and the three tilts guides leave free, and where they hold z; metres.
struct AssembledGuides {
  std::array<bool, 6> free;
  double z;
};

/// A plate on its limbs and between its guides, closed by Simbody's assembler from where it is, with the motors locked.
/// Guides are constraints of a free plate: a point in a plane, directions square to others. All tilts are held, or
/// none, or all but tilt_z.
AssembledPlate assemble(const std::vector<AssembledLimb>& limbs, const AssembledGuides& guides,
                        const AssembledPlate& near);

}  // namespace paracal::test
