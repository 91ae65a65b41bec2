#include <algorithm>
#include <optional>
#include <utility>

#include "io/files/line_reader.hpp"
#include "io/tables/columns.hpp"
#include "joint_loads.hpp"
#include "passed_tally.hpp"
#include "path_division.hpp"
#include "target_line.hpp"
#include "target_writer.hpp"

namespace paracal::io {
namespace {

constexpr const char* kUnknownFeed =
    "motions without a stated feed (F) may take a different time, because the correction changes their length";
constexpr std::string_view kUnreachable = "out of reach or singular";

/// Targets that are corrected together.
constexpr std::size_t kTargetsAtOnce = std::size_t{1} << 15U;

bool is_within(const Workspace& workspace, const Pose& pose) {
  constexpr double kSlack = 1e-6;  // mm and rad
  for (int about = 0; about < 3; ++about) {
    if (std::abs(pose.tilt(about)) > workspace.tilt_about(about) + kSlack) return false;
  }
  return workspace.contains(pose.position, kSlack) && pose.rotation <= workspace.max_rotation + kSlack &&
         pose.rotation >= workspace.min_rotation - kSlack;
}

/// What is told of a program as a whole.
class TargetAccount {
 public:
  TargetAccount(const Robot& robot, const RobotAxes& axes, FilterSummary& summary)
      : workspace_(robot.workspace()), axes_(axes), summary_(summary) {}

  void add(const TargetLine& line, const AxisValues& target) {
    ++summary_.corrected;
    const CorrectedTarget one{line.number, axes_.pose_at(line.path.to), axes_.pose_at(target)};
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
  const RobotAxes& axes_;
  FilterSummary& summary_;
};

/// What all lines of a stream share.
struct Filtering {
  Filtering(const TargetCorrection& with, const FilterSettings& how, const TextSink& to)
      : correction(with), settings(how), division(with, how), out(to), writer(text, how.axes.moved()) {}

  void flush() {
    if (!text.empty()) out(std::exchange(text, {}));
  }

  const TargetCorrection& correction;
  const FilterSettings& settings;
  PathDivision division;
  const TextSink& out;
  std::string text = {};
  TargetWriter writer;
  FilterSummary summary = {};
  TargetAccount account{correction.robot(), settings.axes, summary};
  JointLoads loads{correction, settings.axes, summary};
  PassedTally tally = {};
};

/// Lines that were read together, and those of them that state targets.
class Passage {
 public:
  explicit Passage(Filtering& filtering) : filtering_(filtering) {}

  void read(std::span<const Line> lines, TargetFormat& format) {
    lines_.reserve(lines.size());
    stated_.reserve(lines.size());
    for (const Line& line : lines) take(line, format);
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
    pass_before(lines_.size());
    filtering_.flush();
  }

 private:
  /// A line that was passed through.
  struct Passed {
    std::string_view reason;
    std::size_t index;  ///< of lines_
    TargetLine::Weight weight;
  };

  void take(const Line& line, TargetFormat& format) {
    TargetLine stated{.index = lines_.size(), .number = line.number};
    const std::string_view passed = format.read(without_end(line.text), stated);
    if (stated.kind != TargetLine::Kind::none) stated_.push_back(stated);
    if (!passed.empty()) {
      passed_.push_back({passed, lines_.size(), stated.breaks ? TargetLine::Weight::work : stated.weight});
    }
    lines_.push_back(line);
  }

  static void add_places(const TargetLine& line, std::uint32_t pieces, std::vector<AxisValues>& places) {
    if (line.kind != TargetLine::Kind::target) return;
    for (std::uint32_t k = 1; k <= pieces; ++k) {
      places.push_back(line.path.at(static_cast<double>(k) / static_cast<double>(pieces)));
    }
  }

  void pass_before(std::size_t index) {
    for (; pass_ < passed_.size() && passed_[pass_].index < index; ++pass_) {
      filtering_.tally.pass(passed_[pass_].reason, lines_[passed_[pass_].index].number, passed_[pass_].weight);
    }
  }

  void write_line(const TargetLine& line, const PathDivision::Cut& cut) {
    pass_before(line.index);
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
        pass(line, content, end);
    }
    filtering_.text += end;
  }

  void pass(const TargetLine& line, std::string_view content, std::string_view end) {
    filtering_.summary.added += static_cast<std::int64_t>(filtering_.writer.pass(content, end, line));
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
      filtering_.tally.pass(is_reached ? cut.hindrance : kUnreachable, line.number, weight_of_left(line, is_reached));
    }
    if (!is_reached || (line.path.is_arc() && !cut.hindrance.empty())) return pass(line, content, end);
    filtering_.summary.added += static_cast<std::int64_t>(filtering_.writer.write(content, end, line, reached_));
    filtering_.account.add(line, reached_.back());
    filtering_.loads.add(line);
    filtering_.tally.correct();
  }

  /// A rapid that the plate could not follow has been stated: the program wants to be there.
  static TargetLine::Weight weight_of_left(const TargetLine& line, bool is_reached) {
    return is_reached || line.weight == TargetLine::Weight::work ? line.weight : TargetLine::Weight::approach;
  }

  Filtering& filtering_;
  std::vector<Line> lines_;
  std::vector<TargetLine> stated_;
  std::vector<Passed> passed_;
  std::size_t next_ = 0, pass_ = 0, next_target_ = 0;  ///< of lines_, passed_, targets_
  std::vector<std::optional<AxisValues>> targets_;
  std::vector<AxisValues> reached_;  ///< of one line
};

}  // namespace

FilterSummary filter(LineReader& in, const TextSink& out, TargetFormat& format, const TargetCorrection& correction,
                     const FilterSettings& settings) {
  Filtering filtering(correction, settings, out);
  for (auto lines = in.next(); !lines.empty(); lines = in.next()) {
    Passage passage(filtering);
    passage.read(lines, format);
    passage.write();
  }
  format.finish();
  filtering.summary.lines = in.count();
  filtering.summary.passed = filtering.tally.sorted();
  filtering.summary.assumed = format.assumed();
  if (filtering.correction.robot().nominal().spare_limbs() > 0) filtering.summary.assumed.emplace_back(kSpareLimbs);
  if (filtering.writer.has_unknown_feed()) filtering.summary.assumed.emplace_back(kUnknownFeed);
  return filtering.summary;
}

}  // namespace paracal::io
