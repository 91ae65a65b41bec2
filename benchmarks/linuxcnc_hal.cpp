#include "linuxcnc_hal.hpp"

#include <dlfcn.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace {

/// Values of the pins that the module asked for, by name.
template <typename Value>
std::map<std::string, Value>& pins() {
  static std::map<std::string, Value> all;
  return all;
}

template <typename Value>
int add_pin(Value** pin, const std::string& name) {
  *pin = &pins<Value>()[name];
  return 0;
}

std::string text(const char* format, std::va_list arguments) {
  std::array<char, 128> name{};
  std::vsnprintf(name.data(), name.size(), format, arguments);
  return name.data();
}

}  // namespace

// What modules need of HAL, as far as these ask. Bits, and signed pins of one form, are numbers that nobody here reads.
#define PARACAL_NAMED(format)                       \
  std::va_list arguments;                           \
  va_start(arguments, format);                      \
  const std::string name = text(format, arguments); \
  va_end(arguments)
extern "C" {
[[gnu::visibility("default")]] int hal_init(const char*) { return 1; }
[[gnu::visibility("default")]] int hal_ready(int) { return 0; }
[[gnu::visibility("default")]] int hal_exit(int) { return 0; }
[[gnu::visibility("default")]] void* hal_malloc(long size) { return std::calloc(1, static_cast<std::size_t>(size)); }
[[gnu::visibility("default")]] int hal_pin_float_newf(int, double** pin, int, const char* format, ...) {
  PARACAL_NAMED(format);
  return add_pin(pin, name);
}
[[gnu::visibility("default")]] int hal_pin_u32_newf(int, unsigned** pin, int, const char* format, ...) {
  PARACAL_NAMED(format);
  return add_pin(pin, name);
}
[[gnu::visibility("default")]] int hal_pin_bit_newf(int, unsigned** pin, int, const char* format, ...) {
  PARACAL_NAMED(format);
  return add_pin(pin, name);
}
[[gnu::visibility("default")]] int hal_pin_bit_new(const char* name, int, unsigned** pin, int) {
  return add_pin(pin, name);
}
[[gnu::visibility("default")]] int hal_pin_s32_new(const char* name, int, unsigned** pin, int) {
  return add_pin(pin, name);
}
[[gnu::visibility("default")]] void rtapi_print(const char*, ...) {}
[[gnu::visibility("default")]] void rtapi_print_msg(int, const char*, ...) {}
}
#undef PARACAL_NAMED

namespace paracal::benchmark {

std::vector<LinuxcncBuild> linuxcnc_builds() {
  const char* const folder = std::getenv("PARACAL_LINUXCNC_O3");
  return {{"as shipped (-Os)", "/usr/lib/linuxcnc/modules"},
          {"compiled with -O3 -flto", folder == nullptr ? "" : folder}};
}

KinematicsModule KinematicsModule::load(const LinuxcncBuild& build, const std::string& name) {
  void* const module = ::dlopen((build.folder + "/" + name + ".so").c_str(), RTLD_NOW);
  if (module == nullptr) return {};
  const auto start = reinterpret_cast<int (*)()>(::dlsym(module, "rtapi_app_main"));
  if (start == nullptr || start() != 0) return {};
  return {reinterpret_cast<Inverse>(::dlsym(module, "kinematicsInverse")),
          reinterpret_cast<Forward>(::dlsym(module, "kinematicsForward"))};
}

bool KinematicsModule::set(const std::string& pin, double value) {
  const auto found = pins<double>().find(pin);
  if (found == pins<double>().end()) return false;
  found->second = value;
  return true;
}

bool KinematicsModule::set(const std::string& pin, unsigned value) {
  const auto found = pins<unsigned>().find(pin);
  if (found == pins<unsigned>().end()) return false;
  found->second = value;
  return true;
}

}  // namespace paracal::benchmark
