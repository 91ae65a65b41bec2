#include "gcode_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "io/columns.hpp"
#include "io/letters.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kUnknownCondition = "subprograms, jumps and loops: a condition here is not known";
constexpr std::string_view kNoSub = "subprograms, jumps and loops: no such subprogram in this file";
constexpr std::string_view kNoEnd = "subprograms, jumps and loops: this one has no end";
constexpr std::string_view kTooManyLines = "subprograms, jumps and loops: more than a million lines are carried out";
constexpr std::string_view kNestedTooDeep = "subprograms, jumps and loops: more than 50 within each other";

constexpr std::size_t kMostSteps = 1'000'000;
constexpr int kDeepestFlow = 50;
constexpr int kArguments = 30;

/// [...] at the beginning of a text, brackets within included; empty where there is none.
std::string_view brackets_at(std::string_view text) {
  int depth = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] == '[') ++depth;
    if (text[k] == ']' && --depth == 0) return text.substr(0, k + 1);
    if (depth == 0) break;
  }
  return {};
}

bool is_end_of_words(std::string_view text) { return text.empty() || text.starts_with('(') || text.starts_with(';'); }

}  // namespace

constexpr std::array<std::pair<std::string_view, GcodeFlow::Word>, 15> GcodeFlow::kWords{
    {{"SUB", Word::sub},
     {"ENDSUB", Word::endsub},
     {"CALL", Word::call},
     {"RETURN", Word::returns},
     {"IF", Word::when},
     {"ELSEIF", Word::elsewhen},
     {"ELSE", Word::otherwise},
     {"ENDIF", Word::endif},
     {"WHILE", Word::loop},
     {"ENDWHILE", Word::endloop},
     {"DO", Word::once},
     {"REPEAT", Word::repeat},
     {"ENDREPEAT", Word::endrepeat},
     {"BREAK", Word::leave},
     {"CONTINUE", Word::again}}};

GcodeFlow::GcodeFlow(std::vector<std::string_view> lines, std::int64_t first, GcodeParameters& parameters)
    : lines_(std::move(lines)), first_(first), parameters_(parameters) {
  flows_.reserve(lines_.size());
  for (const std::string_view line : lines_) {
    flows_.push_back(flow_of(without_end(line)));
    if (flows_.back().word == Word::sub) subs_.try_emplace(flows_.back().label, flows_.size() - 1);
  }
}

/// o100 call [1] [2], N10 O<name> sub; what stands in brackets is left as it is.
GcodeFlow::Flow GcodeFlow::flow_of(std::string_view line) {
  std::string_view text = trimmed(line);
  if (!text.empty() && upper_case(text.front()) == 'N') {
    text = trimmed(text.substr(1));
    text = trimmed(text.substr(std::min(text.find_first_not_of("0123456789"), text.size())));
  }
  if (text.empty() || upper_case(text.front()) != 'O') return {};
  text = trimmed(text.substr(1));
  const std::size_t end = text.starts_with('<') ? text.find('>') : text.find_first_not_of("0123456789");
  if (end == std::string_view::npos || end == 0) return {Word::unknown};
  const std::size_t label_size = text.starts_with('<') ? end + 1 : end;
  Flow flow{Word::unknown, without_blanks_in_upper_case(text.substr(0, label_size))};
  text = trimmed(text.substr(label_size));
  const auto word_size = static_cast<std::size_t>(std::ranges::find_if_not(text, is_letter) - text.begin());
  const auto* const known =
      std::ranges::find(kWords, upper_case(text.substr(0, word_size)), &std::pair<std::string_view, Word>::first);
  if (known != kWords.end()) flow.word = known->second;
  flow.rest = trimmed(text.substr(word_size));
  return flow;
}

GcodeFlow::End GcodeFlow::fail(std::size_t at, std::string_view why) {
  unfollowed_line_ = first_ + static_cast<std::int64_t>(at);
  why_ = why;
  return End::failed;
}

bool GcodeFlow::carry_out(std::vector<CarriedOut>& into) {
  into_ = &into;
  const End end = run(0, lines_.size(), 0);
  if (end == End::normal || end == End::program) return true;
  if (end != End::failed) fail(0, kNotUnderstood);  // a break or return of nothing
  into.clear();
  return false;
}

GcodeFlow::End GcodeFlow::run(std::size_t from, std::size_t to, int depth) {
  if (depth > kDeepestFlow) return fail(std::min(from, lines_.size() - 1), kNestedTooDeep);
  End end = End::normal;
  for (std::size_t at = from; at < to && end == End::normal; ++at) end = take(at, to, depth);
  return end;
}

/// @param at  becomes the last line of what was taken.
GcodeFlow::End GcodeFlow::take(std::size_t& at, std::size_t to, int depth) {
  if (++steps_ > kMostSteps) return fail(at, kTooManyLines);
  const Flow& flow = flows_[at];
  switch (flow.word) {
    case Word::none:
      return take_line(at);
    case Word::sub: {
      const std::size_t end = find(at + 1, flow.label, {Word::endsub});
      if (end >= to) return fail(at, kNoEnd);
      at = end;
      return End::normal;
    }
    case Word::call:
      return call(at, depth);
    case Word::when:
      return take_if(at, depth);
    case Word::loop:
    case Word::once:
      return take_while(at, flow.word == Word::loop, depth);
    case Word::repeat:
      return take_repeat(at, depth);
    case Word::returns:
    case Word::endsub:
      return is_end_of_words(flow.rest) ? End::returned : fail(at, kNotUnderstood);  // a value that is given back
    case Word::leave:
    case Word::again:
      leaving_ = flow.label;
      return flow.word == Word::leave ? End::leave : End::again;
    default:
      return fail(at, kNotUnderstood);
  }
}

