#include "rotarydeltakins.hpp"

#include <dlfcn.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <unordered_map>

namespace {

/// Pins that the module asked for, by name.
std::unordered_map<std::string, double*>& pins() {
  static std::unordered_map<std::string, double*> all;
  return all;
}

}  // namespace

// What the module needs of HAL, as far as it asks: memory, and pins that hold its geometry.
extern "C" {
[[gnu::visibility("default")]] int hal_init(const char*) { return 1; }
[[gnu::visibility("default")]] int hal_ready(int) { return 0; }
[[gnu::visibility("default")]] int hal_exit(int) { return 0; }
[[gnu::visibility("default")]] void* hal_malloc(long size) { return std::calloc(1, static_cast<std::size_t>(size)); }
[[gnu::visibility("default")]] int hal_pin_float_newf(int, double** pin, int, const char* name, ...) {
  static std::array<double, 16> values{};
  *pin = &values.at(pins().size());
  pins()[name] = *pin;
  return 0;
}
}

namespace paracal::benchmark {
namespace {

/// As in LinuxCNC's emcpos.h.
struct EmcPose {
  double x, y, z, a, b, c, u, v, w;
};

using Inverse = int (*)(const EmcPose*, double*, const unsigned long*, unsigned long*);

class Module final : public RotaryDeltaKins {
 public:
  explicit Module(Inverse function) : inverse_(function) {}

  std::array<double, 3> inverse(double x, double y, double z) const override {
    const EmcPose pose{.x = x, .y = y, .z = z, .a = 0, .b = 0, .c = 0, .u = 0, .v = 0, .w = 0};
    std::array<double, 9> joints{};
    unsigned long flags = 0;
    inverse_(&pose, joints.data(), &flags, &flags);
    return {joints[0], joints[1], joints[2]};
  }

 private:
  Inverse inverse_;
};

}  // namespace

std::unique_ptr<RotaryDeltaKins> RotaryDeltaKins::of(const Robot& robot) {
  if (robot.limb_count() != 3 || robot.actuator() != Actuator::revolute) return nullptr;
  void* const module = ::dlopen("/usr/lib/linuxcnc/modules/rotarydeltakins.so", RTLD_NOW);
  if (module == nullptr) return nullptr;
  const auto start = reinterpret_cast<int (*)()>(::dlsym(module, "rtapi_app_main"));
  const auto inverse = reinterpret_cast<Inverse>(::dlsym(module, "kinematicsInverse"));
  if (start == nullptr || inverse == nullptr || start() != 0) return nullptr;
  const Geometry& geometry = robot.geometry();
  const std::unordered_map<std::string, double> lengths{{"rotarydeltakins.platformradius", geometry.base_radius},
                                                        {"rotarydeltakins.thighlength", geometry.arm},
                                                        {"rotarydeltakins.shinlength", geometry.rod},
                                                        {"rotarydeltakins.footradius", geometry.plate_radius}};
  for (const auto& [name, length] : lengths) {
    const auto pin = pins().find(name);
    if (pin == pins().end()) return nullptr;
    *pin->second = length;
  }
  return std::make_unique<Module>(inverse);
}

}  // namespace paracal::benchmark
