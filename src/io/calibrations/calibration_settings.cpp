#include "calibration_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "paracal/error.hpp"

namespace paracal::io {

TrackerModel tracker_of_um(std::span<const double> um) {
  constexpr plausible::Range kNoise = plausible::kNoise;
  const bool is_model =
      um.size() == 4 && std::ranges::all_of(um, [](double one) { return option_limits::kStd.contains(one); });
  if (!is_model) throw InvalidArgument("expected four numbers of at least 0");
  const TrackerModel tracker{um[0] * 1e-3, um[1] * 1e-3, um[2] * 1e-3, um[3] * 1e-3};
  const auto check = [&](const char* direction, double at_one_metre) {
    if (kNoise.contains(at_one_metre)) return;
    throw InvalidArgument(fmt::format("expected four numbers that give {:g} to {:g} mm at 1 m, got {:g} mm {}",
                                      kNoise.least, kNoise.most, at_one_metre, direction));
  };
  check("transverse", tracker.transverse + tracker.transverse_per_m);
  check("radial", tracker.radial + tracker.radial_per_m);
  return tracker;
}

}  // namespace paracal::io
