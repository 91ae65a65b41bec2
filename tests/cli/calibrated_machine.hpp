#pragma once

// What the tests of compensation and of its exports start from: a machine with known errors, as an accepted
// calibration.

#include <gmock/gmock.h>

#include <array>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "example_calibration.hpp"
#include "json_checks.hpp"

namespace paracal::test {

inline const std::string kPoses =
    "pose,x_mm,y_mm,z_mm,phi_deg\n"
    "home,0,0,-888,0\n"
    "right,400,0,-900,120\n"
    "low,-200,300,-1000,-90\n";

inline const std::string kCompensate = "compensate --calibration calibration.json --poses poses.csv";

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
