#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "columns.hpp"
#include "line_reader.hpp"
#include "passed_tally.hpp"
#include "path_division.hpp"
#include "target_line.hpp"
#include "target_writer.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kTooLong = "a line longer than 64 KiB";
constexpr std::string_view kUnreachable = "out of reach or singular";

/// Targets that are corrected together.
constexpr std::size_t kTargetsAtOnce = std::size_t{1} << 15U;

bool is_within(const Workspace& workspace, const Pose& pose) {
  constexpr double kSlack = 1e-6;  // mm and rad
  return workspace.contains(pose.position, kSlack) && pose.rotation <= workspace.max_rotation + kSlack &&
         pose.rotation >= workspace.min_rotation - kSlack;
}

/// What is told of a program as a whole.
class TargetAccount {
 public:
  TargetAccount(const Robot& robot, const Eigen::Vector3d& origin, FilterSummary& summary)
      : workspace_(robot.workspace()), origin_(origin), summary_(summary) {}

  void add(const TargetLine& line, const AxisValues& target) {
    ++summary_.corrected;
    const CorrectedTarget one{line.number, pose_at(line.path.to, origin_), pose_at(target, origin_)};
    if (!is_within(workspace_, one.wanted) && summary_.outside++ == 0) summary_.first_outside = line.number;
    auto& farthest = summary_.farthest;
    if (farthest.size() == kFarthest && one.distance() <= farthest.back().distance()) return;
    if (farthest.size() == kFarthest) farthest.pop_back();
    farthest.insert(std::ranges::upper_bound(farthest, one.distance(), std::greater{}, &CorrectedTarget::distance),
                    one);
  }

 private:
  static constexpr std::size_t kFarthest = 10;

  const Workspace& workspace_;
  const Eigen::Vector3d& origin_;
  FilterSummary& summary_;
};

/// What all lines of a stream share.
struct Filtering {
  Filtering(const TargetCorrection& with, const FilterSettings& how, const TextSink& to)
      : correction(with), settings(how), division(with, how), out(to), writer(text, with.robot().limb_count()) {}

  void flush() {
    if (!text.empty()) out(std::exchange(text, {}));
  }

  const TargetCorrection& correction;
  const FilterSettings& settings;
  PathDivision division;
  const TextSink& out;
  std::string text = {};
  TargetWriter writer;  ///< of as many axes as limbs
  FilterSummary summary = {};
  TargetAccount account{correction.robot(), settings.origin, summary};
  PassedTally tally = {};
};

/// Lines that were read together, and those of them that state targets.
class Passage {
 public:
  Passage(std::span<const Line> lines, Filtering& filtering) : lines_(lines), filtering_(filtering) {}

  void read(TargetFormat& format) {
    stated_.reserve(lines_.size());
    for (std::size_t index = 0; index < lines_.size(); ++index) {
      if (lines_[index].part == Line::Part::rest_of_long) continue;
      TargetLine line{.index = index, .number = lines_[index].number};
      std::string_view passed = kTooLong;
      if (lines_[index].part == Line::Part::start_of_long) {
        format.skip();
      } else {
        passed = format.read(without_end(lines_[index].text), line);
        if (line.kind != TargetLine::Kind::none) stated_.push_back(line);
      }
      if (!passed.empty()) passed_.emplace_back(passed, line.number);
    }
  }

  void write() {
    const auto cuts = filtering_.division.cut(stated_);
    for (std::size_t first = 0; first < stated_.size();) {
      std::size_t last = first;
      std::vector<AxisValues> places;
      for (; last < stated_.size() && places.size() < kTargetsAtOnce; ++last) {
        add_places(stated_[last], cuts[last].pieces, places);
      }
      targets_ = corrected(filtering_.correction, filtering_.settings, places);
      next_target_ = 0;
      for (; first < last; ++first) write_line(stated_[first], cuts[first]);
      filtering_.flush();
    }
    for (; next_ < lines_.size(); ++next_) filtering_.text += lines_[next_].text;
    pass_before(std::numeric_limits<std::int64_t>::max());
    filtering_.flush();
  }

 private:
  static void add_places(const TargetLine& line, std::uint32_t pieces, std::vector<AxisValues>& places) {
    if (line.kind != TargetLine::Kind::target) return;
    for (std::uint32_t k = 1; k <= pieces; ++k) {
      places.push_back(line.path.at(static_cast<double>(k) / static_cast<double>(pieces)));
    }
  }

  void pass_before(std::int64_t line) {
    for (; pass_ < passed_.size() && passed_[pass_].second < line; ++pass_) {
      filtering_.tally.pass(passed_[pass_].first, passed_[pass_].second);
    }
  }

  void write_line(const TargetLine& line, const PathDivision::Cut& cut) {
    pass_before(line.number);
    for (; next_ < line.index; ++next_) filtering_.text += lines_[next_].text;
    const std::string_view whole = lines_[next_++].text;
    const std::string_view content = without_end(whole), end = whole.substr(content.size());
    switch (line.kind) {
      case TargetLine::Kind::target:
        write_target(line, cut, content, end);
        break;
      case TargetLine::Kind::here:
        filtering_.writer.call(content, line);
        break;
      default:
        filtering_.writer.pass(content, line);
    }
    filtering_.text += end;
  }

  void write_target(const TargetLine& line, const PathDivision::Cut& cut, std::string_view content,
                    std::string_view end) {
    reached_.clear();
    for (std::uint32_t k = 0; k < cut.pieces; ++k) {
      const std::optional<AxisValues>& target = targets_[next_target_++];
      if (target) reached_.push_back(*target);
    }
    const bool is_reached = reached_.size() == cut.pieces;
    if (!is_reached || !cut.hindrance.empty()) {
      filtering_.tally.pass(is_reached ? cut.hindrance : kUnreachable, line.number);
    }
    if (!is_reached || (line.path.is_arc() && !cut.hindrance.empty())) return filtering_.writer.pass(content, line);
    filtering_.summary.added += static_cast<std::int64_t>(filtering_.writer.write(content, end, line, reached_));
    filtering_.account.add(line, reached_.back());
    filtering_.tally.correct();
  }

  std::span<const Line> lines_;
  Filtering& filtering_;
  std::vector<TargetLine> stated_;
  std::vector<std::pair<std::string_view, std::int64_t>> passed_;  ///< why, and in which line
  std::size_t next_ = 0, pass_ = 0, next_target_ = 0;              ///< of lines_, passed_, targets_
  std::vector<std::optional<AxisValues>> targets_;
  std::vector<AxisValues> reached_;  ///< of one line
};

}  // namespace

FilterSummary filter(LineSource& in, const TextSink& out, TargetFormat& format, const TargetCorrection& correction,
                     const FilterSettings& settings) {
  Filtering filtering(correction, settings, out);
  for (auto lines = in.next(); !lines.empty(); lines = in.next()) {
    Passage passage(lines, filtering);
    passage.read(format);
    passage.write();
  }
  format.finish();
  filtering.summary.lines = in.count();
  filtering.summary.passed = filtering.tally.sorted();
  filtering.summary.assumed = format.assumed();
  return filtering.summary;
}

}  // namespace paracal::io
