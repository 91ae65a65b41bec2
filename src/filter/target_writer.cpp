#include "target_writer.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "gcode_block.hpp"
#include "io/files/letters.hpp"

namespace paracal::io {
namespace {

int decimals_of(std::string_view number) {
  const std::size_t point = number.find('.');
  if (point == std::string_view::npos) return 0;
  const std::size_t exponent = std::min(number.find_first_of("eE", point), number.size());
  return static_cast<int>(std::min<std::size_t>(exponent - point - 1, 99));
}

/// How many decimals a number gets: as many as it had, at least what 0.1 um needs (for angles at 500 mm from their
/// axis), at most what a correction is worth.
struct Decimals {
  int least, most;

  int of(std::string_view number) const { return std::clamp(decimals_of(number), least, most); }
};

/// Of pieces of a line: the filament a mm is that of the line to 1e-9.
constexpr Decimals kExtrusionDecimals{9, 9};

constexpr double kSameTime = 0.01;  ///< a feed is stated anew where a block would take more or less by this share
constexpr int kDigitsOfFeed = 5;    ///< far more than the time of a block needs

Decimals decimals_for(std::size_t axis, double mm_per_unit) {
  if (axis >= kFirstTurn) return {5, 7};
  return mm_per_unit == 1.0 ? Decimals{4, 7} : Decimals{6, 8};
}

constexpr std::array kPower{1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

double unit_of(std::size_t axis, const TargetLine& line) { return axis >= kFirstTurn ? 1.0 : line.mm_per_unit; }

std::string_view text_of(std::string_view text, const StatedNumber& number) {
  return text.substr(number.begin, number.end - number.begin);
}

/// Whether the last decimal would be another.
bool differs(double one, double other, int decimals) {
  return !(std::abs(one - other) * kPower[static_cast<std::size_t>(decimals)] < 0.5);
}

/// @returns the number as it was written.
double append_number(std::string& to, double value, int decimals) {
  std::array<char, 400> text;  // the longest double
  const double rounded = std::abs(value) * kPower[static_cast<std::size_t>(decimals)] < 0.5 ? 0.0 : value;  // no -0
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), rounded, std::chars_format::fixed, decimals);
  to.append(text.data(), end);
  double written = 0.0;
  std::from_chars(text.data(), end, written);
  return written;
}

/// F with as many decimals as it takes.
void append_feed(std::string& to, double feed) {
  const int whole = feed > 0.0 ? static_cast<int>(std::floor(std::log10(feed))) + 1 : 1;
  append_number(to, feed, std::clamp(kDigitsOfFeed - whole, 0, 8));
  if (to.find('.', to.size() - std::min<std::size_t>(to.size(), 12)) == std::string::npos) return;
  while (to.ends_with('0')) to.pop_back();
  if (to.ends_with('.')) to.pop_back();
}

bool takes_as_long(double feed, double other) { return std::abs(feed - other) <= kSameTime * std::abs(other); }

char in_case_of(char letter, const TargetLine& line) {
  return static_cast<char>(letter + (line.in_lower_case ? 'a' - 'A' : 0));
}

/// The letter of a word that is added.
void append_word(std::string& text, char letter, const TargetLine& line) {
  if (line.with_blank) text += ' ';
  text += in_case_of(letter, line);
}

/// The number that names a place in a line.
double as_stated(std::size_t axis, double place, double from, const TargetLine& line) {
  return (place - (line.is_incremental ? from : line.shift[axis])) / unit_of(axis, line);
}

/// The place that a number names.
double as_place(std::size_t axis, double stated, double from, const TargetLine& line) {
  return stated * unit_of(axis, line) + (line.is_incremental ? from : line.shift[axis]);
}

}  // namespace

/// One of the pieces of a path, from the end of the one before to its target.
struct TargetWriter::Piece {
  const AxisValues& target;
  std::size_t number, count;  ///< from 0

