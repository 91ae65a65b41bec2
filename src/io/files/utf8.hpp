#pragma once

// Private to io: text as it must be to go on, UTF-8, whatever wrote the file.

#include <cstdint>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace paracal::io {

bool is_utf8(std::string_view text);

/// The text with every byte that is no UTF-8 as the character of Windows-1252, which programs without Unicode write (of
/// Latin-1 it has every letter). A byte that it does not have is shown as \x81: what a message, a name and JSON can
/// hold.
std::string with_other_bytes_decoded(std::string_view text);

/// The note of a table in which that was done.
/// @param line  the first of them.
std::string note_of_decoding(int line);

/// UTF-16 as UTF-8, in pieces of any length.
class Utf16Decoder {
 public:
  explicit Utf16Decoder(bool big_endian) : big_endian_(big_endian) {}

  /// Adds what the bytes are to `text`.
  /// @throws InvalidArgument for half a pair of surrogates.
  void add(std::string_view bytes, std::string& text);
  /// Says that these were all.
  /// @throws InvalidArgument for half a character.
  void finish() const;

 private:
  void add_unit(std::uint16_t unit, std::string& text);

  bool big_endian_;
  bool has_byte_ = false;
  unsigned char byte_ = 0;     ///< of the next unit, the first
  std::uint16_t leading_ = 0;  ///< of a pair of surrogates; 0: none
};

/// Which UTF-16 a text is that begins with its byte-order mark; empty: none.
std::optional<bool> is_big_endian(std::string_view bytes);

/// UTF-8 as UTF-16 with its byte-order mark.
std::string as_utf16(std::string_view text, bool big_endian);

/// A text that begins with a byte-order mark of UTF-16, as UTF-8; empty for any other.
/// @throws InvalidArgument as Utf16Decoder.
std::optional<std::string> decoded(std::string_view bytes);

/// The stream's text as UTF-8 where it begins with a byte-order mark of UTF-16, whose bytes it then reads as it is read
/// itself; else null, and nothing has been read.
std::unique_ptr<std::istream> decoded(std::istream& bytes);

}  // namespace paracal::io
