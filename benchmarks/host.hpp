#pragma once

#include <string>
#include <string_view>

namespace paracal::benchmark {

/// The computer and build of the measurements.
struct Host {
  std::string version;  ///< of the library, and its build()
  std::string build;
  std::string cpu;
  unsigned cores = 0;
  std::string compiler;
  std::string flags;  ///< of the benchmarks and the library
};

Host this_host();

/// The same, one a line.
/// @param use  of its cores
std::string host_description(std::string_view use = "one thread is used unless stated");

}  // namespace paracal::benchmark
