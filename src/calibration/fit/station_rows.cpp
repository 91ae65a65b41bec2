// Rows of the readings, and of those of one station together whose joints may stand elsewhere than the model has them.

#include <cmath>
#include <utility>

#include "numerics/dense.hpp"
#include "observation.hpp"

namespace paracal::detail {
namespace {

/// V^-1/2 [J | r] up to a rotation: what is left of the rows when dq has been eliminated from
///
///   | H    J  r |
///   | 1/s  0  0 |
Eigen::MatrixXd whitened(const StationRows& at, double joint) {
  const Eigen::Index joints = at.by_joint.cols(), count = at.rows.rows();
  Eigen::MatrixXd stacked(count + joints, joints);
  stacked << at.by_joint, Eigen::MatrixXd::Identity(joints, joints) / joint;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count + joints, at.rows.cols());
  rows.topRows(count) = at.rows;
  return turned_by_q(stacked, std::move(rows)).bottomRows(count);
}

}  // namespace

void Observation::rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
                       Eigen::MatrixXd& block, Eigen::MatrixXd* by_joint) const {
  ByPlate by_plate = series_of(group).rows(group.index, {stations, unknowns}, block);
  const double factor = std::sqrt(group.weight) / noise_factor(group);
  if (factor != 1.0) {
    block *= factor;
    by_plate *= factor;
  }
  if (orientation_factor(group) != 1.0) {
    block.middleRows(3, orientation_rows(group)) /= orientation_factor(group);
    by_plate.middleRows(3, orientation_rows(group)) /= orientation_factor(group);
  }
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
    if (components_.joint > 0.0) {
      block = widening(group, stations, by_plate, components_.joint).cwiseSqrt().cwiseInverse().asDiagonal() * block;
    }
  }
  if (by_joint != nullptr) *by_joint = by_joints(group, by_plate, motions);
}

Eigen::MatrixXd Observation::by_joints(const Group& group, const ByPlate& by_plate,
                                       const StationMotions& motions) const {
  if (!series_of(group).follows_gaps()) return by_plate * motions.by_joint;
  return by_plate.leftCols(motions.gaps_by_joint.rows()) * motions.gaps_by_joint;
}

/// Readings that share a station share how far its joints are off; here each has its own.
Eigen::VectorXd Observation::widening(const Group& group, const std::vector<StationState>& stations,
                                      const ByPlate& by_plate, double joint_std) const {
  StationMotions fresh;
  const auto squares_at = [&](std::size_t station) -> Eigen::VectorXd {
    return by_joints(group, by_plate, motions_of(station, stations[station], fresh)).rowwise().squaredNorm();
  };
  Eigen::VectorXd squares = squares_at(group.station);
  if (group.is_relative()) squares += squares_at(group.from);
  return Eigen::VectorXd::Ones(by_plate.rows()) + joint_std * joint_std * squares;
}

Eigen::VectorXd Observation::widening(const Group& group, const Placed& at, double joint_std) const {
  Eigen::MatrixXd block;
  return widening(group, at.stations, series_of(group).rows(group.index, at, block) / noise_factor(group), joint_std);
}

StationRows Observation::station_rows(std::size_t station, const std::vector<StationState>& stations,
                                      const Eigen::VectorXd& unknowns) const {
  const auto joints = static_cast<Eigen::Index>(robot_.limb_count());
  StationRows at;
  std::vector<Eigen::MatrixXd> blocks, by_joints;
  Eigen::Index count = 0;
  for (const std::uint32_t g : at_station_[station]) {
    if (!groups_[g].active) continue;
    at.groups.push_back(g);
    at.first.push_back(count);
    rows(groups_[g], stations, unknowns, blocks.emplace_back(), &by_joints.emplace_back());
    if (!held_by_joint_.empty()) by_joints.back() = held_by_joint_[g];
    count += blocks.back().rows();
  }
  at.rows.resize(count, unknown_count() + 1);
  at.by_joint.resize(count, joints);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    at.rows.middleRows(at.first[k], blocks[k].rows()) = blocks[k];
    at.by_joint.middleRows(at.first[k], blocks[k].rows()) = by_joints[k];
  }
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(joints, joints);
  const Eigen::MatrixXd information =
      at.by_joint.transpose() * at.by_joint + one / (components_.joint * components_.joint);
  at.spread = cholesky_solution(information, one);
  at.smoother = at.spread * at.by_joint.transpose();
  return at;
}

