#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <istream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace paracal::io {

/// Properties of tables that the user states.
struct TableStyle {
  bool decimal_comma = false;                     ///< 1,5 is a number and 1.5 is not
  std::vector<std::string> ignored_columns = {};  ///< by their headings
};

/// Encoding of the characters of a file.
enum class Encoding : std::uint8_t { bytes, utf16_little_endian, utf16_big_endian };

/// A file's text together with the name that messages use.
struct TextFile {
  std::string name;
  std::string text;
  TableStyle style = {};
  Encoding encoding = Encoding::bytes;  ///< of the file; anything else is UTF-8 here
  std::string sha256 = {};              ///< of the bytes, if they differ from this text
};

/// Written by some programs before the first character of a file.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// A file's text as a stream, for files that are not loaded into memory.
struct TextStream {
  std::string name;
  std::istream& text;
  TableStyle style = {};
};

/// Takes a text piece by piece.
using TextSink = std::function<void(std::string_view)>;

/// A file, pipe or device, piece by piece. A wait for a pipe can be interrupted (interruption.hpp).
/// @throws InputFileError when it cannot be opened; later, when it cannot be read.
std::unique_ptr<std::istream> open_file(const std::filesystem::path& path);

/// A table, which may come from a pipe. The text is UTF-8 if the file is UTF-16 with a byte-order mark, as spreadsheets
/// write it; else its bytes.
/// @throws InputFileError when the file cannot be read or is larger than 128 MiB, the limit for files in memory.
TextFile read_file(const std::filesystem::path& path);

/// The same of JSON and TOML: a regular file, because others may have replaced it by a pipe without end.
/// @throws InputFileError for a pipe or device, too.
TextFile read_stored(const std::filesystem::path& path);

/// A text encoded for such a file, with the byte-order mark of UTF-16.
/// @param text  UTF-8, if the encoding is UTF-16.
std::string encoded(std::string_view text, Encoding encoding);

/// SHA-256 in hexadecimal.
std::string sha256(std::string_view text);
/// Of the file as it was read.
std::string sha256(const TextFile& file);
/// Of a file of any length as it is now.
/// @throws InputFileError when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace paracal::io
