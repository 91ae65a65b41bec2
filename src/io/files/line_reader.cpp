#include "line_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "paracal/error.hpp"

namespace paracal::io {

void LineReader::add(std::string_view text) {
  is_too_long_ = is_too_long_ || text.size() > kLongest;
  if (!is_too_long_) lines_.push_back({text, ++count_});
}

std::span<const Line> LineReader::next() {
  lines_.clear();
  while (lines_.empty()) {
    if (is_too_long_) {
      throw InputFileError(in_.name, static_cast<int>(count_ + 1),
                           fmt::format("expected lines of at most {} KiB, got a longer one", kLongest / 1024));
    }
    std::ranges::copy(tail_, buffer_.begin());
    in_.text.read(buffer_.data() + tail_.size(), static_cast<std::streamsize>(kChunk));
    if (in_.text.bad()) throw InputFileError(in_.name, 0, "cannot be read to its end");
    std::string_view rest(buffer_.data(), tail_.size() + static_cast<std::size_t>(in_.text.gcount()));
    const bool is_last = in_.text.gcount() == 0;
    tail_ = {};
    if (rest.empty()) break;
    for (std::size_t end = rest.find('\n'); end != std::string_view::npos; end = rest.find('\n')) {
      add(rest.substr(0, end + 1));
      rest.remove_prefix(end + 1);
    }
    is_last || rest.size() > kLongest ? add(rest) : void(tail_ = rest);
  }
  return lines_;
}

}  // namespace paracal::io
