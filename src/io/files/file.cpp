#include "paracal/io/file.hpp"

#include <fmt/format.h>
#include <sha256.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "descriptor.hpp"
#include "paracal/error.hpp"
#include "utf8.hpp"

namespace paracal::io {

std::ifstream open_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputFileError(path.string(), 0, "expected a file, got a folder");
  }
  std::ifstream stream;
  do stream.open(path, std::ios::binary);
  while (!stream.is_open() && errno == EINTR);
  if (!stream.is_open())
    throw InputFileError(path.string(), 0, fmt::format("cannot be read: {}", std::strerror(errno)));
  return stream;
}

namespace {

void decode(TextFile& file) {
  try {
    if (std::optional<std::string> text = decoded(file.text)) {
      file.sha256 = sha256(file.text);
      file.encoding = *is_big_endian(file.text) ? Encoding::utf16_big_endian : Encoding::utf16_little_endian;
      file.text = *std::move(text);
    }
  } catch (const InvalidArgument& refused) {
    throw InputFileError(file.name, 0, refused.what());
  }
}

}  // namespace

TextFile read_file(const std::filesystem::path& path) {
  constexpr std::size_t kPiece = 1 << 20, kMostPieces = 128;
  std::ifstream stream = open_file(path);
  TextFile file{path.string(), {}};
  while (stream) {
    const std::size_t before = file.text.size();
    file.text.resize(before + kPiece);
    stream.read(file.text.data() + before, kPiece);
    file.text.resize(before + static_cast<std::size_t>(stream.gcount()));
    if (file.text.size() > kMostPieces * kPiece) {
      throw InputFileError(file.name, 0, fmt::format("expected at most {} MiB, got more", kMostPieces));
    }
  }
  if (stream.bad()) throw InputFileError(file.name, 0, "cannot be read to its end");
  decode(file);
  return file;
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