  /// What an extruder's axis is told for this piece.
  double extrusion(const ExtrusionOfLine& of, int decimals) const {
    const auto until = [&](std::size_t pieces) {
      const double scale = kPower[static_cast<std::size_t>(decimals)];
      const double share = static_cast<double>(pieces) / static_cast<double>(count);
      return std::round((of.from + share * (of.stated.value - of.from)) * scale) / scale;
    };
    return of.is_relative ? until(number + 1) - until(number) : until(number + 1);  // the sum is as it was
  }
};

std::size_t TargetWriter::write(std::string_view text, std::string_view end, const TargetLine& line,
                                std::span<const AxisValues> targets) {
  for (const std::size_t axis : axes_) told_[axis] = held(axis, line);
  if (line.path.is_arc() && changes_nothing(line, targets)) {
    const std::size_t added = restore_feed(end, line);
    out_ += text;
    told_ = line.path.to;
    return added;
  }
  const std::size_t own = line.divided.stands_last ? targets.size() - 1 : 0;
  const std::string_view line_end = end.empty() ? "\n" : end;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const Piece piece{targets[k], k, targets.size()};
    if (k > own) out_ += line_end;
    k == own ? edit_line(text, line, piece) : append_piece(text, line, piece);
    if (k < own) out_ += line_end;
  }
  return targets.size() - 1;
}

void TargetWriter::call(std::string_view text, const TargetLine& line) {
  for (const std::size_t axis : axes_) {
    const StatedNumber& number = line.stated[axis];
    told_[axis] = held(axis, line);
    if (!number.is_stated()) continue;
    const int decimals = decimals_for(axis, line.mm_per_unit).of(text_of(text, number));
    const double value = number.value + (told_[axis] - line.path.to[axis]) / unit_of(axis, line);
    if (!differs(value, number.value, decimals)) continue;
    begin_edit(number.begin, number.end);
    append_number(edited_, value, decimals);
    end_edit();
  }
  apply(text);
}

std::size_t TargetWriter::restore_feed(std::string_view end, const TargetLine& line) {
  const bool restates = told_feed_ && !line.feed.stated.is_stated() && line.feed.restates();
  if (restates) {
    out_ += line.feed.is_stated_by_motions ? "G1 F" : "F";
    append_feed(out_, *line.feed.value);
    out_ += end.empty() ? "\n" : end;
  }
  told_feed_.reset();
  return restates ? 1 : 0;
}

std::size_t TargetWriter::pass(std::string_view text, std::string_view end, const TargetLine& line) {
  const std::size_t added = restore_feed(end, line);
  if (!line.restated.empty()) {
    begin_edit(line.divided.motion.begin, line.divided.motion.begin);
    edited_ += in_case_of('G', line);
    edited_.append(line.restated).append(" ");
    end_edit();
  }
  apply(text);
  for (const std::size_t axis : axes_) {
    if (line.kind != TargetLine::Kind::target) break;
    told_[axis] = held(axis, line);
    if (!line.stated[axis].is_stated()) continue;
    told_[axis] = line.is_incremental ? told_[axis] + (line.path.to[axis] - line.path.from[axis]) : line.path.to[axis];
  }
  return added;
}

double TargetWriter::held(std::size_t axis, const TargetLine& line) const {
  return line.passed[axis] ? line.path.from[axis] : told_[axis];
}

/// Of an arc: so it may stay one.
bool TargetWriter::changes_nothing(const TargetLine& line, std::span<const AxisValues> targets) const {
  for (const std::size_t axis : axes_) {
    const int decimals = decimals_for(axis, line.mm_per_unit).least;
    const auto is_same = [&](double one, double other) {
      return !differs(one / unit_of(axis, line), other / unit_of(axis, line), decimals);
    };
    if (!is_same(told_[axis], line.path.from[axis])) return false;
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const double t = static_cast<double>(k + 1) / static_cast<double>(targets.size());
      if (!is_same(targets[k][axis], line.path.at(t)[axis])) return false;
    }
  }
  return true;
}

