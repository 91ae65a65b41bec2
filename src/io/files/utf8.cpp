#include "utf8.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/locale/utf.hpp>
#include <iterator>
#include <streambuf>

#include "paracal/error.hpp"

namespace paracal::io {
namespace {

unsigned char byte_of(char c) { return static_cast<unsigned char>(c); }

using Utf8 = boost::locale::utf::utf_traits<char>;
using Utf16 = boost::locale::utf::utf_traits<char16_t>;

/// Length of the text up to the first byte that is no UTF-8.
std::size_t length_of_utf8(std::string_view text) {
  const char *at = text.data(), *const end = at + text.size(), *good = at;
  while (good != end && boost::locale::utf::is_valid_codepoint(Utf8::decode(at, end))) good = at;
  return static_cast<std::size_t>(good - text.data());
}

/// The character of a byte from 0x80 on in Windows-1252; 0: none.
char32_t of_windows(unsigned char byte) {
  // Where it differs from Latin-1: 0x80 to 0x9F.
  constexpr std::array<char16_t, 32> kOwn{0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                          0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                          0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                          0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};
  const std::size_t place = byte - 0x80U;
  return place < kOwn.size() ? kOwn[place] : byte;
}

}  // namespace

bool is_utf8(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return byte_of(c) < 0x80; }) ||  // nearly always
         length_of_utf8(text) == text.size();
}

std::string with_other_bytes_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t good = length_of_utf8(text); good < text.size(); good = length_of_utf8(text)) {
    decoded += text.substr(0, good);
    if (const char32_t character = of_windows(byte_of(text[good]))) {
      Utf8::encode(character, std::back_inserter(decoded));
    } else {
      decoded += fmt::format("\\x{:02X}", byte_of(text[good]));
    }
    text.remove_prefix(good + 1);
  }
  return decoded.append(text);
}

std::string note_of_decoding(int line) {
  return fmt::format("line {}: bytes that are not UTF-8 are read as Windows-1252 (Latin-1) from here on", line);
}

void Utf16Decoder::add(std::string_view bytes, std::string& text) {
  for (const char c : bytes) {
    if (!has_byte_) {
      byte_ = byte_of(c);
    } else {
      const unsigned high = big_endian_ ? byte_ : byte_of(c), low = big_endian_ ? byte_of(c) : byte_;
      add_unit(static_cast<std::uint16_t>(high << 8 | low), text);
    }
    has_byte_ = !has_byte_;
  }
}

void Utf16Decoder::add_unit(std::uint16_t unit, std::string& text) {
  if ((leading_ != 0) != Utf16::is_second_surrogate(unit)) {
    throw InvalidArgument("expected UTF-16 text, got an incomplete surrogate pair");
  }
  if (Utf16::is_first_surrogate(unit)) {
    leading_ = unit;
    return;
  }
  Utf8::encode(leading_ != 0 ? Utf16::combine_surrogate(leading_, unit) : unit, std::back_inserter(text));
  leading_ = 0;
}

void Utf16Decoder::finish() const {
  if (has_byte_ || leading_ != 0) throw InvalidArgument("expected UTF-16 text, got an incomplete character at its end");
}

namespace {

/// The byte-order marks of UTF-16: no UTF-8 text begins with either.
constexpr std::string_view kLittleEndianMark = "\xFF\xFE", kBigEndianMark = "\xFE\xFF";

/// Decodes what it reads, a piece at a time.
class DecodingBuffer : public std::streambuf {
 public:
  DecodingBuffer(std::istream& bytes, bool big_endian) : bytes_(bytes), decoder_(big_endian) {}

 protected:
  int_type underflow() override {
    text_.clear();
    while (text_.empty()) {
      bytes_.read(piece_.data(), static_cast<std::streamsize>(piece_.size()));
      const auto count = static_cast<std::size_t>(bytes_.gcount());
      if (bytes_.bad()) throw InvalidArgument("cannot be read to its end");
      if (count == 0) {
        decoder_.finish();
        return traits_type::eof();
      }
      decoder_.add({piece_.data(), count}, text_);
    }
    setg(text_.data(), text_.data(), text_.data() + text_.size());
    return traits_type::to_int_type(text_.front());
  }

 private:
  std::istream& bytes_;
  Utf16Decoder decoder_;
  std::array<char, 16 * 1024> piece_ = {};
  std::string text_;
};

class DecodedStream : public std::istream {
 public:
  DecodedStream(std::istream& bytes, bool big_endian) : std::istream(nullptr), buffer_(bytes, big_endian) {
    rdbuf(&buffer_);
    exceptions(badbit);  // else what the decoder throws would be a stream that just ends
  }

 private:
  DecodingBuffer buffer_;
};

}  // namespace

std::optional<bool> is_big_endian(std::string_view bytes) {
  if (bytes.starts_with(kLittleEndianMark)) return false;
  if (bytes.starts_with(kBigEndianMark)) return true;
  return std::nullopt;
}

std::string as_utf16(std::string_view text, bool big_endian) {
  std::string bytes(big_endian ? kBigEndianMark : kLittleEndianMark);
  for (const char *at = text.data(), *const end = at + text.size(); at != end;) {
    std::u16string units;
    Utf16::encode(Utf8::decode(at, end), std::back_inserter(units));
    for (const char16_t unit : units) {
      const std::array pair{static_cast<char>(unit >> 8), static_cast<char>(unit & 0xFF)};
      bytes += pair[big_endian ? 0 : 1];
      bytes += pair[big_endian ? 1 : 0];
    }
  }
  return bytes;
}

std::optional<std::string> decoded(std::string_view bytes) {
  const auto big_endian = is_big_endian(bytes);
  if (!big_endian) return std::nullopt;
  std::string text;
  Utf16Decoder decoder(*big_endian);
  decoder.add(bytes.substr(kLittleEndianMark.size()), text);
  decoder.finish();
  return text;
}

std::unique_ptr<std::istream> decoded(std::istream& bytes) {
  const auto forget_the_end = [&] { bytes.clear(bytes.rdstate() & ~(std::ios::eofbit | std::ios::failbit)); };
  const auto first = bytes.peek();
  forget_the_end();
  const bool is_mark = first != std::istream::traits_type::eof() &&
                       kLittleEndianMark.find(static_cast<char>(first)) != std::string_view::npos;
  if (!is_mark) return nullptr;  // nearly always
  std::array<char, 2> begin{};
  bytes.read(begin.data(), begin.size());
  const auto begin_size = static_cast<std::size_t>(bytes.gcount());
  const auto big_endian = is_big_endian({begin.data(), begin_size});
  if (!big_endian) {
    forget_the_end();
    for (auto left = begin_size; left > 0; --left) bytes.unget();
    return nullptr;
  }
  return std::make_unique<DecodedStream>(bytes, *big_endian);
}

}  // namespace paracal::io
