#include "validating.hpp"

#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {

AcceptanceLimits LimitOptions::limits() const {
  AcceptanceLimits limits{.distance = limit_mm, .volumetric = limit_aligned_mm};
  if (limit_deg) limits.rotation = to_radians(*limit_deg);
  return limits;
}

void add_limit_options(Command& command, LimitOptions& options) {
  command.add_option("--limit-mm", options.limit_mm, "largest distance error allowed")->check(positive_finite());
  command.add_option("--limit-aligned-mm", options.limit_aligned_mm, "largest position error allowed, after alignment")
      ->check(positive_finite());
  command.add_option("--limit-deg", options.limit_deg, "largest rotation error allowed")->check(positive_finite());
}

ValidationOptions ValidatingOptions::options() const {
  return {.noise = measuring.noise(),
          .frame = measuring.frame_kind(),
          .rotation_zero = measuring.rotation_kind(),
          .limits = limits.limits()};
}

Option* add_validating_options(Command& command, ValidatingOptions& options) {
  command.add_option("--calibration", options.calibration, "calibration (JSON)")->required();
  Option* measurements = add_measuring_options(command, options.measuring);
  add_limit_options(command, options.limits);
  return measurements;
}

}  // namespace paracal::app
