#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// Tolerances of orientation [iso1101].
enum class Orientation : std::uint8_t { parallelism, perpendicularity, angularity };
std::string_view name(Orientation orientation);

/// What of a drawing a source error is the error of, and how its tolerance may be stated there.
struct DrawnFeature {
  enum class Kind : std::uint8_t {
    size,   ///< a length between two joints or bores: limits, or a grade
    turn,   ///< how a feature lies to a datum: an orientation
    place,  ///< where a point lies: a position
    none,   ///< set on the machine, or of a bought drive
  };
  /// An orientation that limits the error, and to what.
  struct Datum {
    Orientation orientation;
    std::string_view to;
  };

  Kind kind = Kind::none;
  std::string_view name;     ///< "bore distance of the arm"; of `none`: why there is nothing
  bool is_of_pairs = false;  ///< a size: the error is the difference of two parts of this size
  std::vector<Datum> data = {};
  double length = 0.0;             ///< of the feature that turns, mm; where the robot does not know it 100
  std::vector<double> sizes = {};  ///< nominal, mm, ascending: one where all limbs are alike
};

/// @param intended  what single limbs differ by on purpose, as the robot has it: it belongs to the nominal size.
DrawnFeature drawn_feature(Source source, const Geometry& geometry, const SourceErrors& intended);

}  // namespace paracal
