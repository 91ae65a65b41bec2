#include "rotarydeltakins.hpp"

#include <array>
#include <map>

namespace paracal::benchmark {
namespace {

class Module final : public RotaryDeltaKins {
 public:
  explicit Module(const KinematicsModule& module) : module_(module) {}

  std::array<double, 3> inverse(double x, double y, double z) const override {
    const EmcPose pose{.x = x, .y = y, .z = z};
    std::array<double, 9> joints{};
    unsigned long flags = 0;
    module_.inverse(&pose, joints.data(), &flags, &flags);
    return {joints[0], joints[1], joints[2]};
  }

  EmcPose forward(const std::array<double, 3>& joints) const override {
    const std::array<double, 9> all{joints[0], joints[1], joints[2]};
    EmcPose pose;
    unsigned long flags = 0;
    module_.forward(all.data(), &pose, &flags, &flags);
    return pose;
  }

 private:
  KinematicsModule module_;
};

}  // namespace

std::unique_ptr<RotaryDeltaKins> RotaryDeltaKins::of(const Robot& robot, const LinuxcncBuild& build) {
  if (robot.limb_count() != 3 || robot.actuator() != Actuator::revolute) return nullptr;
  const KinematicsModule module = KinematicsModule::load(build, "rotarydeltakins");
  if (!module.loaded()) return nullptr;
  const SharedDimensions geometry = *shared_dimensions(robot.limbs());
  const std::map<std::string, double> lengths{{"rotarydeltakins.platformradius", geometry.base_radius},
                                              {"rotarydeltakins.thighlength", geometry.arm},
                                              {"rotarydeltakins.shinlength", geometry.rod},
                                              {"rotarydeltakins.footradius", geometry.plate_radius}};
  for (const auto& [name, length] : lengths) {
    if (!KinematicsModule::set(name, length)) return nullptr;
  }
  return std::make_unique<Module>(module);
}

}  // namespace paracal::benchmark