bool TargetWriter::is_moved(std::size_t axis, const AxisValues& target, const TargetLine& line) const {
  const double unit = unit_of(axis, line);
  return differs(target[axis] / unit, told_[axis] / unit, decimals_for(axis, line.mm_per_unit).least);
}

void TargetWriter::edit_line(std::string_view text, const TargetLine& line, const Piece& piece) {
  const AxisValues from = told_;
  if (line.path.is_arc()) drop_arc(line);
  edit_axes(text, line, piece.target);
  if (piece.count > 1) edit_extrusion(text, line, piece);
  edit_feed(text, line, piece, from);
  apply(text);
}

/// An arc's chords are straight lines, and have no centre.
void TargetWriter::drop_arc(const TargetLine& line) {
  const TextRange motion = line.divided.motion;
  begin_edit(motion.begin, motion.end);
  edited_ += in_case_of('G', line);
  edited_ += '1';
  if (motion.is_empty() && line.with_blank) edited_ += ' ';
  end_edit();
  for (const TextRange& word : line.divided.arc_words) {
    if (word.is_empty()) continue;
    begin_edit(word.begin, word.end);
    end_edit();
  }
}

void TargetWriter::edit_axes(std::string_view text, const TargetLine& line, const AxisValues& target) {
  for (const std::size_t axis : axes_) {
    const StatedNumber& number = line.stated[axis];
    const Decimals limits = decimals_for(axis, line.mm_per_unit);
    const double value = as_stated(axis, target[axis], told_[axis], line);
    if (number.is_stated()) {
      const int decimals = limits.of(text_of(text, number));
      double told = number.value;
      if (differs(value, number.value, decimals)) {
        begin_edit(number.begin, number.end);
        told = append_number(edited_, value, decimals);
        end_edit();
      }
      told_[axis] = as_place(axis, told, told_[axis], line);
    } else if (line.may_insert && is_moved(axis, target, line)) {
      begin_edit(line.insert_at, line.insert_at);
      append_word(edited_, kAxisLetters[axis], line);
      told_[axis] = as_place(axis, append_number(edited_, value, limits.least), told_[axis], line);
      end_edit();
    }
  }
}

/// The feed with which a piece takes its share of the block's time; nothing where that is not known.
std::optional<double> TargetWriter::feed_of(const TargetLine& line, const Piece& piece, const AxisValues& from) {
  const FeedOfLine& feed = line.feed;
  if (!feed.is_governed || !line.starts_known) return feed.value;
  const auto count = static_cast<double>(piece.count);
  if (feed.rule == FeedOfLine::Rule::inverse_time)
    return feed.value ? std::optional(*feed.value * count) : std::nullopt;
  const double before = feed.counted(line.path.length(), line.path.turned(), line.mm_per_unit);
  const TargetPath straight{.from = from, .to = told_};
  const double after = feed.counted(straight.length(), straight.turned(), line.mm_per_unit);
  if (before == 0.0 || after == 0.0) return feed.value;
  const double ratio = after * count / before;
  has_unknown_feed_ |= !feed.value && !takes_as_long(ratio, 1.0);
  return feed.value ? std::optional(takes_as_long(ratio, 1.0) ? *feed.value : *feed.value * ratio) : std::nullopt;
}

/// The F that a piece must state; nothing where what is in force will do.
std::optional<double> TargetWriter::word_of_feed(const TargetLine& line, const Piece& piece, const AxisValues& from) {
  const FeedOfLine& feed = line.feed;
  const std::optional<double> wanted = feed_of(line, piece, from);
  const bool is_stated = piece.number == 0 && feed.stated.is_stated();
  const auto as_stated = is_stated ? std::optional(feed.stated.value) : std::nullopt;
  if (is_stated) told_feed_.reset();
  if (!wanted || !feed.is_governed) return as_stated;
  const bool wants_programs = *wanted == *feed.value;
  if (feed.rule == FeedOfLine::Rule::inverse_time) return wants_programs ? as_stated : wanted;
  const bool will_do = wants_programs ? !told_feed_ : takes_as_long(*wanted, told_feed_.value_or(*feed.value));
  if (will_do) return as_stated;
  told_feed_ = wants_programs ? std::nullopt : wanted;
  return wanted;
}

