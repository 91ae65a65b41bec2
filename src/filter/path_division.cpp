#include "path_division.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>

#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kTooFine = "a line of more than 10000 pieces (increase --chord-mm)";
constexpr std::uint32_t kMostPieces = 10'000;

constexpr double kSagittaShare = 0.9;      ///< of the chord; the rest is the correction's
constexpr double kLever = 100.0;           ///< mm from the axes of A, B and C
constexpr double kFreeTurn = 1.0;          ///< deg of these without a look at how the correction bends
constexpr double kCurvatureMargin = 10.0;  ///< the sharpest bend is not among the samples
constexpr double kSampleStep = 20.0;       ///< mm
constexpr std::size_t kPlacesAtOnce = std::size_t{1} << 16U;
constexpr std::uint32_t kProbes = 4;  ///< a piece: at a quarter, a half and three quarters of it

AxisValues correction_of(const AxisValues& target, const AxisValues& wanted) {
  AxisValues difference;
  for (std::size_t axis = 0; axis < kAxes; ++axis) difference[axis] = target[axis] - wanted[axis];
  return difference;
}

/// |at - ((1 - t) start + t end)|, mm
double bend(const AxisValues& start, const AxisValues& at, const AxisValues& end, double t) {
  AxisValues off;
  for (std::size_t axis = 0; axis < kAxes; ++axis) off[axis] = at[axis] - (start[axis] + t * (end[axis] - start[axis]));
  const double turned = std::abs(off[3]) + std::abs(off[4]) + std::abs(off[5]);
  return std::max(std::hypot(off[0], off[1], off[2]), kLever * to_radians(turned));
}

/// Places of the workspace, its axis and its rims, in the frame of paths.
std::vector<AxisValues> samples(const Robot& robot, const RobotAxes& axes) {
  std::vector<Pose> poses = robot.workspace().rim(8);
  std::ranges::copy(robot.workspace().rim(8, 0.5), std::back_inserter(poses));
  poses.push_back({robot.workspace().centre(), 0.0});
  std::vector<AxisValues> places;
  places.reserve(poses.size());
  for (const Pose& pose : poses) places.push_back(axes.place_of(pose));
  return places;
}

/// Length of the lines that bend by less than a tenth of the chord as far as the workspace's sharpest bend tells, mm.
///
///   bend <= K l^2 / 8,   K = max |c(p + h) - 2 c(p) + c(p - h)| / |h|^2
double straight_length(const TargetCorrection& correction, const FilterSettings& settings) {
  std::vector<AxisValues> places;
  for (const AxisValues& place : samples(correction.robot(), settings.axes)) {
    for (const std::size_t axis : settings.axes.moved()) {
      if (axis >= kFirstTurn) break;
      AxisValues before = place, after = place;
      before[axis] -= kSampleStep;
      after[axis] += kSampleStep;
      places.insert(places.end(), {before, place, after});
    }
  }
  const auto targets = corrected(correction, settings, places);
  double sharpest = 0.0;
  for (std::size_t k = 0; k < places.size(); k += 3) {
    if (!targets[k] || !targets[k + 1] || !targets[k + 2]) continue;
    const double off = bend(correction_of(*targets[k], places[k]), correction_of(*targets[k + 1], places[k + 1]),
                            correction_of(*targets[k + 2], places[k + 2]), 0.5);
    sharpest = std::max(sharpest, 2.0 * off / (kSampleStep * kSampleStep));
  }
  if (sharpest == 0.0) return std::numeric_limits<double>::max();
  return std::sqrt(8.0 * settings.chord / (kCurvatureMargin * sharpest));
}

/// The farthest that pieces bend, of a line that is probed at even steps; nothing where a probe cannot be corrected.
std::optional<double> farthest_bend(std::span<const AxisValues> places,
                                    std::span<const std::optional<AxisValues>> targets) {
  std::vector<AxisValues> corrections;
  corrections.reserve(places.size());
  for (std::size_t j = 0; j < places.size(); ++j) {
    if (!targets[j]) return std::nullopt;
    corrections.push_back(correction_of(*targets[j], places[j]));
  }
  double farthest = 0.0;
  for (std::size_t j = 0; j + 1 < places.size(); ++j) {
    const std::size_t inside = j % kProbes, start = j - inside;
    farthest = std::max(farthest, bend(corrections[start], corrections[j], corrections[start + kProbes],
                                       static_cast<double>(inside) / kProbes));
  }
  return farthest;
}

}  // namespace

