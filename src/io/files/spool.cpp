#include "paracal/io/spool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "descriptor.hpp"
#include "paracal/error.hpp"
#include "paracal/io/signals_wait.hpp"

namespace paracal::io {
namespace {

int open_nameless(const std::filesystem::path& folder) {
  constexpr mode_t kPrivate = 0600;
  return uninterrupted([&] { return open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, kPrivate); });
}

/// Not every file system has files without names.
int open_unlinked(const std::filesystem::path& folder) {
  const SignalsWait nameless;
  std::string name = folder / ".paracal-XXXXXX";
  const int named = uninterrupted([&] { return mkostemp(name.data(), O_CLOEXEC); });
  if (named >= 0) uninterrupted([&] { return unlink(name.c_str()); });
  return named;
}

/// temp_directory_path() has other words for a folder that is not there.
std::filesystem::path temporary_folder() {
  const char* const wish = std::getenv("TMPDIR");
  return wish != nullptr && *wish != '\0' ? wish : "/tmp";
}

}  // namespace

Spool::~Spool() {
  if (descriptor_ >= 0) close(descriptor_);
}

void Spool::write(std::string_view text) {
  held_ += text;
  if (held_.size() < kPiece) return;
  if (descriptor_ < 0 && !folder_.empty()) {
    descriptor_ = open_nameless(folder_);
    if (descriptor_ >= 0) link_ = fmt::format("/proc/self/fd/{}", descriptor_);
  }
  if (descriptor_ < 0) {
    name_ = folder_ = temporary_folder();
    descriptor_ = open_nameless(folder_);
    if (descriptor_ < 0) descriptor_ = open_unlinked(folder_);
    if (descriptor_ < 0) fail_to_write(folder_);
  }
  write_held();
}

void Spool::write_held() {
  write_all(descriptor_, held_, name_);
  held_.clear();
}

void Spool::read(const std::function<void(std::string_view)>& take) const {
  std::array<char, 16 * 1024> piece;  // no memory: a store reads when nothing may fail for want of it
  for (off_t at = 0; descriptor_ >= 0;) {
    const ssize_t count = uninterrupted([&] { return pread(descriptor_, piece.data(), piece.size(), at); });
    if (count < 0) {
      throw Error(fmt::format("{}: a temporary file cannot be read: {}", folder_.string(), std::strerror(errno)));
    }
    if (count == 0) break;
    take({piece.data(), static_cast<std::size_t>(count)});
    at += count;
  }
  take(held_);
}

int Spool::give_name(const std::string& name) {
  if (link_.empty()) return -1;
  write_held();
  const auto give = [&] { return linkat(AT_FDCWD, link_.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW); };
  return uninterrupted(give) == 0 ? descriptor_ : -1;
}

}  // namespace paracal::io
