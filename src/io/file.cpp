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

bool is_pipe_or_device(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  return exists(status) && !is_regular_file(status) && !is_directory(status);
}

/// A link stays a link: what it points to is replaced.
std::filesystem::path behind_links(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) ? std::filesystem::canonical(path) : path;
}

/// mkstemp makes private files: a result keeps the mode of the file it replaces, or is as readable as any other file.
mode_t mode_of_result(const std::filesystem::path& target) {
  struct stat earlier {};
  if (stat(target.c_str(), &earlier) == 0) return earlier.st_mode & 07777;
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

}  // namespace

std::ifstream open_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputFileError(path.string(), 0, "expected a file, got a folder");
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputFileError(path.string(), 0, fmt::format("cannot be read: {}", std::strerror(errno)));
  return stream;
}

TextFile read_file(const std::filesystem::path& path) {
  std::ifstream stream = open_file(path);
  return {path.string(), std::string(std::istreambuf_iterator<char>(stream), {})};
}

OutputFile::OutputFile(const std::filesystem::path& path) : target_(path) {
  if (is_pipe_or_device(path)) {
    descriptor_ = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    target_ = behind_links(path);
    neighbour_ = target_.string() + ".XXXXXX";
    descriptor_ = mkostemp(neighbour_.data(), O_CLOEXEC);
  }
  if (descriptor_ < 0) fail_to_write(target_);
}

OutputFile::~OutputFile() {
  close(descriptor_);
  if (!neighbour_.empty()) unlink(neighbour_.c_str());
}

void OutputFile::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(target_);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::commit() {
  if (neighbour_.empty()) return;
  if (fchmod(descriptor_, mode_of_result(target_)) != 0 || fsync(descriptor_) != 0) fail_to_write(target_);
  if (std::rename(neighbour_.c_str(), target_.c_str()) != 0) fail_to_write(target_);
  neighbour_.clear();
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::string sha256(std::string_view text) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> hex{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), hex.data());
  return hex.data();
}

}  // namespace paracal::io
