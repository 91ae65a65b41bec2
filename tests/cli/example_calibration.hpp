#pragma once

#include <string>

namespace paracal::test {

/// A machine with errors of both groups, as source errors (TOML).
inline const std::string kErrors = R"([[limb]]
theta_offset_deg = 0.2
alpha2_deg = 0.01
[[limb]]
e_mm = [0.1, -0.2, 0.3]
rod_difference_mm = 0.03
[[limb]]
arm_length_mm = 0.15
[[limb]]
rod_mean_mm = -0.4
alpha03_deg = -0.01
)";

/// The same errors as an accepted calibration.
inline const std::string kCalibration = R"({"format": "paracal calibration 1",
"accepted": true,
"verdict": "accepted",
"robot": {"name": "huang2016",
  "geometry": {"base_radius_mm": 200, "plate_radius_mm": 75, "arm_mm": 375, "rod_mm": 950,
    "parallelogram_width_mm": 100, "limb_azimuth_deg": [-45, 45, 135, 225], "actuator": "revolute"},
  "plate": {"slide_axis": [0, -1, 0], "slide_sign": [1, 1, -1, -1], "pinion_radius_mm": 12}},
"parameters": [
  {"name": "theta_offset", "limb": 1, "value": 0.2, "unit": "deg"},
  {"name": "alpha2", "limb": 1, "value": 0.01, "unit": "deg"},
  {"name": "e_x", "limb": 2, "value": 0.1, "unit": "mm"},
  {"name": "e_y", "limb": 2, "value": -0.2, "unit": "mm"},
  {"name": "e_z", "limb": 2, "value": 0.3, "unit": "mm"},
  {"name": "rod_difference", "limb": 2, "value": 0.03, "unit": "mm"},
  {"name": "arm_length", "limb": 3, "value": 0.15, "unit": "mm"},
  {"name": "rod_mean", "limb": 4, "value": -0.4, "unit": "mm"},
  {"name": "alpha03", "limb": 4, "value": -0.01, "unit": "deg"}
]})";

}  // namespace paracal::test
