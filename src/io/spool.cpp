#include "paracal/io/spool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "descriptor.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

/// -1 where it cannot be.
int open_nameless(const std::filesystem::path& folder) {
  const int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor >= 0) return descriptor;
  std::string name = folder / ".paracal-XXXXXX";  // not every file system has files without names
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
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
  if (descriptor_ < 0) {
    folder_ = temporary_folder();
    descriptor_ = open_nameless(folder_);
    if (descriptor_ < 0) fail_to_write(folder_);
  }
  write_all(descriptor_, held_, folder_);
  held_.clear();
}

void Spool::read(const std::function<void(std::string_view)>& take) const {
  std::string piece(kPiece, '\0');
  for (off_t at = 0; descriptor_ >= 0;) {
    const ssize_t count = pread(descriptor_, piece.data(), piece.size(), at);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      throw Error(fmt::format("{}: a temporary file cannot be read: {}", folder_.string(), std::strerror(errno)));
    }
    if (count == 0) break;
    take(std::string_view(piece).substr(0, static_cast<std::size_t>(count)));
    at += count;
  }
  take(held_);
}

}  // namespace paracal::io
