#include "paracal/io/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sha256.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "paracal/error.hpp"

namespace paracal::io {
namespace {

[[noreturn]] void fail_to_write(const std::filesystem::path& path) {
  throw Error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
}

/// A temporary neighbour of a file, gone again unless it was renamed over it.
class Neighbour {
 public:
  explicit Neighbour(const std::filesystem::path& target) : target_(target), name_(target.string() + ".XXXXXX") {
    descriptor_ = mkstemp(name_.data());
    if (descriptor_ < 0) fail_to_write(target);
  }
  Neighbour(const Neighbour&) = delete;
  Neighbour& operator=(const Neighbour&) = delete;
  ~Neighbour() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!renamed_) unlink(name_.c_str());
  }

  void write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(descriptor_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail_to_write(target_);
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void replace_target() {
    if (fchmod(descriptor_, mode_of_result()) != 0 || fsync(descriptor_) != 0) fail_to_write(target_);
    if (std::rename(name_.c_str(), target_.c_str()) != 0) fail_to_write(target_);
    renamed_ = true;
  }

 private:
  /// mkstemp makes private files: a result keeps the mode of the file it replaces, or is as readable as any other file.
  mode_t mode_of_result() const {
    struct stat earlier {};
    if (stat(target_.c_str(), &earlier) == 0) return earlier.st_mode & 07777;
    const mode_t mask = umask(0);
    umask(mask);
    return 0666 & ~mask;
  }

  std::filesystem::path target_;
  std::string name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// Pipes and devices cannot be replaced by a file.
void write_into(const std::filesystem::path& path, std::string_view text) {
  std::ofstream stream(path, std::ios::binary);
  if (!(stream << text << std::flush)) fail_to_write(path);
}

}  // namespace

TextFile read_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputFileError(path.string(), 0, "expected a file, got a folder");
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputFileError(path.string(), 0, fmt::format("cannot be read: {}", std::strerror(errno)));
  return {path.string(), std::string(std::istreambuf_iterator<char>(stream), {})};
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (exists(status) && !is_regular_file(status) && !is_directory(status)) return write_into(path, text);
  // A link stays a link: what it points to is replaced.
  Neighbour neighbour(exists(status) ? std::filesystem::canonical(path) : path);
  neighbour.write(text);
  neighbour.replace_target();
}

std::string sha256(std::string_view text) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> hex{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), hex.data());
  return hex.data();
}

}  // namespace paracal::io
