#pragma once

// Private to io: the lines of a program in the order in which a controller takes them.

#include <deque>
#include <string>
#include <vector>

#include "gcode_flow.hpp"
#include "io/line_reader.hpp"

namespace paracal::io {

/// Lines as they stand, as long as none has an O word; from there on as they are carried out, where that can be known.
class GcodeLines : public LineSource {
 public:
  explicit GcodeLines(TextStream in) : reader_(std::move(in)) {}

  std::span<const Line> next() override;
  std::int64_t count() const override { return reader_.count(); }

  /// Whether O words were carried out; if not, where and why not; 0: there are none.
  bool is_unrolled() const { return is_unrolled_; }
  std::int64_t unfollowed_line() const { return unfollowed_line_; }
  std::string_view why_unfollowed() const { return why_; }

 private:
  /// Programs with O words are held in memory; this much of them.
  static constexpr std::size_t kMostHeld = std::size_t{32} << 20U;

  std::span<const Line> up_to_flow(std::span<const Line> lines);
  void learn(const Line& line);
  bool hold(std::span<const Line> lines);
  void carry_out();

  LineReader reader_;
  GcodeParameters parameters_;
  std::span<const Line> from_flow_ = {};  ///< of the lines that were read last
  std::deque<std::string> held_;          ///< of the file, from the first O word on
  std::size_t held_size_ = 0;
  std::vector<Line> rest_;  ///< the same as lines, or what is carried out
  std::size_t next_of_rest_ = 0;
  std::vector<CarriedOut> carried_out_;
  bool is_unrolled_ = false;
  std::int64_t unfollowed_line_ = 0;
  std::string_view why_ = {};
};

}  // namespace paracal::io
