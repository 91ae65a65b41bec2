#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/io/file.hpp"

namespace paracal::io {

/// A line with its end, if it has one.
struct Line {
  std::string_view text;
  std::int64_t number = 0;  ///< in the file, from 1
};

/// A stream as lines, many at a time and in constant memory.
class LineReader {
 public:
  static constexpr std::size_t kLongest = 64 * 1024;  ///< a file that never ends is refused

  explicit LineReader(TextStream in) : in_(std::move(in)), buffer_(kLongest + kChunk, '\0') {}

  /// The next lines, valid until the next call; none at the end of the stream.
  /// @throws InputFileError when the stream cannot be read, or the next line is longer than kLongest.
  std::span<const Line> next();
  /// How many lines of the file have been read.
  std::int64_t count() const { return count_; }

 private:
  static constexpr std::size_t kChunk = 256 * 1024;  ///< what is made of a line fits the caches

  void add(std::string_view text);

  TextStream in_;
  std::string buffer_;
  std::string_view tail_ = {};  ///< read, but not yet a line
  bool is_too_long_ = false;    ///< the line behind these
  std::int64_t count_ = 0;
  std::vector<Line> lines_;
};

}  // namespace paracal::io
