#pragma once

// What the tests of exports start from: a calibrated machine, and a shell for what others make of its exports.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "calibrated_machine.hpp"

namespace paracal::test {

class Export : public CalibratedMachine {
 protected:
  /// Exit status of a command of the shell in the folder.
  int shell(const std::string& command) const {
    return std::system(fmt::format("cd '{}' && {}", folder.path().string(), command).c_str());  // NOLINT(*-env33-c)
  }

  void export_to(const std::string& target, const std::string& file) const {
    ASSERT_EQ(
        folder.run(fmt::format("export --calibration calibration.json --target {} --out {}", target, file)).exit_code,
        kDone);
  }

  nlohmann::json library_joints(const std::vector<PoseNumbers>& poses) const {
    folder.write("poses.csv", lines(poses, ",").insert(0, "x_mm,y_mm,z_mm,phi_deg\n"));
    return json_from(kCompensate).at("joints_deg");
  }
};

}  // namespace paracal::test
