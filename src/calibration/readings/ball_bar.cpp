// Lengths of a ball bar, a draw wire, an interferometer that follows: from the plate centre to a fixed point,
//
//   ball bar   |r - c| + zero
//
// with c sought, and the zero where options let all such lengths share one (NoiseModel::distance_bias).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "length_model.hpp"
#include "numerics/dense.hpp"
#include "paracal/error.hpp"

namespace paracal::detail {
namespace {

constexpr Eigen::Index kZero = 3;  // place of the zero after the point

/// From the fixed point to a place; upwards where they are one.
Eigen::Vector3d direction(const Eigen::Vector3d& from_point) {
  constexpr double kNothing = 1e-9;  // mm
  const double length = from_point.norm();
  return length > kNothing ? Eigen::Vector3d(from_point / length) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

double sum_of_misses(const LengthsRead& read, const Eigen::Vector3d& point) {
  double sum = 0.0;
  for (std::size_t k = 0; k < read.places.size(); ++k) {
    sum += std::abs((read.places[k] - point).norm() - read.lengths[k]);
  }
  return sum;
}

/// Least absolute differences, which gross readings hardly move, by least squares with weights 1 / |difference|.
Eigen::Vector3d closest(const LengthsRead& read, Eigen::Vector3d point) {
  constexpr int kRounds = 40;
  constexpr double kSmallest = 0.01, kSettled = 1e-6;  // mm
  const Eigen::Index n = std::ssize(read.places);
  Eigen::MatrixX3d rows(n, 3);
  Eigen::VectorXd misses(n);
  for (int round = 0; round < kRounds; ++round) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Vector3d from = read.places[static_cast<std::size_t>(k)] - point;
      const double miss = from.norm() - read.lengths[static_cast<std::size_t>(k)];
      const double weight = 1.0 / std::sqrt(std::max(std::abs(miss), kSmallest));
      rows.row(k) = weight * direction(from).transpose();
      misses(k) = weight * miss;
    }
    const Eigen::Vector3d step = shortest_solution(rows, misses);
    point += step;
    if (!(step.norm() > kSettled)) break;
  }
  return point;
}

/// Across which the places are flattest, downwards.
Eigen::Vector3d flattest(const LengthsRead& read, const Eigen::Vector3d& middle) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& place : read.places) spread += (place - middle) * (place - middle).transpose();
  const Eigen::Vector3d normal = symmetric_eigen(spread).vectors.col(0);
  return normal.z() > 0.0 ? Eigen::Vector3d(-normal) : normal;
}

/// |p|^2 - L^2 = 2 p . c - |c|^2 is linear in c and |c|^2. Where the places lie in a plane it says how far from the
/// plane the point is, and not on which side.
Eigen::Vector3d trilaterated(const LengthsRead& read, const Eigen::Vector3d& middle, const Eigen::Vector3d& normal) {
  constexpr double kUnit = 100.0;  // mm, so that all columns are of a size
  const Eigen::Index n = std::ssize(read.places);
  Eigen::MatrixX4d rows(n, 4);
  Eigen::VectorXd right(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Vector3d p = (read.places[static_cast<std::size_t>(k)] - middle) / kUnit;
    rows.row(k) << 2.0 * p.transpose(), -1.0;
    right(k) = p.squaredNorm() - std::pow(read.lengths[static_cast<std::size_t>(k)] / kUnit, 2);
  }
  const Eigen::Vector4d found = shortest_solution(rows, right, 1e-2);  // flatter than that is flat
  const double beside = std::sqrt(std::max(found(3) - found.head<3>().squaredNorm(), 0.0));
  return middle + kUnit * (found.head<3>() + beside * normal);
}

/// Of places in a plane lengths show how far beside it the point is by the square alone: near the plane not at all, and
/// no fit settles.
void require_beside(const LengthsRead& read, const Eigen::Vector3d& middle, const Eigen::Vector3d& point,
                    const std::string& name) {
  constexpr double kFlat = 1e-3, kBeside = 10.0;  // mm
  const Eigen::Vector3d normal = flattest(read, middle);
  double out_of_plane = 0.0;
  for (const Eigen::Vector3d& place : read.places) {
    out_of_plane = std::max(out_of_plane, std::abs(normal.dot(place - middle)));
  }
  if (out_of_plane > kFlat || std::abs(normal.dot(point - middle)) > kBeside) return;
  throw Unreachable(
      fmt::format("the poses of {} lie in one plane with the fixed point, so its distance from that plane is "
                  "uncertain. Place it at least 20 mm outside the plane",
                  name));
}

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& places) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) sum += place;
  return sum / static_cast<double>(std::max<std::size_t>(places.size(), 1));
}

class BallBar final : public LengthModel {
 public:
  LengthWords words() const override {
    return {.kind = LengthKind::ball_bar,
            .name = "ball-bar",
            .noun = "ball-bar length",
            .plural = "ball-bar lengths",
            .column = "ball_bar_mm",
            .list = "ball_bar_lengths",
            .set_ups = "ball_bars",
            .reversed = {},
            .at_columns = {"centre_x_mm", "centre_y_mm", "centre_z_mm"},
            .at = "approximate position of the fixed point, mm",
            .positive = true,
            .sigma = &NoiseModel::distance};
  }
  bool shows_scale() const override { return true; }

