#include "peak_memory.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

namespace paracal::benchmark {

double peak_memory(const std::function<void()>& task) {
  std::fflush(stdout);  // or the child would print it once more
  const pid_t child = fork();
  if (child == 0) {
    task();
    _exit(0);
  }
  rusage usage{};
  int status = 0;
  if (child < 0 || wait4(child, &status, 0, &usage) < 0) return 0.0;
  return 1024e-6 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace paracal::benchmark
