#include "line_reader.hpp"

#include <algorithm>
#include <istream>

#include "paracal/error.hpp"

namespace paracal::io {

void LineReader::add(std::string_view text, bool ends) {
  using enum Line::Part;
  const bool is_long = in_long_line_ || !ends || text.size() > kLongest;
  if (!in_long_line_) ++count_;
  lines_.push_back({text, !is_long ? whole : in_long_line_ ? rest_of_long : start_of_long, count_});
  in_long_line_ = !ends;
}

std::span<const Line> LineReader::next() {
  lines_.clear();
  while (lines_.empty()) {
    std::ranges::copy(tail_, buffer_.begin());
    in_.text.read(buffer_.data() + tail_.size(), static_cast<std::streamsize>(kChunk));
    if (in_.text.bad()) throw InputFileError(in_.name, 0, "cannot be read to its end");
    std::string_view rest(buffer_.data(), tail_.size() + static_cast<std::size_t>(in_.text.gcount()));
    const bool is_last = in_.text.gcount() == 0;
    tail_ = {};
    if (rest.empty()) break;
    for (std::size_t end = rest.find('\n'); end != std::string_view::npos; end = rest.find('\n')) {
      add(rest.substr(0, end + 1), true);
      rest.remove_prefix(end + 1);
    }
    if (rest.empty()) continue;
    if (is_last || rest.size() > kLongest) {
      add(rest, is_last);
    } else {
      tail_ = rest;
    }
  }
  return lines_;
}

}  // namespace paracal::io
