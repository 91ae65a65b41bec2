// Rows of the readings, and of those of one station together whose joints may stand elsewhere than the model has them.

#include <cmath>
#include <vector>

#include "numerics/dense.hpp"
#include "observation.hpp"

namespace paracal::detail {
ByPlate Observation::scaled_rows(const Group& group, const Placed& at, Eigen::MatrixXd& block) const {
  ByPlate by_plate = series_of(group).rows(group.index, at, block);
  if (!taken_off_.empty()) {
    const Eigen::VectorXd& off = taken_off_[first_group_[group.series] + group.index];
    if (off.size() > 0) block.rightCols<1>() += off;
  }
  const double factor = std::sqrt(group.weight) / noise_factor(group);
  if (factor != 1.0) {
    block *= factor;
    by_plate *= factor;
  }
  if (orientation_factor(group) != 1.0) {
    block.middleRows(3, orientation_rows(group)) /= orientation_factor(group);
    by_plate.middleRows(3, orientation_rows(group)) /= orientation_factor(group);
  }
  return by_plate;
}

void Observation::take_off(std::size_t group, const Eigen::VectorXd& rows) {
  const Group& one = groups_[group];
  taken_off_.resize(groups_.size());
  Eigen::VectorXd unscaled = rows * (noise_factor(one) / std::sqrt(one.weight));
  if (orientation_factor(one) != 1.0) unscaled.segment(3, orientation_rows(one)) *= orientation_factor(one);
  Eigen::VectorXd& all = taken_off_[group];
  all = all.size() == 0 ? unscaled : Eigen::VectorXd(all + unscaled);
}

Eigen::MatrixXd Observation::by_position(const Group& group, const Placed& at) const {
  Eigen::MatrixXd block;
  return scaled_rows(group, at, block).leftCols<3>();
}

void Observation::rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
                       Eigen::MatrixXd& block, Eigen::MatrixXd* by_joint) const {
  const ByPlate by_plate = scaled_rows(group, {stations, unknowns}, block);
  StationMotions fresh;
  const StationMotions& motions = motions_of(group.station, stations[group.station], fresh);
  auto sources = block.middleCols(nuisance_count_, source_count());
  if (series_of(group).follows_gaps()) {
    sources.noalias() = by_plate.leftCols(motions.gaps.rows()) * motions.gaps;
  } else {
    sources.noalias() = by_plate * motions.jacobian;
  }
  if (group.is_relative()) {
    sources.noalias() -= by_plate * stations[group.from].motions->jacobian;
    if (joint_std_.size() > 0) {
      block = widening(group, stations, by_plate, joint_std_).cwiseSqrt().cwiseInverse().asDiagonal() * block;
    }
  }
  if (by_joint == nullptr) return;
  *by_joint = by_joints(group, by_plate, motions);
  if (!group.is_relative()) return;
  const Eigen::Index joints = by_joint->cols();
  by_joint->conservativeResize(Eigen::NoChange, 2 * joints);
  by_joint->rightCols(joints) = -by_joints(group, by_plate, *stations[group.from].motions);
}

Eigen::MatrixXd Observation::by_joints(const Group& group, const ByPlate& by_plate,
                                       const StationMotions& motions) const {
  if (!series_of(group).follows_gaps()) return by_plate * motions.by_joint;
  return by_plate.leftCols(motions.gaps_by_joint.rows()) * motions.gaps_by_joint;
}

/// Readings that share a station share how far its joints are off; here each has its own.
Eigen::VectorXd Observation::widening(const Group& group, const std::vector<StationState>& stations,
                                      const ByPlate& by_plate, const Eigen::VectorXd& joint_std) const {
  StationMotions fresh;
  const auto squares_at = [&](std::size_t station) -> Eigen::VectorXd {
    const StationMotions& motions = motions_of(station, stations[station], fresh);
    return (by_joints(group, by_plate, motions) * joint_std.asDiagonal()).rowwise().squaredNorm();
  };
  Eigen::VectorXd squares = squares_at(group.station);
  if (group.is_relative()) squares += squares_at(group.from);
  return Eigen::VectorXd::Ones(by_plate.rows()) + squares;
}

Eigen::VectorXd Observation::widening(const Group& group, const Placed& at, const Eigen::VectorXd& joint_std) const {
  Eigen::MatrixXd block;
  return widening(group, at.stations, series_of(group).rows(group.index, at, block) / noise_factor(group), joint_std);
}

/// What is left of the rows when dq has been eliminated from
///
///   | H S  J  r |
///   |  I   0  0 |
Eigen::MatrixXd Observation::whitened_rows(std::size_t station, const std::vector<StationState>& stations,
                                           const Eigen::VectorXd& unknowns) const {
  std::vector<Eigen::MatrixXd> blocks, by_joints;
  Eigen::Index count = 0;
  for (const std::uint32_t g : at_station_[station]) {
    if (!groups_[g].active) continue;
    rows(groups_[g], stations, unknowns, blocks.emplace_back(), &by_joints.emplace_back());
    count += blocks.back().rows();
  }
  const Eigen::Index joints = joint_std_.size();
  Eigen::MatrixXd stacked(count + joints, joints), all = Eigen::MatrixXd::Zero(count + joints, unknown_count() + 1);
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Eigen::Index next = blocks[k].rows();
    all.middleRows(first, next) = blocks[k];
    stacked.middleRows(first, next) = by_joints[k] * joint_std_.asDiagonal();
    first += next;
  }
  if (count == 0) return {};
  stacked.bottomRows(joints).setIdentity();
  return turned_by_q(stacked, std::move(all)).bottomRows(count);
}

bool Observation::operator()(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  const auto states = stations(unknowns);
  if (!states) return false;
  const bool alone = joint_std_.size() == 0;
  Eigen::MatrixXd block;
  for (const Group& group : groups_) {
    if (!group.active || !(alone || group.is_relative())) continue;
    rows(group, *states, unknowns, block);
    root.add(block);
  }
  for (std::size_t s = 0; !alone && s < at_station_.size(); ++s) {
    const Eigen::MatrixXd at = whitened_rows(s, *states, unknowns);
    if (at.rows() > 0) root.add(at);
  }
  return true;
}

void Observation::check_each(const Eigen::VectorXd& unknowns,
                             const std::function<void(std::size_t, const Eigen::MatrixXd&)>& look) const {
  const auto states = stations(unknowns);
  if (!states) return;
  Eigen::MatrixXd block;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    rows(groups_[g], *states, unknowns, block);
    if (joint_std_.size() > 0) {  // each by itself
      const Eigen::VectorXd wider = widening(groups_[g], {*states, unknowns}, joint_std_).cwiseSqrt();
      block = wider.cwiseInverse().asDiagonal() * Eigen::MatrixXd(block);
    }
    look(g, block);
  }
}

}  // namespace paracal::detail
