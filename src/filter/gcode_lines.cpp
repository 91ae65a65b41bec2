#include "gcode_lines.hpp"

#include <algorithm>
#include <utility>

#include "io/columns.hpp"

namespace paracal::io {
namespace {

constexpr std::size_t kLinesAtOnce = 8192;
constexpr std::string_view kTooMuch = "subprograms, jumps and loops: followed by more than 32 MiB, or a line of 64 KiB";

/// As many lines do not: a first look.
bool may_have_flow(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return false;
  const char c = line[first];
  return c == 'o' || c == 'O' || ((c == 'N' || c == 'n') && line.find_first_of("oO") != std::string_view::npos);
}

bool has_flow(const Line& line) {
  if (line.part != Line::Part::whole || !may_have_flow(line.text)) return false;
  GcodeBlock block;
  block.parse(without_end(line.text));
  return block.kind == GcodeBlock::Kind::flow;
}

}  // namespace

std::span<const Line> GcodeLines::next() {
  if (!from_flow_.empty()) carry_out();
  if (next_of_rest_ < rest_.size()) {
    const std::size_t count = std::min(kLinesAtOnce, rest_.size() - next_of_rest_);
    return std::span(rest_).subspan(std::exchange(next_of_rest_, next_of_rest_ + count), count);
  }
  const std::span<const Line> lines = reader_.next();
  if (!rest_.empty()) return lines;  // behind what could not be carried out
  const std::span<const Line> before = up_to_flow(lines);
  return before.empty() && !from_flow_.empty() ? next() : before;
}

std::span<const Line> GcodeLines::up_to_flow(std::span<const Line> lines) {
  const auto flow = std::ranges::find_if(lines, [this](const Line& line) {
    if (has_flow(line)) return true;
    learn(line);
    return false;
  });
  from_flow_ = {flow, lines.end()};
  return {lines.begin(), flow};
}

/// What the program assigns before.
void GcodeLines::learn(const Line& line) {
  if (line.part != Line::Part::whole || line.text.find('#') == std::string_view::npos) return;
  GcodeBlock block;
  block.parse(without_end(line.text));
  if (block.kind == GcodeBlock::Kind::words) parameters_.apply(block);
}

/// @returns whether there is room for them.
bool GcodeLines::hold(std::span<const Line> lines) {
  std::string& held = held_.emplace_back();
  for (const Line& line : lines) held += line.text;
  held_size_ += held.size();
  std::string_view left = held;
  bool is_whole = true;
  for (const Line& line : lines) {
    rest_.push_back({left.substr(0, line.text.size()), line.part, line.number});
    left.remove_prefix(line.text.size());
    is_whole &= line.part == Line::Part::whole;
  }
  return is_whole && held_size_ <= kMostHeld;
}

void GcodeLines::carry_out() {
  unfollowed_line_ = from_flow_.front().number;
  why_ = kTooMuch;
  for (auto lines = std::exchange(from_flow_, {}); !lines.empty(); lines = reader_.next()) {
    if (!hold(lines)) return;
  }
  std::vector<std::string_view> texts;
  for (const Line& line : rest_) texts.push_back(line.text);
  GcodeFlow flow(std::move(texts), unfollowed_line_, parameters_);
  is_unrolled_ = flow.carry_out(carried_out_);
  unfollowed_line_ = flow.unfollowed_line();
  why_ = flow.why_unfollowed();
  if (!is_unrolled_) return;
  rest_.clear();
  for (const CarriedOut& one : carried_out_) rest_.push_back({one.text, Line::Part::whole, one.number});
}

}  // namespace paracal::io
