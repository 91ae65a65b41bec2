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
  enum class Part : std::uint8_t { whole, start_of_long, rest_of_long } part = Part::whole;
};

/// A stream as lines, many at a time and in constant memory: lines longer than kLongest come in parts.
class LineReader {
 public:
  static constexpr std::size_t kLongest = 64 * 1024;

  explicit LineReader(TextStream in) : in_(std::move(in)), buffer_(kLongest + kChunk, '\0') {}

  /// The next lines, valid until the next call; none at the end of the stream.
  /// @throws InputFileError when the stream cannot be read.
  std::span<const Line> next();

 private:
  static constexpr std::size_t kChunk = 1024 * 1024;

  void add(std::string_view text, bool ends);

  TextStream in_;
  std::string buffer_;
  std::string_view tail_ = {};  ///< read, but not yet a line
  bool in_long_line_ = false;
  std::vector<Line> lines_;
};

}  // namespace paracal::io
