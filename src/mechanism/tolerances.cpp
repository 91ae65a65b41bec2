#include "paracal/mechanism/tolerances.hpp"

#include <numbers>

#include "paracal/units.hpp"

namespace paracal {

double Tolerances::std(Source source) const {
  constexpr double kTruncated = 0.98658;  // of a standard normal variable within +-3
  const double half = half_width[index(source)];
  switch (distribution) {
    case Distribution::normal:
      return half / 3.0;
    case Distribution::uniform:
      return half / std::numbers::sqrt3;
    case Distribution::truncated_normal:
      return kTruncated * half / 3.0;
  }
  return 0.0;
}

Tolerances generous_tolerances(double parallelogram_width) {
  Tolerances tolerances;
  tolerances[Source::theta_offset] = to_radians(1.5);
  tolerances[Source::e_x] = tolerances[Source::e_y] = tolerances[Source::e_z] = 3.0;
  tolerances[Source::arm_length] = 0.8;
  tolerances[Source::alpha0] = tolerances[Source::beta0] = to_radians(0.3);
  tolerances[Source::rod_mean] = 2.4;
  tolerances[Source::rod_difference] = 0.22e-3 * parallelogram_width;
  tolerances[Source::width_difference] = 0.90e-3 * parallelogram_width;
  tolerances[Source::alpha03] = 0.26e-3;
  tolerances[Source::beta03] = 0.52e-3;
  tolerances[Source::alpha2] = 0.25e-3;
  tolerances[Source::beta2] = 0.84e-3;
  return tolerances;
}

}  // namespace paracal
