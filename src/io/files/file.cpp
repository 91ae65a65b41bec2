#include "paracal/io/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sha256.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "descriptor.hpp"
#include "paracal/error.hpp"
#include "paracal/interruption.hpp"
#include "place.hpp"
#include "stored.hpp"
#include "utf8.hpp"

namespace paracal::io {
namespace {

/// An open file under the name that messages use.
class Input {
 public:
  /// Opens without waiting: a pipe may have nobody who writes.
  explicit Input(const std::filesystem::path& path, Use use = Use::read) : name_(path.string()) {
    const Place place = place_of(path, use);
    if (!place.is_reached()) refuse("cannot be read: " + place.why_not());
    if (place.is_folder()) refuse("expected a file, got a folder");
    file_ = place.open(O_RDONLY | O_NONBLOCK | O_NOCTTY);
    struct stat found {};
    if (!file_.is_open() || fstat(file_.number(), &found) != 0) fail("cannot be read");
    mode_ = found.st_mode;
  }

  const std::string& name() const { return name_; }
  bool is_regular() const { return S_ISREG(mode_); }
  [[noreturn]] void refuse(const std::string& complaint) const { throw InputFileError(name_, 0, complaint); }

  /// The next bytes; none at the end. The caller may end a wait (let_interrupt).
  std::size_t read(char* into, std::size_t size) const {
    constexpr int kBetween = 50;  // milliseconds: a person does not notice the delay
    pollfd source{.fd = file_.number(), .events = POLLIN, .revents = 0};
    ssize_t count = -1;
    do {
      while (!is_regular() && poll(&source, 1, kBetween) <= 0) let_interrupt();
      count = uninterrupted([&] { return ::read(file_.number(), into, size); });
    } while (count < 0 && errno == EAGAIN);
    if (count < 0) fail("cannot be read to its end");
    return static_cast<std::size_t>(count);
  }

  std::string read_all() const {
    constexpr std::size_t kPiece = 1 << 20;
    std::string bytes;
    for (std::size_t count = kPiece; count > 0;) {
      const std::size_t before = bytes.size();
      bytes.resize(before + kPiece);
      count = read(bytes.data() + before, kPiece);
      bytes.resize(before + count);
      if (bytes.size() > kStoredLimits.bytes) {
        refuse(fmt::format("expected at most {} MiB, got more", kStoredLimits.bytes >> 20));
      }
    }
    return bytes;
  }

 private:
  [[noreturn]] void fail(const char* what) const { refuse(fmt::format("{}: {}", what, std::strerror(errno))); }

  std::string name_;
  Descriptor file_ = {};
  mode_t mode_ = 0;
};

class InputBuffer : public std::streambuf {
 public:
  explicit InputBuffer(const std::filesystem::path& path) : input_(path) {}

 private:
  int_type underflow() override {
    const std::size_t count = input_.read(piece_.data(), piece_.size());
    setg(piece_.data(), piece_.data(), piece_.data() + count);
    return count == 0 ? traits_type::eof() : traits_type::to_int_type(piece_.front());
  }

  Input input_;
  std::array<char, 1 << 16> piece_;
};

class InputStream : public std::istream {
 public:
  explicit InputStream(const std::filesystem::path& path) : std::istream(nullptr), buffer_(path) {
    rdbuf(&buffer_);
    exceptions(std::ios::badbit);  // else errors of reading, and whoever ends a wait, would look like the end
  }

 private:
  InputBuffer buffer_;
};

std::string bytes_of_regular(const Input& input) {
  if (!input.is_regular()) input.refuse("expected a regular file, got a pipe or device; copy what it gives to a file");
  return input.read_all();
}

TextFile decoded_file(const std::filesystem::path& path, std::string bytes) {
  TextFile file{path.string(), std::move(bytes)};
  try {
    if (std::optional<std::string> text = decoded(file.text)) {
      file.sha256 = sha256(file.text);
      file.encoding = *is_big_endian(file.text) ? Encoding::utf16_big_endian : Encoding::utf16_little_endian;
      file.text = *std::move(text);
    }
  } catch (const InvalidArgument& refused) {
    throw InputFileError(file.name, 0, refused.what());
  }
  return file;
}

}  // namespace

std::unique_ptr<std::istream> open_file(const std::filesystem::path& path) {
  return std::make_unique<InputStream>(path);
}

TextFile read_file(const std::filesystem::path& path) { return decoded_file(path, Input(path).read_all()); }

std::string stored_bytes(const std::filesystem::path& path) { return bytes_of_regular(Input(path)); }

TextFile read_stored(const std::filesystem::path& path) { return decoded_file(path, stored_bytes(path)); }

TextFile read_included(const std::filesystem::path& path) {
  return decoded_file(path, bytes_of_regular(Input(path, Use::read_included)));
}

std::string encoded(std::string_view text, Encoding encoding) {
  if (encoding == Encoding::bytes) return std::string(text);
  return as_utf16(text, encoding == Encoding::utf16_big_endian);
}

std::string sha256(std::string_view text) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> hex{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), hex.data());
  return hex.data();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  Hash hash{};
  if (hash_file(path.c_str(), hash)) return hash.data();
  throw InputFileError(path.string(), 0, fmt::format("cannot be read: {}", std::strerror(errno)));
}

std::string sha256(const TextFile& file) { return file.sha256.empty() ? sha256(file.text) : file.sha256; }

}  // namespace paracal::io
