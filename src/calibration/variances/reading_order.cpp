#include "reading_order.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace paracal::detail {
namespace {

using Places = std::vector<std::size_t>;

Places by_rows(std::span<const Group> readings) {
  Places order(readings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

Places by_passes(std::span<const Group> readings) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> seen;
  std::vector<std::size_t> visit;
  visit.reserve(readings.size());
  for (const Group& one : readings) visit.push_back(seen[{one.from, one.station}]++);
  Places order = by_rows(readings);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return visit[k]; });
  return order;
}

/// Sides of the joints after a motion; one that does not move stays where it is.
void turn(const Joints& from, const Joints& to, Eigen::RowVectorXd& sides) {
  constexpr double kNoMotion = 1e-6;  // rad or mm: no drive is commanded so little
  for (Eigen::Index k = 0; k < to.size(); ++k) {
    const double motion = to(k) - from(k);
    if (std::abs(motion) > kNoMotion) sides(k) = motion > 0.0 ? 1.0 : -1.0;
  }
}

Eigen::RowVector3d legendre(double t) { return {t, 0.5 * (3.0 * t * t - 1.0), 0.5 * t * (5.0 * t * t - 3.0)}; }

class OrderedSeries {
 public:
  OrderedSeries(const Observation& observation, std::size_t series)
      : observation_(observation), readings_(observation.groups_of(series)) {}

  void add(const Places& order, ReadingOrder& all) const {
    add_sides(order, all.sides);
    const double last = std::max(static_cast<double>(order.size()) - 1.0, 1.0);
    for (std::size_t k = 0; k < order.size(); ++k) {
      all.drift.row(row_of(order[k])) = legendre(2.0 * static_cast<double>(k) / last - 1.0);
    }
    take_off_means(all.drift);
  }

 private:
  Eigen::Index row_of(std::size_t place) const {
    return static_cast<Eigen::Index>(&readings_[place] - observation_.groups().data());
  }

  void add_sides(const Places& order, Eigen::MatrixXd& all) const {
    Eigen::RowVectorXd sides = Eigen::RowVectorXd::Zero(all.cols());
    const Joints* before = nullptr;
    for (const std::size_t place : order) {
      const Group& one = readings_[place];
      if (one.is_relative()) {  // the joints stood there before, on sides that nobody knows
        sides.setZero();
        before = &observation_.joints()[one.from];
      }
      const Joints& there = observation_.joints()[one.station];
      if (before != nullptr) turn(*before, there, sides);
      before = &there;
      all.row(row_of(place)) = sides;
    }
  }

  void take_off_means(Eigen::MatrixXd& drift) const {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(drift.cols());
    double count = 0.0;
    for (std::size_t k = 0; k < readings_.size(); ++k) {
      if (!readings_[k].active) continue;
      sum += drift.row(row_of(k));
      count += 1.0;
    }
    for (std::size_t k = 0; k < readings_.size() && count > 0.0; ++k) drift.row(row_of(k)) -= sum / count;
  }

  const Observation& observation_;
  std::span<const Group> readings_;
};

/// A good part of the time of a reading is not that of its pose.
bool tells_drift(const Observation& observation, const Eigen::VectorXd& time) {
  constexpr double kPart = 0.1;  // of the squares: home at every tenth reading is enough
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<double, double>> sums;  // visits, times
  for (std::size_t g = 0; g < observation.groups().size(); ++g) {
    const Group& one = observation.groups()[g];
    auto& [visits, sum] = sums[{one.series, one.station}];
    visits += 1.0;
    sum += time(static_cast<Eigen::Index>(g));
  }
  double of_poses = 0.0;
  for (const auto& [pose, sum] : sums) of_poses += sum.second * sum.second / sum.first;
  return time.squaredNorm() - of_poses > kPart * time.squaredNorm();
}

}  // namespace

std::vector<std::shared_ptr<const ReadingOrder>> reading_orders(const Observation& observation) {
  const auto count = static_cast<Eigen::Index>(observation.groups().size());
  const auto joints = static_cast<Eigen::Index>(observation.robot().limb_count());
  ReadingOrder rows{.drift = Eigen::MatrixXd::Zero(count, ReadingOrder::kDegrees),
                    .sides = Eigen::MatrixXd::Zero(count, joints)};
  ReadingOrder passes = rows;
  for (std::size_t series = 0; series < observation.series().size(); ++series) {
    const std::span<const Group> readings = observation.groups_of(series);
    if (readings.empty() || observation.series_of(readings.front()).follows_gaps())
      continue;  // at no time of their own
    const OrderedSeries one(observation, series);
    one.add(by_rows(readings), rows);
    one.add(by_passes(readings), passes);
  }
  std::vector<std::shared_ptr<const ReadingOrder>> all;
  rows.tells_drift = tells_drift(observation, rows.drift.col(0));
  passes.tells_drift = tells_drift(observation, passes.drift.col(0));
  const bool is_other = passes.drift != rows.drift;
  all.push_back(std::make_shared<ReadingOrder>(std::move(rows)));
  if (is_other) all.push_back(std::make_shared<ReadingOrder>(std::move(passes)));
  return all;
}

bool returns_to_poses(const Observation& observation) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  std::pair<std::uint32_t, std::uint32_t> last{Group::kNowhere, Group::kNowhere};
  for (const Group& one : observation.groups()) {
    const std::pair now{one.series, one.station};
    if (now != last && !seen.insert(now).second) return true;
    last = now;
  }
  return false;
}

}  // namespace paracal::detail
