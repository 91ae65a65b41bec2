#include "gcode_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/letters.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kSpindle = "canned cycles that stop or reverse the spindle (G74, G76, G84, G86 to G88)";
constexpr std::string_view kIncomplete =
    "a canned cycle whose numbers (R, depth, Q, P, L) are not all known, or do not agree";
constexpr std::string_view kReturn = "a canned cycle, and unclear whether G98 or G99 holds";
constexpr std::string_view kPathMode = "a canned cycle, and unclear which path mode (G61, G64) holds behind it";
constexpr std::string_view kTooMany = "a canned cycle of more than 10000 holes and pecks";

constexpr std::array kMotionsAlone{730, 810, 820, 830, 850, 890};
constexpr double kPeckClearance = 0.254;  ///< mm, LinuxCNC's, of 0.01 inch
constexpr double kMostStrokes = 10000;

/// To nine decimals, so that heights which a program states alike are alike.
double rounded(double value) { return std::round(value * 1e9) / 1e9; }

/// As a program can hold it: no exponent.
std::string number(double value) {
  std::string text = fmt::format("{:.9f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

/// The words of the way to the hole; none where it is below.
std::string approach(const GcodeBlock& block, std::size_t normal) {
  std::string words;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const GcodeWord* const word = axis == normal ? nullptr : block.word(kAxisLetters.at(axis));
    if (word != nullptr) words += fmt::format(" {}{}", kAxisLetters.at(axis), number(word->value));
  }
  return words;
}

bool is_of_cycle(const GcodeWord& word) { return std::string_view("XYZRQPL").find(word.letter) != std::string::npos; }

/// What stands in a block beside its motion.
std::string without_motion(const GcodeBlock& block, std::optional<std::size_t> motion_at) {
  std::string rest;
  std::size_t copied = 0;
  for (const GcodeWord& word : block.words) {
    if (!is_of_cycle(word) && !(word.letter == 'G' && word.at == motion_at)) continue;
    rest.append(block.text.substr(copied, word.at - copied));
    copied = word.end;
    while (copied < block.text.size() && is_blank(block.text[copied])) ++copied;
  }
  rest.append(block.text.substr(copied));
  while (!rest.empty() && is_blank(rest.back())) rest.pop_back();
  return rest;
}

}  // namespace

double CycleStart::stated(double at_place) const { return rounded((at_place - shift) / mm_per_unit); }

/// Lines of a cycle, and where they leave the axis along which it goes.
class GcodeCycle::Motions {
 public:
  Motions(const CycleStart& start, std::vector<std::string>& lines)
      : letter_(kAxisLetters.at(start.normal)),
        is_incremental_(start.is_incremental),
        at_(start.stated(start.place)),
        lines_(lines) {}

  void rapid_to(double depth) {
    if (depth != at_) move("G0", depth);
  }
  void rapid_to(const std::string& in_plane, double depth) { move("G0" + in_plane, depth); }
  void rapid(const std::string& in_plane) {
    if (!in_plane.empty()) lines_.push_back("G0" + in_plane);
  }
  void feed_to(double depth) { move("G1", depth); }
  void dwell(double time) { lines_.push_back("G4 P" + number(time)); }

 private:
  void move(std::string_view code, double depth) {
    lines_.push_back(fmt::format("{} {}{}", code, letter_, number(is_incremental_ ? depth - at_ : depth)));
    at_ = depth;
  }

  char letter_;
  bool is_incremental_;
  double at_;
  std::vector<std::string>& lines_;
};

/// Heights of a hole, in the unit of the program.
struct GcodeCycle::Hole {
  double start;      ///< where the axis stands
  double initial;    ///< where it stood before the first of several cycles
  double clearance;  ///< R
  double bottom;
  double back;   ///< where it is left
  double times;  ///< L
};

void GcodeCycle::choose(int code, bool goes_on) {
  if (!goes_on || code != code_) clearance_ = bottom_ = peck_ = dwell_ = std::nullopt;
  if (!goes_on) initial_level_.reset();
  code_ = code;
}

void GcodeCycle::choose_path_mode(const GcodeBlock& block, int code) {
  path_mode_ = fmt::format("G{}", code / 10.0);
  if (code != 640) return;
  for (const char letter : {'P', 'Q'}) {
    const GcodeWord* const word = block.word(letter);
    if (word == nullptr || !path_mode_) continue;
    if (word->is_number()) {
      path_mode_->append(fmt::format(" {}{}", letter, number(word->value)));
    } else {
      path_mode_.reset();
    }
  }
}

void GcodeCycle::forget() {
  choose(0, false);
  returns_to_clearance_.reset();
  path_mode_.reset();
  is_expanded_ = false;
}

void GcodeCycle::take(const GcodeBlock& block, std::size_t normal) {
  const auto take_word = [&](char letter, std::optional<double>& into) {
    const GcodeWord* const word = block.word(letter);
    if (word != nullptr) into = word->is_number() ? std::optional(word->value) : std::nullopt;
  };
  take_word(kAxisLetters.at(normal), bottom_);
  take_word('R', clearance_);
  take_word('Q', peck_);
  take_word('P', dwell_);
}

