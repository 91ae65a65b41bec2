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
  std::int64_t number = 0;  ///< in the file, from 1; of a part of a long line that of the line
};

/// Lines, many at a time.
class LineSource {
 public:
  LineSource() = default;
  LineSource(const LineSource&) = delete;
  LineSource& operator=(const LineSource&) = delete;
  virtual ~LineSource() = default;

  /// The next lines, valid until the next call; none at the end.
  virtual std::span<const Line> next() = 0;
  /// How many lines of the file have been read.
  virtual std::int64_t count() const = 0;
};

/// A stream as lines, many at a time and in constant memory: lines longer than kLongest come in parts.
class LineReader : public LineSource {
 public:
  static constexpr std::size_t kLongest = 64 * 1024;

  explicit LineReader(TextStream in) : in_(std::move(in)), buffer_(kLongest + kChunk, '\0') {}

  /// The next lines, valid until the next call; none at the end of the stream.
  /// @throws InputFileError when the stream cannot be read.
  std::span<const Line> next() override;
  std::int64_t count() const override { return count_; }

 private:
  static constexpr std::size_t kChunk = 256 * 1024;  ///< what is made of a line fits the caches

  void add(std::string_view text, bool ends);

  TextStream in_;
  std::string buffer_;
  std::string_view tail_ = {};  ///< read, but not yet a line
  bool in_long_line_ = false;
  std::int64_t count_ = 0;
  std::vector<Line> lines_;
};

}  // namespace paracal::io
