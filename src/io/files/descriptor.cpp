#include "descriptor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sha256.h>
#include <unistd.h>

#include <cstring>
#include <tuple>

#include "paracal/error.hpp"

namespace paracal::io {

Descriptor::~Descriptor() {
  if (is_open()) close(number_);
}

Descriptor open_descriptor(const char* path, int flags) {
  constexpr mode_t kPrivate = 0600;
  return Descriptor(uninterrupted([&] { return open(path, flags | O_CLOEXEC, kPrivate); }));
}

std::string of_descriptor(const Descriptor& file) { return fmt::format("/proc/self/fd/{}", file.number()); }

bool hash_file(const char* path, Hash& hash) {
  static_assert(std::tuple_size_v<Hash> == SHA256_DIGEST_STRING_LENGTH);
  return uninterrupted([&] { return SHA256File(path, hash.data()) != nullptr ? 0 : -1; }) == 0;
}

void fail_to_write(const std::filesystem::path& path) { fail_to_write(path, std::strerror(errno)); }

void fail_to_write(const std::filesystem::path& path, std::string_view why) {
  throw Error(fmt::format("{}: cannot be written: {}", path.string(), why));
}

void write_all(int descriptor, std::string_view text, const std::filesystem::path& path) {
  while (!text.empty()) {
    const ssize_t written = uninterrupted([&] { return ::write(descriptor, text.data(), text.size()); });
    if (written == 0) errno = EIO;  // again and again it would take nothing
    if (written <= 0) fail_to_write(path);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace paracal::io
