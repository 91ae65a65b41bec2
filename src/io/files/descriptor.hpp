#pragma once

// Private to io: files by their descriptors.

#include <array>
#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace paracal::io {

/// A call of the system, again and again while signals break it off.
template <typename Call>
auto uninterrupted(Call&& call) {
  auto result = call();
  while (result == -1 && errno == EINTR) result = call();
  return result;
}

/// An open file, closed with this.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}  ///< -1 for one that could not be opened
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor();

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

/// @param flags  as of open(), which closes the file in programs that this one starts.
Descriptor open_descriptor(const char* path, int flags);

/// A name that leads to an open file while it is open.
std::string of_descriptor(const Descriptor& file);

/// SHA-256 of a file of any length, in hexadecimal and with a zero behind it; wants no memory.
using Hash = std::array<char, 65>;

/// @returns whether the file could be read.
bool hash_file(const char* path, Hash& hash);

/// @throws Error with what errno says.
[[noreturn]] void fail_to_write(const std::filesystem::path& path);
[[noreturn]] void fail_to_write(const std::filesystem::path& path, std::string_view why);

/// @param path  for the message.
/// @throws Error when it cannot be written to its end.
void write_all(int descriptor, std::string_view text, const std::filesystem::path& path);

}  // namespace paracal::io
