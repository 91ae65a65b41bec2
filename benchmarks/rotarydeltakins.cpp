#include "rotarydeltakins.hpp"

#include <array>
#include <map>

#include "linuxcnc_hal.hpp"

namespace paracal::benchmark {
namespace {

class Module final : public RotaryDeltaKins {
 public:
  explicit Module(KinematicsModule::Inverse function) : inverse_(function) {}

  std::array<double, 3> inverse(double x, double y, double z) const override {
    const EmcPose pose{.x = x, .y = y, .z = z};
    std::array<double, 9> joints{};
    unsigned long flags = 0;
    inverse_(&pose, joints.data(), &flags, &flags);
    return {joints[0], joints[1], joints[2]};
  }

 private:
  KinematicsModule::Inverse inverse_;
};

}  // namespace

std::unique_ptr<RotaryDeltaKins> RotaryDeltaKins::of(const Robot& robot) {
  if (robot.limb_count() != 3 || robot.actuator() != Actuator::revolute) return nullptr;
  const KinematicsModule module = KinematicsModule::load("rotarydeltakins");
  if (!module.loaded()) return nullptr;
  const Geometry& geometry = robot.geometry();
  const std::map<std::string, double> lengths{{"rotarydeltakins.platformradius", geometry.base_radius},
                                              {"rotarydeltakins.thighlength", geometry.arm},
                                              {"rotarydeltakins.shinlength", geometry.rod},
                                              {"rotarydeltakins.footradius", geometry.plate_radius}};
  for (const auto& [name, length] : lengths) {
    if (!KinematicsModule::set(name, length)) return nullptr;
  }
  return std::make_unique<Module>(module.inverse);
}

}  // namespace paracal::benchmark
