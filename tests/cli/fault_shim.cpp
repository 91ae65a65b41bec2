// Preloaded into paracal: lets one call fail, or counts them. PARACAL_FAULT="CALL NUMBER ERRNO", calls from 1; with the
// negative number of a signal instead, the process gets that signal before the call, which then goes on; with 0 the
// folder PARACAL_FAULT_FOLDER goes before the call: removed if it is empty, else renamed to FOLDER.away; with
// kTakesNothing a write() writes nothing and says so. PARACAL_FAULT_COUNTS=FILE keeps how many calls of each kind a run
// makes. Standard streams and what the program does before main() are left alone.
// PARACAL_FAULT_DISK=plain: a disk that can neither exchange nor link files, nor hold one without a name, knows no
// owners and modes, and does not say when all is on it.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "fault_shim.hpp"

namespace {

using paracal::test::kTakesNothing;

enum Call { kOpen, kRead, kWrite, kSync, kMode, kLink, kRename, kFolder, kRemoval, kMemory, kCalls };
constexpr const char* kNames[kCalls] = {"open", "read",   "write", "fsync",  "fchmod",
                                        "link", "rename", "mkdir", "unlink", "malloc"};

long counts[kCalls];
bool started = false;
int failing = kCalls, error = 0;
long number = 0;

/// Of what the program does not see.
void vanish() {
  const char* folder = std::getenv("PARACAL_FAULT_FOLDER");
  if (folder == nullptr || rmdir(folder) == 0) return;
  char away[4096] = "";
  std::snprintf(away, sizeof away, "%s.away", folder);
  syscall(SYS_renameat2, AT_FDCWD, folder, AT_FDCWD, away, 0);
}

/// Whether this call is the one to fail.
bool fails(Call call) {
  if (!started) return false;
  const long now = __atomic_add_fetch(&counts[call], 1, __ATOMIC_RELAXED);
  if (call != failing || (now != number && (number >= 0 || now < -number))) return false;
  if (error < 0) kill(getpid(), -error);
  if (error == 0) vanish();
  if (error > 0) errno = error;
  return error > 0;
}

/// Says no in the place of a plain disk.
bool is_refused(int with) {
  static const bool is_plain = std::getenv("PARACAL_FAULT_DISK") != nullptr;
  if (is_plain && started) errno = with;
  return is_plain && started;
}

template <typename Function>
Function* next(Function* /*of this shape*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

int (*real_main)(int, char**, char**) = nullptr;

int begin(int argc, char** argv, char** environment) {
  started = true;
  return real_main(argc, argv, environment);
}

__attribute__((constructor)) void start() {
  char name[16] = "";
  if (const char* wish = std::getenv("PARACAL_FAULT")) std::sscanf(wish, "%15s %ld %d", name, &number, &error);
  for (int k = 0; k < kCalls; ++k) {
    if (std::strcmp(name, kNames[k]) == 0) failing = k;
  }
}

__attribute__((destructor)) void finish() {
  started = false;
  const char* path = std::getenv("PARACAL_FAULT_COUNTS");
  if (path == nullptr) return;
  std::FILE* file = std::fopen(path, "w");
  for (int k = 0; file != nullptr && k < kCalls; ++k) std::fprintf(file, "%s %ld\n", kNames[k], counts[k]);
  if (file != nullptr) std::fclose(file);
}

}  // namespace

// NOLINTBEGIN: the names and shapes of others
extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*loader_fini)(), void* stack_end) {
  static const auto real = next(static_cast<decltype(&__libc_start_main)>(nullptr), "__libc_start_main");
  real_main = main;
  return real(begin, argc, argv, init, fini, loader_fini, stack_end);
}

void* __libc_malloc(size_t);

void* malloc(size_t size) { return fails(kMemory) ? nullptr : __libc_malloc(size); }

int open(const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & (O_CREAT | O_TMPFILE)) != 0) {
    va_list more;
    va_start(more, flags);
    mode = va_arg(more, mode_t);
    va_end(more);
  }
  static const auto real = next(static_cast<int (*)(const char*, int, ...)>(nullptr), "open");
  if ((flags & O_TMPFILE) == O_TMPFILE && is_refused(EOPNOTSUPP)) return -1;
  return fails(kOpen) ? -1 : real(path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  static const auto real = next(static_cast<int (*)(int, const char*, int, ...)>(nullptr), "openat");
  return fails(kOpen) ? -1 : real(folder, path, flags);
}

int mkostemp(char* name, int flags) {
  static const auto real = next(static_cast<int (*)(char*, int)>(nullptr), "mkostemp");
  return fails(kOpen) ? -1 : real(name, flags);
}

FILE* fopen(const char* path, const char* mode) {
  static const auto real = next(static_cast<FILE* (*)(const char*, const char*)>(nullptr), "fopen");
  return fails(kOpen) ? nullptr : real(path, mode);
}

FILE* fopen64(const char* path, const char* mode) { return fopen(path, mode); }

ssize_t read(int file, void* into, size_t size) {
  static const auto real = next(static_cast<ssize_t (*)(int, void*, size_t)>(nullptr), "read");
  return file > STDERR_FILENO && fails(kRead) ? -1 : real(file, into, size);
}

ssize_t pread(int file, void* into, size_t size, off_t at) {
  static const auto real = next(static_cast<ssize_t (*)(int, void*, size_t, off_t)>(nullptr), "pread");
  return fails(kRead) ? -1 : real(file, into, size, at);
}

ssize_t write(int file, const void* from, size_t size) {
  static const auto real = next(static_cast<ssize_t (*)(int, const void*, size_t)>(nullptr), "write");
  if (file > STDERR_FILENO && fails(kWrite)) return error == kTakesNothing ? 0 : -1;
  return real(file, from, size);
}

int fsync(int file) {
  static const auto real = next(static_cast<int (*)(int)>(nullptr), "fsync");
  return fails(kSync) || is_refused(EINVAL) ? -1 : real(file);
}

int fchmod(int file, mode_t mode) {
  static const auto real = next(static_cast<int (*)(int, mode_t)>(nullptr), "fchmod");
  return fails(kMode) || is_refused(EPERM) ? -1 : real(file, mode);
}

int fchown(int file, uid_t owner, gid_t group) {
  static const auto real = next(static_cast<int (*)(int, uid_t, gid_t)>(nullptr), "fchown");
  return fails(kMode) || is_refused(EPERM) ? -1 : real(file, owner, group);
}

int linkat(int from, const char* source, int to, const char* target, int flags) {
  static const auto real = next(static_cast<int (*)(int, const char*, int, const char*, int)>(nullptr), "linkat");
  return fails(kLink) || is_refused(EPERM) ? -1 : real(from, source, to, target, flags);
}

int rename(const char* source, const char* target) {
  static const auto real = next(static_cast<int (*)(const char*, const char*)>(nullptr), "rename");
  return fails(kRename) ? -1 : real(source, target);
}

int renameat2(int from, const char* source, int to, const char* target, unsigned flags) {
  static const auto real =
      next(static_cast<int (*)(int, const char*, int, const char*, unsigned)>(nullptr), "renameat2");
  return fails(kRename) || is_refused(EINVAL) ? -1 : real(from, source, to, target, flags);
}

int unlink(const char* path) {
  static const auto real = next(static_cast<int (*)(const char*)>(nullptr), "unlink");
  return fails(kRemoval) ? -1 : real(path);
}

int mkdir(const char* path, mode_t mode) {
  static const auto real = next(static_cast<int (*)(const char*, mode_t)>(nullptr), "mkdir");
  return fails(kFolder) ? -1 : real(path, mode);
}
}
// NOLINTEND