void Observation::hold_joint_rows(const Eigen::VectorXd& unknowns) {
  const auto states = components_.joint > 0.0 ? stations(unknowns) : nullptr;
  if (!states) return;
  held_by_joint_.resize(groups_.size());
  Eigen::MatrixXd block;
  for (std::size_t g = 0; g < groups_.size(); ++g) rows(groups_[g], *states, unknowns, block, &held_by_joint_[g]);
}

bool Observation::operator()(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  const auto states = stations(unknowns);
  if (!states) return false;
  const bool alone = components_.joint == 0.0;
  Eigen::MatrixXd block;
  for (const Group& group : groups_) {
    if (!group.active || !(alone || group.is_relative())) continue;
    rows(group, *states, unknowns, block);
    root.add(block);
  }
  for (std::size_t s = 0; !alone && s < at_station_.size(); ++s) {
    const StationRows at = station_rows(s, *states, unknowns);
    if (!at.groups.empty()) root.add(whitened(at, components_.joint));
  }
  return true;
}

void Observation::check_each(
    const Eigen::VectorXd& unknowns,
    const std::function<void(std::size_t, const Eigen::MatrixXd&, const Eigen::MatrixXd&)>& look) const {
  const auto states = stations(unknowns);
  if (!states) return;
  const bool alone = components_.joint == 0.0;
  Eigen::MatrixXd block, one;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!(alone || groups_[g].is_relative())) continue;
    rows(groups_[g], *states, unknowns, block);
    if (one.rows() != block.rows()) one.setIdentity(block.rows(), block.rows());
    look(g, block, one);
  }
  for (std::size_t s = 0; !alone && s < at_station_.size(); ++s) check_station(s, *states, unknowns, look);
}

void Observation::check_station(
    std::size_t station, const std::vector<StationState>& states, const Eigen::VectorXd& unknowns,
    const std::function<void(std::size_t, const Eigen::MatrixXd&, const Eigen::MatrixXd&)>& look) const {
  const StationRows at = station_rows(station, states, unknowns);
  const Eigen::MatrixXd of_joints = at.smoother * at.rows;  // -dq, and how it follows the unknowns
  const Eigen::MatrixXd checked = at.rows - at.by_joint * of_joints;
  const Eigen::MatrixXd own = Eigen::MatrixXd::Identity(at.rows.rows(), at.rows.rows()) - at.by_joint * at.smoother;
  std::size_t k = 0;
  Eigen::MatrixXd block, by_joint;
  for (const std::uint32_t g : at_station_[station]) {
    if (groups_[g].active) {
      const Eigen::Index first = at.first[k];
      const Eigen::Index count = (k + 1 < at.first.size() ? at.first[k + 1] : at.rows.rows()) - first;
      look(g, checked.middleRows(first, count), own.block(first, first, count, count));
      ++k;
      continue;
    }
    rows(groups_[g], states, unknowns, block, &by_joint);
    look(g, block - by_joint * of_joints,
         Eigen::MatrixXd::Identity(block.rows(), block.rows()) + by_joint * at.spread * by_joint.transpose());
  }
}

double Observation::log_determinant(const Eigen::VectorXd& unknowns) const {
  const auto states = stations(unknowns);
  if (!states) return 0.0;
  double sum = 0.0;
  Eigen::MatrixXd block;
  for (const Group& group : groups_) {
    if (!group.active) continue;
    const ByPlate by_plate = series_of(group).rows(group.index, {*states, unknowns}, block);
    const double factor = noise_factor(group);
    sum += 2.0 * static_cast<double>(block.rows()) * std::log(factor);
    sum += 2.0 * static_cast<double>(orientation_rows(group)) * std::log(orientation_factor(group));
    if (group.is_relative() && components_.joint > 0.0) {
      sum += widening(group, *states, by_plate / factor, components_.joint).array().log().sum();
    }
  }
  if (components_.joint == 0.0) return sum;
  for (std::size_t s = 0; s < at_station_.size(); ++s) {
    const StationRows at = station_rows(s, *states, unknowns);
    // det(I + s^2 H^T H) = s^2n / det P
    const Eigen::MatrixXd root = cholesky(at.spread);
    sum += 2.0 * (static_cast<double>(root.rows()) * std::log(components_.joint) - root.diagonal().array().log().sum());
  }
  return sum;
}

}  // namespace paracal::detail
