#include "host.hpp"

#include <fmt/format.h>

#include <fstream>
#include <thread>

#include "paracal/version.hpp"

namespace paracal::benchmark {
namespace {

std::string cpu_model() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string compiler() {
#if defined(__clang__)
  return "Clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

}  // namespace

Host this_host() {
  return {std::string(version()), std::string(build()), cpu_model(), std::thread::hardware_concurrency(), compiler(),
          PARACAL_BENCHMARK_BUILD};
}

std::string host_description(std::string_view use) {
  const Host host = this_host();
  return fmt::format("paracal  {}\nCPU      {}, {} logical cores; {}\ncompiler {}\nbuild    {}\n", host.version,
                     host.cpu, host.cores, use, host.compiler, host.flags);
}

}  // namespace paracal::benchmark
