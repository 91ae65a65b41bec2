#include "target_line.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "columns.hpp"
#include "gcode_block.hpp"
#include "line_reader.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kTooLong = "a line longer than 64 KiB";
constexpr std::string_view kUnreachable = "out of reach or singular";

Pose in_robot(const AxisValues& wanted, const Eigen::Vector3d& origin) {
  return {origin + Eigen::Vector3d(wanted[0], wanted[1], wanted[2]), to_radians(wanted[kRotation])};
}

AxisValues in_program(const Pose& target, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d r = target.position - origin;
  return {r.x(), r.y(), r.z(), to_degrees(target.rotation)};
}

int decimals_of(std::string_view number) {
  const std::size_t point = number.find('.');
  if (point == std::string_view::npos) return 0;
  const std::size_t exponent = std::min(number.find_first_of("eE", point), number.size());
  return static_cast<int>(std::min<std::size_t>(exponent - point - 1, 99));
}

/// How many decimals a number of an axis gets: as many as it had, at least what 0.1 um needs (for phi at 500 mm from
/// its axis), at most what a correction is worth.
struct Decimals {
  int least, most;
};

Decimals decimals_for(std::size_t axis, double mm_per_unit) {
  if (axis == kRotation) return {5, 7};
  return mm_per_unit == 1.0 ? Decimals{4, 7} : Decimals{6, 8};
}

constexpr std::array kPower{1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};

/// What a controller was told, and so holds for axes that a line does not state.
class Writer {
 public:
  Writer(std::string& out, std::size_t axis_count) : out_(out), axis_count_(axis_count) {}

  void write(std::string_view text, const TargetLine& line, const AxisValues& target) {
    const std::size_t start = out_.size();
    std::size_t copied = 0;
    order_by_place(line);
    for (const std::size_t axis : order_) {
      const StatedNumber& number = line.stated[axis];
      if (!number.is_stated()) continue;
      const Decimals limits = decimals_for(axis, line.mm_per_unit);
      const std::string_view old = text.substr(number.begin, number.end - number.begin);
      const int decimals = std::clamp(decimals_of(old), limits.least, limits.most);
      const double value = target[axis] / unit_of(axis, line);
      told_[axis] = number.value * unit_of(axis, line);
      if (!differs(value, number.value, decimals)) continue;
      out_.append(text, copied, number.begin - copied);
      append_number(axis, value, decimals, line);
      copied = number.end;
    }
    if (line.may_insert) copied = insert_others(text, line, target, copied);
    const std::size_t rest = line.checksum_at != 0 ? line.checksum_at : text.size();
    out_.append(text, copied, rest - copied);
    if (line.checksum_at != 0) append_checksum(text.substr(rest), start, text.substr(0, rest));
  }

  /// A target that was not corrected after all.
  void pass(std::string_view text, const TargetLine& line) {
    out_ += text;
    for (std::size_t axis = 0; axis < axis_count_; ++axis) {
      if (line.stated[axis].is_stated() || line.passed[axis]) told_[axis] = line.wanted[axis];
    }
  }

 private:
  static double unit_of(std::size_t axis, const TargetLine& line) { return axis == kRotation ? 1.0 : line.mm_per_unit; }

  /// Whether the last decimal would be another.
  static bool differs(double one, double other, int decimals) {
    return !(std::abs(one - other) * kPower[static_cast<std::size_t>(decimals)] < 0.5);
  }

  void order_by_place(const TargetLine& line) {
    order_ = {0, 1, 2, 3};
    const auto begin = [&line](std::size_t axis) { return line.stated[axis].begin; };
    if (!std::ranges::is_sorted(order_, {}, begin)) std::ranges::sort(order_, {}, begin);
  }

  void append_number(std::size_t axis, double value, int decimals, const TargetLine& line) {
    std::array<char, 400> text;  // the longest double
    const double rounded = std::abs(value) * kPower[static_cast<std::size_t>(decimals)] < 0.5 ? 0.0 : value;  // no -0
    const auto [end, error] =
        std::to_chars(text.data(), text.data() + text.size(), rounded, std::chars_format::fixed, decimals);
    out_.append(text.data(), end);
    double told = 0.0;
    std::from_chars(text.data(), end, told);
    told_[axis] = told * unit_of(axis, line);
  }

  /// Axes that the controller would leave where they are, though the target has moved in them.
  std::size_t insert_others(std::string_view text, const TargetLine& line, const AxisValues& target,
                            std::size_t copied) {
    for (std::size_t axis = 0; axis < axis_count_; ++axis) {
      if (line.stated[axis].is_stated()) continue;
      const double unit = unit_of(axis, line);
      const double held = line.passed[axis] ? line.wanted[axis] : told_[axis];
      told_[axis] = held;
      const int decimals = decimals_for(axis, line.mm_per_unit).least;
      if (!differs(target[axis] / unit, held / unit, decimals)) continue;
      out_.append(text, copied, line.insert_at - copied);
      copied = line.insert_at;
      if (line.with_blank) out_ += ' ';
      out_ += static_cast<char>(kAxisLetters[axis] + (line.in_lower_case ? 'a' - 'A' : 0));
      append_number(axis, target[axis] / unit, decimals, line);
    }
    return copied;
  }