  SetUp units(const CalibrationOptions& options) const override {
    constexpr double kPoint = 100.0;  // mm
    SetUp units = Eigen::Vector3d::Constant(kPoint);
    if (options.noise.distance_bias > 0.0) {
      units.conservativeResize(kZero + 1);
      units(kZero) = options.noise.distance_bias;
    }
    return units;
  }

  LengthShown shown(const Eigen::Vector3d& place, const SetUp& set_up, const LengthSeries& /*series*/) const override {
    const Eigen::Vector3d from = place - set_up.head<3>();
    LengthShown shown{from.norm(), direction(from).transpose(), {}};
    shown.by_set_up.resize(set_up.size());
    shown.by_set_up.head<3>() = -shown.by_place;
    if (set_up.size() > kZero) {
      shown.length += set_up(kZero);
      shown.by_set_up(kZero) = 1.0;
    }
    return shown;
  }

  StartedSetUp start(const LengthsRead& read, const LengthSeries& series,
                     const CalibrationOptions& options) const override {
    StartedSetUp started = located(read, series, options);
    if (options.noise.distance_bias > 0.0) return started;
    started.assumed += fmt::format("{}the lengths of {} have no common error (--distance-bias-mm allows one)",
                                   started.assumed.empty() ? "" : "; ", series.name);
    return started;
  }

  void add_priors(const Eigen::VectorXd& unknowns, Eigen::Index first, const CalibrationOptions& options,
                  InformationRoot& root) const override {
    if (options.noise.distance_bias <= 0.0) return;
    root.add_prior(first + kZero, unknowns(first + kZero), 0.0, options.noise.distance_bias);
  }

  std::vector<std::pair<std::string_view, double>> told(const SetUp& set_up,
                                                        const LengthSeries& /*series*/) const override {
    std::vector<std::pair<std::string_view, double>> told{
        {"x_mm", set_up(0)}, {"y_mm", set_up(1)}, {"z_mm", set_up(2)}};
    if (set_up.size() > kZero) told.emplace_back("zero_mm", set_up(kZero));
    return told;
  }

  /// On a table below the workspace.
  SetUp typical(const Robot& robot, const LengthSeries& series) const override {
    const Workspace& workspace = robot.workspace();
    const Eigen::Vector3d lowest = workspace.at(0.0, 0.0, 1.0);
    const Eigen::Vector3d point = series.at.value_or(lowest - 0.5 * workspace.radius * Eigen::Vector3d::UnitZ());
    return Eigen::Vector4d(point.x(), point.y(), point.z(), 0.0);
  }

  SetUp random(const Robot& robot, const LengthSeries& series, RandomStream& random) const override {
    constexpr double kPlaced = 30.0;  // mm
    SetUp set_up = typical(robot, series);
    for (Eigen::Index k = 0; k < kZero; ++k) set_up(k) += kPlaced * random.normal();
    return set_up;
  }

 private:
  /// From where the point is said to be; else from both sides of the places.
  StartedSetUp located(const LengthsRead& read, const LengthSeries& series, const CalibrationOptions& options) const {
    SetUp unknowns = SetUp::Zero(units(options).size());
    if (series.at || read.places.empty()) {
      unknowns.head<3>() = closest(read, series.at.value_or(Eigen::Vector3d::Zero()));
      if (!read.places.empty()) require_beside(read, mean_of(read.places), unknowns.head<3>(), series.name);
      return {unknowns, {}};
    }
    constexpr double kTold = 2.0;  // as many times closer is no chance
    const Eigen::Vector3d middle = mean_of(read.places);
    const Eigen::Vector3d normal = flattest(read, middle);
    const Eigen::Vector3d below = closest(read, trilaterated(read, middle, normal));
    const Eigen::Vector3d above = closest(read, below - 2.0 * normal.dot(below - middle) * normal);
    const Eigen::Vector3d &lower = below.z() <= above.z() ? below : above, &upper = &lower == &below ? above : below;
    const double misses = sum_of_misses(read, lower), others = sum_of_misses(read, upper);
    const bool told = std::max(misses, others) > kTold * std::min(misses, others);
    const bool one = (upper - lower).norm() < 1.0;  // mm
    unknowns.head<3>() = told && others < misses ? upper : lower;
    require_beside(read, middle, unknowns.head<3>(), series.name);
    if (told || one) return {unknowns, {}};
    return {unknowns, fmt::format("the fixed point of {} is the lower of two possible points: z = {:.0f} mm, not "
                                  "{:.0f} mm; if wrong, state columns {}, {}, {}",
                                  series.name, lower.z(), upper.z(), words().at_columns[0], words().at_columns[1],
                                  words().at_columns[2])};
  }
};

}  // namespace

const LengthModel& ball_bar() {
  static const BallBar kModel;
  return kModel;
}

}  // namespace paracal::detail
