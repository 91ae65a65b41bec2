#pragma once

// What the tests of compensation and of its exports start from: a machine with known errors, as an accepted
// calibration.

#include <gmock/gmock.h>

#include <array>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "json_checks.hpp"

namespace paracal::test {

/// A machine with errors of both groups, as source errors (TOML).
const std::string kErrors = R"([[limb]]
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
const std::string kCalibration = R"({"format": "paracal calibration 1",
"accepted": true,
"verdict": "accepted",
"robot": {"name": "huang2016",
  "geometry": {"base_radius_mm": 200, "plate_radius_mm": 75, "arm_mm": 375, "rod_mm": 950,
    "parallelogram_width_mm": 100, "limb_azimuth_deg": [-45, 45, 135, 225], "actuator": "revolute"},
  "plate": {"slide_axis": [0, -1, 0], "slide_sign": [1, 1, -1, -1], "pinion_radius_mm": 12},
  "workspace": {"radius_mm": 500, "height_mm": 250, "top_z_mm": -763, "rotation_deg": [-180, 180]}},
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

const std::string kPoses =
    "pose,x_mm,y_mm,z_mm,phi_deg\n"
    "home,0,0,-888,0\n"
    "right,400,0,-900,120\n"
    "low,-200,300,-1000,-90\n";

const std::string kCompensate = "compensate --calibration calibration.json --poses poses.csv";

class CalibratedMachine : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("poses.csv", kPoses);
    folder.write("errors.toml", kErrors);
    folder.write("calibration.json", kCalibration);
  }

  nlohmann::json json_from(const std::string& command) const { return json_of(folder.run(command + " --json")); }

  const TemporaryFolder folder;
};

using PoseNumbers = std::array<double, 4>;  ///< x, y, z in mm, phi in deg

/// Poses that huang2016 reaches.
inline std::vector<PoseNumbers> random_poses(std::size_t count) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> side(-350.0, 350.0), z(-1013.0, -763.0), phi(-180.0, 180.0);
  std::vector<PoseNumbers> poses(count);
  for (PoseNumbers& pose : poses) pose = {side(engine), side(engine), z(engine), phi(engine)};
  return poses;
}

/// One line a pose, every number to its last digit.
inline std::string lines(const std::vector<PoseNumbers>& poses, const char* separator) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& [x, y, z, phi] : poses) text << x << separator << y << separator << z << separator << phi << '\n';
  return text.str();
}

}  // namespace paracal::test