std::vector<std::optional<AxisValues>> corrected(const TargetCorrection& correction, const FilterSettings& settings,
                                                 std::span<const AxisValues> places) {
  std::vector<Pose> wanted;
  wanted.reserve(places.size());
  for (const AxisValues& place : places) wanted.push_back(settings.axes.pose_at(place));
  std::vector<std::optional<Pose>> poses(places.size());
  correction.targets(wanted, poses, settings.threads);
  std::vector<std::optional<AxisValues>> targets(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (poses[k]) targets[k] = settings.axes.place_of(*poses[k]);
  }
  return targets;
}

PathDivision::PathDivision(const TargetCorrection& correction, const FilterSettings& settings)
    : correction_(correction),
      settings_(settings),
      straight_length_(settings.chord > 0.0 ? straight_length(correction, settings)
                                            : std::numeric_limits<double>::max()) {}

/// Sagitta of a chord over the angle a: r (1 - cos(a / 2)).
PathDivision::Cut PathDivision::cut_arc(const TargetLine& line) const {
  if (!line.divided.hindrance.empty()) return {1, line.divided.hindrance};
  const ArcOfPath& arc = line.path.arc;
  const double radius = std::max(arc.start_radius, arc.end_radius);
  const double cosine = std::max(1.0 - kSagittaShare * settings_.chord / radius, std::numbers::sqrt2 / 2.0);
  const double turns = std::abs(arc.sweep) / (2.0 * std::acos(cosine));
  const double pieces = std::ceil(std::max(1.0, turns));
  if (!(pieces <= kMostPieces)) return {1, kTooFine};
  return {static_cast<std::uint32_t>(pieces)};
}

/// @param pieces  as which the line is short enough not to be looked at for its length.
bool PathDivision::may_bend(const TargetLine& line, std::uint32_t pieces) const {
  return settings_.chord > 0.0 && line.starts_known &&
         (line.path.length() > pieces * straight_length_ || line.path.turned() > kFreeTurn);
}

std::vector<PathDivision::Cut> PathDivision::cut(std::span<const TargetLine> lines) const {
  std::vector<Cut> cuts(lines.size());
  std::vector<Trial> trials;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].kind != TargetLine::Kind::target) continue;
    if (lines[k].path.is_arc()) cuts[k] = cut_arc(lines[k]);
    if (cuts[k].hindrance.empty() && may_bend(lines[k], cuts[k].pieces)) trials.push_back({k, cuts[k].pieces});
  }
  cut_bent(lines, std::move(trials), cuts);
  return cuts;
}

/// Finer until none bends farther than the chord, or what the sagitta of an arc leaves of it.
void PathDivision::cut_bent(std::span<const TargetLine> lines, std::vector<Trial> trials,
                            std::vector<Cut>& cuts) const {
  while (!trials.empty()) {
    std::vector<Trial> together;
    std::vector<AxisValues> places;
    for (; !trials.empty() && places.size() < kPlacesAtOnce; trials.pop_back()) {
      together.push_back(trials.back());
      const std::uint32_t steps = kProbes * together.back().pieces;
      for (std::uint32_t j = 0; j <= steps; ++j) {
        places.push_back(lines[together.back().line].path.at(static_cast<double>(j) / static_cast<double>(steps)));
      }
    }
    const auto targets = corrected(correction_, settings_, places);
    std::size_t first = 0;
    for (const Trial& trial : together) {
      const std::size_t count = kProbes * trial.pieces + 1;
      const TargetLine& line = lines[trial.line];
      const auto bent =
          farthest_bend(std::span(places).subspan(first, count), std::span(targets).subspan(first, count));
      first += count;
      const double most = line.path.is_arc() ? (1.0 - kSagittaShare) * settings_.chord : settings_.chord;
      cuts[trial.line] = {trial.pieces};
      if (!bent || *bent <= most) continue;  // the target itself tells what cannot be corrected
      const double pieces = std::ceil(trial.pieces * std::max(1.1, std::sqrt(*bent / most)));
      if (!line.divided.hindrance.empty() || pieces > kMostPieces) {
        cuts[trial.line] = {1, line.divided.hindrance.empty() ? kTooFine : line.divided.hindrance};
      } else {
        trials.push_back({trial.line, static_cast<std::uint32_t>(pieces)});
      }
    }
  }
}

}  // namespace paracal::io
