#include "reading_blocks.hpp"

#include <map>
#include <utility>

namespace paracal::detail {
namespace {

/// Visits with the same derivatives go together: not those whose standard deviations differ.
bool is_alike(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
  constexpr double kAlike = 1e-2;
  return one.rows() == other.rows() && (one - other).squaredNorm() <= kAlike * kAlike * one.squaredNorm();
}

class Blocks {
 public:
  explicit Blocks(const StageFit& fit)
      : observation_(fit.observation()), unknowns_(fit.fit().parameters), states_(observation_.stations(unknowns_)) {}

  void add(std::uint32_t g) {
    const Group& group = observation_.groups()[g];
    Eigen::MatrixXd rows, by_joint;
    observation_.rows(group, *states_, unknowns_, rows, &by_joint);
    const Eigen::Index last = rows.cols() - 1;
    for (ReadingBlock& one : blocks_) {
      if (!is_alike(one.rows.leftCols(last), rows.leftCols(last))) continue;
      const Eigen::VectorXd off = rows.col(last) - one.rows.col(last);
      one.rows.col(last) += off / ++one.visits;
      one.each.push_back({g, rows.col(last)});
      return;
    }
    const Eigen::Index joints = static_cast<Eigen::Index>(observation_.robot().limb_count()), count = rows.rows();
    const ReadingBlock::Visit first{g, rows.col(last)};
    const Eigen::Index orientation = observation_.orientation_rows(group),
                       rotation = observation_.series_of(group).rotation_rows(group.index);
    blocks_.push_back({.rows = std::move(rows),
                       .by_joint = by_joint.leftCols(joints),
                       .by_from_joint = by_joint.rightCols(by_joint.cols() - joints),
                       .scatter = Eigen::MatrixXd::Zero(count, count),
                       .station = group.station,
                       .from = group.is_relative() ? group.from : group.station,
                       .stated = group.stated,
                       .series = group.series,
                       .each = {first},
                       .first_angle = orientation > 0 ? 3 : count - rotation,
                       .angles = orientation + rotation});
  }
  std::vector<ReadingBlock>& all() { return blocks_; }

 private:
  const Observation& observation_;
  const Eigen::VectorXd& unknowns_;
  std::shared_ptr<const std::vector<StationState>> states_;
  std::vector<ReadingBlock> blocks_;
};

}  // namespace

ReadingPlaces::ReadingPlaces(const Observation& observation) {
  std::map<std::array<std::uint32_t, 3>, std::vector<std::uint32_t>> places;
  for (std::size_t g = 0; g < observation.groups().size(); ++g) {
    const Group& group = observation.groups()[g];
    if (group.active) places[{group.station, group.from, group.series}].push_back(static_cast<std::uint32_t>(g));
  }
  places_.reserve(places.size());
  for (auto& [at, groups] : places) places_.push_back({at, std::move(groups)});
}

void ReadingPlaces::each_block(const StageFit& fit, std::size_t stride,
                               const std::function<void(ReadingBlock&&)>& look) const {
  Blocks blocks(fit);
  for (std::size_t k = 0; k < places_.size(); k += stride) {
    for (const std::uint32_t g : places_[k].groups) blocks.add(g);
    for (ReadingBlock& one : blocks.all()) {
      const Eigen::VectorXd mean = one.rows.rightCols<1>();
      for (ReadingBlock::Visit& visit : one.each) {
        visit.off -= mean;
        one.scatter += visit.off * visit.off.transpose();
      }
      look(std::move(one));
    }
    blocks.all().clear();
  }
}

}  // namespace paracal::detail
