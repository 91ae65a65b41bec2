#pragma once

// What the test asks of Simbody, whose headers are of an older C++ than ours.

#include <array>

namespace paracal::test {

/// Row by row; metres.
struct AssembledPlate {
  std::array<double, 9> rotation;
  std::array<double, 3> position;
};

/// A rod of fixed length from the ground to the plate; metres.
struct AssembledRod {
  std::array<double, 3> base, plate;
  double length;
};

/// A free plate on six rods, closed by Simbody's assembler from where it is.
AssembledPlate assemble(const std::array<AssembledRod, 6>& rods, const AssembledPlate& near);

}  // namespace paracal::test
