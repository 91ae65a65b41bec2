// peak_memory FILE PROGRAM [ARGUMENT]...: runs a program, writes into the file how much memory it had at most, in KiB,
// and ends with its exit code. A process of its own, because a program counts as large as who starts it.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc < 3) return 125;
  const pid_t process = fork();
  if (process == 0) {
    execv(argv[2], argv + 2);
    _exit(126);
  }
  int status = 0;
  rusage usage{};
  if (process < 0 || wait4(process, &status, 0, &usage) != process) return 125;
  std::FILE* const file = std::fopen(argv[1], "w");
  if (file == nullptr || std::fprintf(file, "%ld\n", usage.ru_maxrss) < 0 || std::fclose(file) != 0) return 125;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 125;
}
