// Lines of a program with O words that stand for themselves.

#include <fmt/format.h>

#include <algorithm>

#include "gcode_comments.hpp"
#include "gcode_flow.hpp"
#include "io/columns.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kControllers =
    "subprograms, jumps and loops: a parameter of the controller is assigned here";
constexpr std::string_view kRestored = "subprograms, jumps and loops: modes that a subprogram's end restores (M73)";

/// With words it is RepRap's, and says how far a print is.
bool restores_modes(const GcodeBlock& block) {
  const auto is_bare = [&](const GcodeWord& word) {
    return word.letter == 'M' && word.is_number() && word.value == 73.0 && !block.has_letter("PRCD");
  };
  return std::ranges::any_of(block.words, is_bare);
}

/// A number as G-code takes it: no exponent.
std::string written(double value) {
  std::string text = fmt::format("{:.8f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

bool ends_program(const GcodeBlock& block) {
  return std::ranges::any_of(block.words, [](const GcodeWord& word) {
    return word.letter == 'M' && word.is_number() && (word.value == 2.0 || word.value == 30.0);
  });
}

}  // namespace

void GcodeFlow::put(std::size_t at, std::string text, std::string_view otherwise) {
  const std::string_view end = lines_[at].substr(without_end(lines_[at]).size());
  into_->push_back({first_ + static_cast<std::int64_t>(at), std::move(text.append(end.empty() ? otherwise : end))});
}

/// Parameters whose values a comment shows get them just before it: the lines that assigned them are not there any
/// more.
GcodeFlow::End GcodeFlow::state_shown(std::size_t at) {
  for (const std::string_view parameter : shown_parameters(lines_[at])) {
    const std::optional<double> value = parameters_.value(parameter);
    if (!value && !parameters_.is_of_controller(parameter)) return fail(at, kUnknownValue);
    if (value) put(at, fmt::format("{}={}", parameter, written(*value)), "\n");
  }
  return End::normal;
}

/// A line with values for its parameters, and without what it assigns to them.
GcodeFlow::End GcodeFlow::take_line(std::size_t at) {
  const std::string_view content = without_end(lines_[at]);
  GcodeBlock block;
  block.parse(content);
  if (block.kind == GcodeBlock::Kind::malformed || (block.is_optional && !block.words.empty())) {
    return fail(at, kNotUnderstood);
  }
  if (restores_modes(block)) return fail(at, kRestored);
  const std::vector<GcodeWord> as_written = block.words;
  const bool assigns = !block.assignments.empty();
  // What is assigned counts here alone, and stands between words only in programs that nobody can read.
  if (assigns && !as_written.empty()) return fail(at, kNotUnderstood);
  if (parameters_.apply(block)) return fail(at, kControllers);
  std::string text;
  std::size_t copied = 0;
  for (std::size_t k = 0; k < as_written.size(); ++k) {
    if (as_written[k].kind != GcodeWord::Kind::expression) continue;
    if (!block.words[k].is_number()) return fail(at, kUnknownValue);
    text.append(content, copied, as_written[k].begin - copied).append(written(block.words[k].value));
    copied = as_written[k].end;
  }
  text.append(content, copied, content.size() - copied);
  if (const End shown = state_shown(at); shown != End::normal) return shown;
  put(at, assigns ? comments_of(content) : text);
  return ends_program(block) ? End::program : End::normal;
}

}  // namespace paracal::io
