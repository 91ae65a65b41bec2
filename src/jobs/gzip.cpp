#include "gzip.hpp"

#include <zlib.h>

#include <array>
#include <new>

#include "paracal/error.hpp"

namespace paracal::jobs {
namespace {

constexpr int kWithGzipHeader = 16 + MAX_WBITS;

/// zlib only reads what it is given, but does not say so.
Bytef* bytes_of(std::string_view text) { return reinterpret_cast<Bytef*>(const_cast<char*>(text.data())); }

}  // namespace

std::string gzip(std::string_view text) {
  constexpr int kMemoryLevel = 9;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kWithGzipHeader, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string bytes(deflateBound(&stream, text.size()), '\0');
  stream.next_in = bytes_of(text);
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  (void)deflate(&stream, Z_FINISH);  // ends: there is room for all of it
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

std::string gunzip(std::string_view bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, kWithGzipHeader) != Z_OK) throw std::bad_alloc();
  stream.next_in = bytes_of(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string text;
  std::array<char, 1 << 16> piece{};
  int status = Z_OK;
  while (status == Z_OK && text.size() <= kLongestText) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = piece.size();
    status = inflate(&stream, Z_NO_FLUSH);
    text.append(piece.data(), piece.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  if (text.size() > kLongestText) throw Error("expected at most 4 MiB in a gzip file, got more");
  if (status != Z_STREAM_END) throw Error("expected a complete gzip file, got something else");
  return text;
}

}  // namespace paracal::jobs