std::size_t GcodeFlow::find(std::size_t from, const std::string& label, std::initializer_list<Word> words) const {
  for (std::size_t k = from; k < flows_.size(); ++k) {
    if (flows_[k].label == label && std::ranges::find(words, flows_[k].word) != words.end()) return k;
  }
  return flows_.size();
}

std::optional<double> GcodeFlow::condition(std::string_view text) const {
  const std::string_view brackets = brackets_at(text);
  return brackets.empty() ? std::nullopt : parameters_.value(brackets);
}

GcodeFlow::End GcodeFlow::take_if(std::size_t& at, int depth) {
  const std::string& label = flows_[at].label;
  const std::size_t end = find(at + 1, label, {Word::endif});
  if (end == flows_.size()) return fail(at, kNoEnd);
  for (std::size_t branch = at; branch < end;) {
    const std::size_t next = find(branch + 1, label, {Word::elsewhen, Word::otherwise, Word::endif});
    const bool is_else = flows_[branch].word == Word::otherwise;
    const std::optional<double> holds = is_else ? std::optional(1.0) : condition(flows_[branch].rest);
    if (!holds) return fail(branch, kUnknownCondition);
    if (*holds != 0.0) {
      at = end;
      return run(branch + 1, next, depth + 1);
    }
    branch = next;
  }
  at = end;
  return End::normal;
}

/// @param end  of a loop's body; becomes that of the loop.
/// @returns whether the loop is to be gone through again, if it asks for that.
bool GcodeFlow::goes_on(End& end, const std::string& label) {
  const bool is_own = (end == End::leave || end == End::again) && leaving_ == label;
  if (!is_own) return end == End::normal;
  return std::exchange(end, End::normal) == End::again;
}

/// o1 while ... o1 endwhile, which asks at its beginning, and o1 do ... o1 while, which asks at its end.
GcodeFlow::End GcodeFlow::take_while(std::size_t& at, bool asks_first, int depth) {
  const std::size_t start = at;
  const std::size_t stop = find(at + 1, flows_[at].label, {asks_first ? Word::endloop : Word::loop});
  if (stop == flows_.size()) return fail(at, kNoEnd);
  at = stop;
  const std::size_t asking = asks_first ? start : stop;
  for (bool is_asked = asks_first;; is_asked = true) {
    const std::optional<double> holds = is_asked ? condition(flows_[asking].rest) : 1.0;
    if (!holds) return fail(asking, kUnknownCondition);
    if (*holds == 0.0) return End::normal;
    if (++steps_ > kMostSteps) return fail(start, kTooManyLines);
    End end = run(start + 1, stop, depth + 1);
    if (!goes_on(end, flows_[start].label)) return end;
  }
}

GcodeFlow::End GcodeFlow::take_repeat(std::size_t& at, int depth) {
  const std::size_t start = at, stop = find(at + 1, flows_[at].label, {Word::endrepeat});
  if (stop == flows_.size()) return fail(at, kNoEnd);
  const std::optional<double> times = condition(flows_[start].rest);
  if (!times) return fail(start, kUnknownCondition);
  at = stop;
  for (double done = 0.0; done + 0.5 < *times; done += 1.0) {
    if (++steps_ > kMostSteps) return fail(start, kTooManyLines);
    End end = run(start + 1, stop, depth + 1);
    if (!goes_on(end, flows_[start].label)) return end;
  }
  return End::normal;
}

/// Arguments are #1 to #30 of the subprogram; these and named ones without underscore are its own.
GcodeFlow::End GcodeFlow::call(std::size_t at, int depth) {
  const auto found = subs_.find(flows_[at].label);
  if (found == subs_.end()) return fail(at, kNoSub);
  const std::size_t sub = found->second;
  const std::size_t end = find(sub + 1, flows_[at].label, {Word::endsub});
  if (end == flows_.size()) return fail(sub, kNoEnd);
  std::vector<double> arguments;
  std::string_view rest = flows_[at].rest;
  for (std::string_view one = brackets_at(rest); !one.empty(); one = brackets_at(rest)) {
    const std::optional<double> value = parameters_.value(one);
    if (!value) return fail(at, kUnknownValue);
    arguments.push_back(*value);
    rest = trimmed(rest.substr(one.size()));
  }
  if (arguments.size() > kArguments || !is_end_of_words(rest)) return fail(at, kNotUnderstood);
  if (!is_end_of_words(flows_[end].rest)) return fail(end, kNotUnderstood);
  arguments.resize(kArguments, 0.0);
  GcodeParameters callers = parameters_.enter(arguments);
  End result = run(sub + 1, end, depth + 1);
  parameters_.leave(std::move(callers));
  if (result == End::returned) result = End::normal;
  return result == End::leave || result == End::again ? fail(at, kNotUnderstood) : result;
}

}  // namespace paracal::io