  /// As it was where the line is as it was; computed anew where it is not.
  void append_checksum(std::string_view old, std::size_t start, std::string_view old_text) {
    const std::string_view written = std::string_view(out_).substr(start);
    if (written == old_text) {
      out_ += old;
      return;
    }
    const std::size_t digits_end = std::min(old.find_first_not_of("0123456789", 1), old.size());
    const std::string checksum = std::to_string(gcode_checksum(written));
    out_.append("*").append(checksum).append(old.substr(digits_end));
  }

  std::string& out_;
  std::size_t axis_count_;
  AxisValues told_{};
  std::array<std::size_t, kAxes> order_{};
};

}  // namespace

void Tally::pass(std::string_view reason, std::int64_t line) {
  const auto found = std::ranges::find(passed_, reason, &PassedThrough::reason);
  if (found == passed_.end()) since_.emplace_back();
  PassedThrough& entry = found != passed_.end() ? *found : passed_.emplace_back(PassedThrough{reason, 0, line});
  ++entry.count;
  if (!corrected_) return;  // on the way to the first
  Since& since = since_[static_cast<std::size_t>(&entry - passed_.data())];
  if (since.count++ == 0) since.first_line = line;
  passes_since_ = true;
}

void Tally::correct() {
  corrected_ = true;
  if (!std::exchange(passes_since_, false)) return;
  for (std::size_t k = 0; k < passed_.size(); ++k) {
    const Since since = std::exchange(since_[k], {});
    if (passed_[k].between == 0) passed_[k].first_between = since.first_line;
    passed_[k].between += since.count;
  }
}

std::vector<PassedThrough> Tally::sorted() const {
  std::vector<PassedThrough> result = passed_;
  std::ranges::sort(result, {}, &PassedThrough::first_line);
  return result;
}

namespace {

/// Lines that were read together, and those of them that state targets.
class Passage {
 public:
  Passage(std::span<const Line> lines, const TargetCorrection& correction, const Eigen::Vector3d& origin)
      : lines_(lines), correction_(correction), origin_(origin) {}

  void read(TargetFormat& format, FilterSummary& summary) {
    for (std::size_t index = 0; index < lines_.size(); ++index) {
      if (lines_[index].part == Line::Part::rest_of_long) continue;
      ++summary.lines;
      TargetLine line{.index = index, .number = summary.lines};
      std::string_view passed;
      if (lines_[index].part == Line::Part::start_of_long) {
        passed = kTooLong;
        format.skip();
      } else if (format.read(without_end(lines_[index].text), line, passed)) {
        targets_.push_back(line);
        wanted_.push_back(in_robot(line.wanted, origin_));
      }
      if (!passed.empty()) passed_.emplace_back(passed, summary.lines);
    }
  }

  void correct(unsigned threads) {
    corrected_.resize(wanted_.size());
    correction_.targets(wanted_, corrected_, threads);
  }

  void write(Writer& writer, std::string& text, FilterSummary& summary, Tally& tally) const {
    std::size_t next = 0;
    auto pass = passed_.begin();
    const auto pass_before = [&](std::int64_t line) {
      for (; pass != passed_.end() && pass->second < line; ++pass) tally.pass(pass->first, pass->second);
    };
    for (std::size_t k = 0; k < targets_.size(); ++k) {
      pass_before(targets_[k].number);
      for (; next < targets_[k].index; ++next) text += lines_[next].text;
      const std::string_view line = lines_[next++].text;
      const std::string_view content = without_end(line);
      if (corrected_[k]) {
        writer.write(content, targets_[k], in_program(*corrected_[k], origin_));
        ++summary.corrected;
        tally.correct();
      } else {
        writer.pass(content, targets_[k]);
        tally.pass(kUnreachable, targets_[k].number);
      }
      text += line.substr(content.size());
    }
    for (; next < lines_.size(); ++next) text += lines_[next].text;
    pass_before(std::numeric_limits<std::int64_t>::max());
  }

 private:
  std::span<const Line> lines_;
  const TargetCorrection& correction_;
  const Eigen::Vector3d& origin_;
  std::vector<TargetLine> targets_;
  std::vector<Pose> wanted_;
  std::vector<std::optional<Pose>> corrected_;
  std::vector<std::pair<std::string_view, std::int64_t>> passed_;  ///< why, and in which line
};

}  // namespace

FilterSummary filter(const TextStream& in, const TextSink& out, TargetFormat& format,
                     const TargetCorrection& correction, const Eigen::Vector3d& origin, unsigned threads) {
  LineReader reader(in);
  FilterSummary summary;
  Tally tally;
  std::string text;
  Writer writer(text, correction.robot().limb_count());  // as many axes as limbs
  for (auto lines = reader.next(); !lines.empty(); lines = reader.next()) {
    Passage passage(lines, correction, origin);
    passage.read(format, summary);
    passage.correct(threads);
    text.clear();
    passage.write(writer, text, summary, tally);
    out(text);
  }
  format.finish();
  summary.passed = tally.sorted();
  return summary;
}

}  // namespace paracal::io