void TargetWriter::edit_feed(std::string_view text, const TargetLine& line, const Piece& piece,
                             const AxisValues& from) {
  const StatedNumber& stated = line.feed.stated;
  const std::optional<double> word = word_of_feed(line, piece, from);
  if (word && stated.is_stated()) {
    if (*word == stated.value) return;
    begin_edit(stated.begin, stated.end);
    append_feed(edited_, *word);
    end_edit();
  } else if (word) {
    begin_edit(line.insert_at, line.insert_at);
    append_word(edited_, 'F', line);
    append_feed(edited_, *word);
    end_edit();
  } else if (stated.is_stated()) {  // an earlier piece has told it
    std::size_t begin = text.find_last_of("fF", stated.begin);
    while (begin > 0 && is_blank(text[begin - 1])) --begin;
    begin_edit(begin, stated.end);
    end_edit();
  }
}

void TargetWriter::edit_extrusion(std::string_view text, const TargetLine& line, const Piece& piece) {
  const StatedNumber& stated = line.divided.extrusion.stated;
  if (!stated.is_stated()) return;
  begin_edit(stated.begin, stated.end);
  append_extrusion(edited_, text, line, piece);
  end_edit();
}

void TargetWriter::append_extrusion(std::string& to, std::string_view text, const TargetLine& line,
                                    const Piece& piece) {
  const ExtrusionOfLine& extrusion = line.divided.extrusion;
  const int decimals = kExtrusionDecimals.of(text_of(text, extrusion.stated));
  append_number(to, piece.extrusion(extrusion, decimals), decimals);
}

/// A line of its own for a piece of the path.
void TargetWriter::append_piece(std::string_view text, const TargetLine& line, const Piece& piece) {
  const AxisValues from = told_;
  out_ += in_case_of('G', line);
  out_ += line.divided.is_rapid ? '0' : '1';
  for (const std::size_t axis : axes_) {
    if (!is_moved(axis, piece.target, line)) continue;
    append_word(out_, kAxisLetters[axis], line);
    const double value = as_stated(axis, piece.target[axis], told_[axis], line);
    const int decimals = decimals_for(axis, line.mm_per_unit).of(text_of(text, line.stated[axis]));
    told_[axis] = as_place(axis, append_number(out_, value, decimals), told_[axis], line);
  }
  if (line.divided.extrusion.stated.is_stated()) {
    append_word(out_, 'E', line);
    append_extrusion(out_, text, line, piece);
  }
  if (const std::optional<double> feed = word_of_feed(line, piece, from)) {
    append_word(out_, 'F', line);
    append_feed(out_, *feed);
  }
}

void TargetWriter::begin_edit(std::size_t begin, std::size_t end) {
  edits_.push_back({{begin, end}, edited_.size(), edited_.size()});
}

void TargetWriter::end_edit() { edits_.back().end = edited_.size(); }

void TargetWriter::apply(std::string_view text) {
  std::ranges::stable_sort(edits_, {}, [](const Edit& edit) { return edit.replaced.begin; });
  std::size_t copied = 0;
  for (const Edit& edit : edits_) {
    if (edit.replaced.begin > copied) out_.append(text, copied, edit.replaced.begin - copied);
    copied = std::max(copied, edit.replaced.end);
    out_.append(edited_, edit.begin, edit.end - edit.begin);
  }
  out_.append(text, copied);
  edits_.clear();
  edited_.clear();
}

}  // namespace paracal::io
