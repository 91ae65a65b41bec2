#include "validation_parts.hpp"

#include <algorithm>
#include <cmath>

namespace paracal::detail {
namespace {

struct MeanAndStd {
  double mean = 0.0, std = 0.0;
};

template <typename Value>
MeanAndStd spread_of(const std::vector<Pose>& repeats, Value&& value) {
  MeanAndStd spread;
  for (const Pose& pose : repeats) spread.mean += value(pose) / static_cast<double>(repeats.size());
  for (const Pose& pose : repeats) spread.std += std::pow(value(pose) - spread.mean, 2);
  spread.std = std::sqrt(spread.std / static_cast<double>(repeats.size() - 1));
  return spread;
}

}  // namespace

void add_criteria(const std::string& name, const Pose& commanded, const std::vector<Pose>& repeats,
                  const PosePair& home, bool rotations, Iso9283& criteria) {
  Eigen::Vector3d barycentre = Eigen::Vector3d::Zero();
  for (const Pose& pose : repeats) barycentre += pose.position / static_cast<double>(repeats.size());
  const MeanAndStd away = spread_of(repeats, [&](const Pose& pose) { return (pose.position - barycentre).norm(); });
  const MeanAndStd distance =
      spread_of(repeats, [&](const Pose& pose) { return (pose.position - home.actual.position).norm(); });
  PoseCriteria one{.pose = name, .repeats = static_cast<int>(repeats.size())};
  one.AP = (barycentre - commanded.position).norm();
  one.RP = away.mean + 3.0 * away.std;
  const double commanded_distance = (commanded.position - home.meant.position).norm();
  if (commanded_distance > 0.0) {
    one.AD = std::abs(distance.mean - commanded_distance);
    one.RD = 3.0 * distance.std;
  }
  if (rotations) {
    const MeanAndStd rotation = spread_of(repeats, [](const Pose& pose) { return pose.rotation; });
    one.AP_rotation = std::abs(rotation.mean - commanded.rotation);
    one.RP_rotation = 3.0 * rotation.std;
  }
  criteria.max_AP = std::max(criteria.max_AP, one.AP);
  criteria.max_RP = std::max(criteria.max_RP, one.RP);
  criteria.max_AD = std::max(criteria.max_AD, one.AD);
  criteria.max_RD = std::max(criteria.max_RD, one.RD);
  criteria.poses.push_back(std::move(one));
}

}  // namespace paracal::detail
