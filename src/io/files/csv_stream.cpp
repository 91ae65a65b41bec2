#include "paracal/io/csv_stream.hpp"

#include <utility>

#include "io/tables/columns.hpp"
#include "line_reader.hpp"
#include "paracal/error.hpp"
#include "utf8.hpp"

namespace paracal::io {
namespace {

/// A line without its end, and its number in the file, from 1.
struct NumberedLine {
  int number;
  std::string_view text;
};

}  // namespace

/// Lines one at a time, though they are read many at a time.
class CsvStream::Lines {
 public:
  explicit Lines(TextStream in) : in_(std::move(in)) {}

  /// The next line stays the next one; nothing at the end.
  std::optional<NumberedLine> peek() { return has_next() ? std::optional(line(next_)) : std::nullopt; }
  void pass() { ++next_; }

  /// Calls look(line) with the lines that were read together, from the next one on.
  void look_ahead(const auto& look) {
    if (!has_next()) return;
    for (std::size_t k = next_; k < block_.size(); ++k) look(line(k));
  }

 private:
  bool has_next() {
    if (next_ == block_.size()) {
      block_ = read();
      next_ = 0;
    }
    return next_ < block_.size();
  }

  std::span<const Line> read() {
    try {
      if (!reader_) {
        utf8_ = decoded(in_.text);
        reader_.emplace(TextStream{in_.name, utf8_ ? *utf8_ : in_.text});
      }
      return reader_->next();
    } catch (const InvalidArgument& refused) {  // of the decoder, which does not know the file
      throw InputFileError(in_.name, 0, refused.what());
    }
  }

  NumberedLine line(std::size_t k) const {
    const auto number = static_cast<int>(block_[k].number);
    const std::string_view text = without_end(block_[k].text);
    return {number, number == 1 ? without_byte_order_mark(text) : text};
  }

  TextStream in_;
  std::unique_ptr<std::istream> utf8_ = {};  ///< of UTF-16
  std::optional<LineReader> reader_ = {};    ///< from the first line on
  std::span<const Line> block_ = {};
  std::size_t next_ = 0;  ///< in the block
};

CsvStream::CsvStream(const TextStream& in)
    : name_(in.name), lines_(std::make_unique<Lines>(in)), table_(in.name, in.style) {}

CsvStream::~CsvStream() = default;

std::optional<RobotStatement> CsvStream::robot() {
  std::optional<RobotStatement> found;
  lines_->look_ahead([&](const NumberedLine& line) { add_statement(found, name_, line.number, line.text); });
  return found;
}

void CsvStream::expect(RobotStatement robot) { expected_ = std::move(robot); }

const CsvTable* CsvStream::next() {
  table_.drop_rows();
  while (const auto line = lines_->peek()) {
    lines_->pass();
    add_statement(expected_, name_, line->number, line->text);
    const bool had_header = table_.has_header();
    if (table_.add(line->number, line->text)) return &table_;
    if (had_header || !table_.has_header()) continue;
    lines_->look_ahead([&](const NumberedLine& later) { table_.look_ahead(later.number, later.text); });
  }
  table_.finish();
  return nullptr;
}

}  // namespace paracal::io
