#pragma once

// What the tests of exports start from: a calibrated machine, and a shell for what others make of its exports.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "calibrated_machine.hpp"

namespace paracal::test {

const std::string kConfigure = "export --calibration calibration.json --target linuxcnc --config machine";

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

  /// calibration.json of a robot of the catalogue, with errors of both groups.
  void calibrate(const std::string& robot) const {
    folder.write("calibration.json", R"({"accepted": true, "parameters": [
      {"name": "e_z", "limb": 3, "value": 0.4, "unit": "mm"},
      {"name": "rod_difference", "limb": 1, "value": 0.3, "unit": "mm"}], "robot": )" +
                                         folder.run("robot --json --robot " + robot).out + "}");
  }

  /// Of the robot's calibration.json; deg, of rails mm.
  nlohmann::json library_joints(const std::vector<PoseNumbers>& poses, const std::string& robot = "huang2016") const {
    folder.write("poses.csv", lines(poses, ",").insert(0, "x_mm,y_mm,z_mm,phi_deg\n"));
    const nlohmann::json all = json_from(kCompensate + " --robot " + robot);
    return all.at(all.contains("joints_mm") ? "joints_mm" : "joints_deg");
  }
};

}  // namespace paracal::test
