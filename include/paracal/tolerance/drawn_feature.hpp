#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// Tolerances of orientation [iso1101].
enum class Orientation : std::uint8_t { parallelism, perpendicularity, angularity };
std::string_view name(Orientation orientation);

/// The feature on a drawing that a geometric error belongs to, and the possible statements of its tolerance.
struct DrawnFeature {
  enum class Kind : std::uint8_t {
    size,   ///< a length between two joints or bores: limits, or a grade
    turn,   ///< direction of a feature relative to a datum: an orientation
    place,  ///< location of a point: a position
    none,   ///< adjusted on the machine, or property of a drive
  };
  /// An orientation that limits the error, and its datum.
  struct Datum {
    Orientation orientation;
    std::string_view to;
  };

  Kind kind = Kind::none;
  std::string_view name;     ///< "bore distance of the arm"; of `none`: the reason
  bool is_of_pairs = false;  ///< a size: the error is the difference of two parts of this size
  std::vector<Datum> data = {};
  double length = 0.0;             ///< of a `turn` feature, mm; 100 if unknown
  std::vector<double> sizes = {};  ///< nominal, mm, ascending: one if all limbs are equal
};

DrawnFeature drawn_feature(Source source, const Limbs& limbs);

}  // namespace paracal
