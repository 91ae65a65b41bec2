#include "validating.hpp"

#include "paracal/io/measurement_files.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {

AcceptanceLimits LimitOptions::limits() const {
  AcceptanceLimits limits{.distance = limit_mm, .volumetric = limit_aligned_mm};
  if (limit_deg) limits.rotation = to_radians(*limit_deg);
  return limits;
}

void add_limit_options(Command& command, LimitOptions& options) {
  command.heading("Limits");
  command.add_option("--limit-mm", options.limit_mm, "largest allowed distance error")->check(positive());
  command
      .add_option("--limit-aligned-mm", options.limit_aligned_mm,
                  "largest allowed position error after the best alignment of both frames")
      ->check(positive());
  command.add_option("--limit-deg", options.limit_deg, "largest allowed rotation error")
      ->check(within(plausible::kLimitDeg));
}

ValidationOptions ValidatingOptions::options(const CommandedReadings& read) const {
  return {.noise = measuring.noise(),
          .noise_is_known = measuring.states_noise_of(read.measurements),
          .rotation_noise_is_known = measuring.sigma_deg.has_value(),
          .scale_std = 1e-6 * measuring.scale_ppm,
          .reflectors = reflectors,
          .frame = measuring.frame_kind(),
          .body = measuring.body_kind(),
          .rotation_zero = measuring.rotation_kind(),
          .limits = limits.limits(),
          .controller = read.controller};
}

std::vector<std::string> ValidatingOptions::own(const io::CalibratedMachine& machine,
                                                const Measurements& measurements) const {
  return io::used_before(machine.inputs, measurements, measuring.files);
}

Option* add_validating_options(Command& command, ValidatingOptions& options) {
  command.add_option("--calibration", options.calibration, "calibration to check (JSON)")->required();
  Option* measurements = add_measuring_options(command, options.measuring);
  add_mount_option(command, options.reflectors);
  add_controller_options(command, options.controller);
  add_limit_options(command, options.limits);
  return measurements;
}

}  // namespace paracal::app