std::string_view GcodeCycle::find_hole(const GcodeBlock& block, const CycleStart& start, Hole& hole) const {
  if (std::ranges::find(kMotionsAlone, code_) == kMotionsAlone.end()) return kSpindle;
  const GcodeWord* const repeats = block.word('L');
  const bool has_dwell = dwell_ || !dwells(), has_peck = !pecks() || (peck_ && *peck_ > 0.0);
  const bool has_repeats = repeats == nullptr || repeats->is_number();
  if (!(clearance_ && bottom_ && has_dwell && has_peck && has_repeats)) return kIncomplete;
  hole.start = start.stated(start.place);
  hole.initial = start.stated(initial_level_.value_or(start.place));
  hole.clearance = rounded(start.is_incremental ? hole.initial + *clearance_ : *clearance_);
  hole.bottom = rounded(start.is_incremental ? hole.clearance + *bottom_ : *bottom_);
  hole.back = returns_to_clearance_.value_or(true) ? hole.clearance : std::max(hole.initial, hole.clearance);
  hole.times = repeats != nullptr ? repeats->value : 1.0;
  const bool is_sound = hole.bottom <= hole.clearance && hole.times >= 1.0 && hole.times == std::round(hole.times);
  if (!is_sound) return kIncomplete;
  if (hole.initial > hole.clearance && !returns_to_clearance_) return kReturn;
  if (!path_mode_) return kPathMode;
  const double pieces = hole.times * (pecks() ? (hole.clearance - hole.bottom) / *peck_ : 1.0);
  return pieces > kMostStrokes ? kTooMany : std::string_view();
}

std::string_view GcodeCycle::expand(const GcodeBlock& block, std::optional<std::size_t> motion_at,
                                    const CycleStart& start, std::vector<std::string>& lines) {
  Hole hole;
  if (const std::string_view reason = find_hole(block, start, hole); !reason.empty()) return reason;
  const bool is_exact = *path_mode_ == "G61";
  const std::string rest = without_motion(block, motion_at), in_plane = approach(block, start.normal);
  if (!rest.empty()) lines.push_back(rest);
  if (!is_exact) lines.emplace_back("G61");
  Motions motions(start, lines);
  // A first cycle rises to its clearance before it goes anywhere, the next ones on their way.
  if (hole.start < hole.clearance && !initial_level_) motions.rapid_to(hole.clearance);
  const bool rises = initial_level_ && hole.start <= hole.clearance && hole.start != hole.back;
  rises ? motions.rapid_to(in_plane, hole.back) : motions.rapid(in_plane);
  for (double done = 0.0; done < hole.times; ++done) {
    if (done > 0.0 && start.is_incremental) motions.rapid(in_plane);
    motions.rapid_to(hole.clearance);
    drill(hole, kPeckClearance / start.mm_per_unit, motions);
  }
  if (!is_exact) lines.push_back(*path_mode_);
  if (!initial_level_) initial_level_ = start.place;
  is_expanded_ = true;
  return {};
}

/// From the clearance plane to the bottom and back.
void GcodeCycle::drill(const Hole& hole, double back_off, Motions& motions) {
  const double peck = pecks() ? *peck_ : hole.clearance - hole.bottom;
  for (double depth = hole.clearance - peck; depth > hole.bottom; depth -= peck) {
    motions.feed_to(depth);
    if (code_ == 830) motions.rapid_to(hole.clearance);
    motions.rapid_to(depth + back_off);
    has_pecked_ = true;
  }
  motions.feed_to(hole.bottom);
  if (dwells()) motions.dwell(*dwell_);
  if (code_ == 850) motions.feed_to(hole.clearance);
  code_ == 890 ? motions.feed_to(hole.back) : motions.rapid_to(hole.back);
}

std::vector<std::string> GcodeCycle::restated(const GcodeBlock& block, std::size_t normal) {
  is_expanded_ = false;
  std::string added;
  const auto first = std::ranges::find_if(block.words, [](const GcodeWord& word) { return word.letter != 'N'; });
  const bool is_chosen = std::ranges::any_of(block.words, [this](const GcodeWord& word) {
    return word.letter == 'G' && word.is_number() && std::lround(10.0 * word.value) == code_;
  });
  if (!is_chosen) added += fmt::format("G{} ", number(code_ / 10.0));
  const auto add = [&](char letter, const std::optional<double>& value) {
    if (value && block.word(letter) == nullptr) added += fmt::format("{}{} ", letter, number(*value));
  };
  add(kAxisLetters.at(normal), bottom_);
  add('R', clearance_);
  add('Q', peck_);
  add('P', dwell_);
  if (added.empty()) return {};
  return {std::string(block.text).insert(first->at, added)};
}

}  // namespace paracal::io
