#include "linear_readings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"

namespace paracal::detail {
namespace {

/// What the joints move a coordinate of the plate's centre by, mean square over the stations and the coordinates.
double square_by_joints(const StageFit& fit) {
  const auto states = fit.observation().stations(fit.fit().parameters);
  double squares = 0.0;
  StationMotions fresh;
  for (std::size_t s = 0; s < states->size(); ++s) {
    squares += fit.observation().motions_of(s, (*states)[s], fresh).by_joint.topRows<3>().squaredNorm();
  }
  return squares / (3.0 * static_cast<double>(states->size()));
}

}  // namespace

DriveSplines drive_splines(const Robot& robot, const std::vector<Station>& stations, double length) {
  constexpr int kKnots = kDriveKnots;  // each end has one more outside
  constexpr auto kIntervals =
      static_cast<double>(kKnots - 3);  // of a stroke: as far apart they follow a length of 0.15
  const auto joints = static_cast<Eigen::Index>(robot.limb_count());
  Eigen::VectorXd low = Eigen::VectorXd::Constant(joints, 1e300), high = -low;
  const auto take = [&](const Station& station) {
    const Joints at = believed_joints(robot, station);
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  };
  std::ranges::for_each(workspace_stations(robot), take);
  std::ranges::for_each(stations, take);
  DriveSplines splines;
  splines.covariance = Eigen::MatrixXd::Zero(joints * kKnots, joints * kKnots);
  const double spacing = 1.0 / kIntervals, narrow = std::sqrt(length * length - 2.0 * spacing * spacing / 3.0);
  for (Eigen::Index limb = 0; limb < joints; ++limb) {
    const double step = std::max((high(limb) - low(limb)) * spacing, 1e-9);
    const Source zero = joint_zero(robot.nominal().limbs[static_cast<std::size_t>(limb)].actuator);
    for (int k = 0; k < kKnots; ++k) {
      splines.knots.push_back({static_cast<std::size_t>(limb), zero, {}, SplineKnot{low(limb) + (k - 1) * step, step}});
      for (int j = 0; j < kKnots; ++j) {
        splines.covariance(limb * kKnots + k, limb * kKnots + j) =
            length / narrow * std::exp(-0.5 * std::pow((j - k) * spacing / narrow, 2));
      }
    }
  }
  return splines;
}

Eigen::MatrixXd by_drives(const ReadingBlock& block, const std::vector<Joints>& joints,
                          const std::vector<SoughtSource>& knots) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(block.by_joint.rows(), std::ssize(knots));
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const auto limb = static_cast<Eigen::Index>(knots[k].limb), at = static_cast<Eigen::Index>(k);
    rows.col(at) = knots[k].knot->at(joints[block.station](limb)) * block.by_joint.col(limb);
    if (block.by_from_joint.size() == 0) continue;
    rows.col(at) += knots[k].knot->at(joints[block.from](limb)) * block.by_from_joint.col(limb);
  }
  return rows;
}

LinearReadings linear_readings(const StageFit& fit, const ReadingPlaces& places, std::size_t stride,
                               const DriveSplines& drives) {
  const Observation& observation = fit.observation();
  const Eigen::VectorXd& unknowns = fit.fit().parameters;
  const Eigen::Index set_up = observation.nuisance_count(), n = observation.source_count();
  LinearReadings all{.fitted = unknowns.tail(n), .prior = observation.prior_covariance()};
  std::vector<Eigen::MatrixXd> rows, by_knots;
  Eigen::Index count = 0;
  places.each_block(fit, stride, [&](ReadingBlock&& block) {
    by_knots.push_back(by_drives(block, observation.joints(), drives.knots));
    all.first.push_back(count);
    count += block.rows.rows();
    rows.push_back(std::exchange(block.rows, {}));
    all.blocks.push_back(std::move(block));
  });
  all.y.resize(count);
  all.by_set_up.resize(count, set_up);
  all.by_errors.resize(count, n + std::ssize(drives.knots));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Eigen::Index first = all.first[k], next = rows[k].rows();
    all.by_set_up.middleRows(first, next) = rows[k].leftCols(set_up);
    all.by_errors.middleRows(first, next) << rows[k].middleCols(set_up, n), by_knots[k];
    all.y.segment(first, next) = -rows[k].rightCols<1>();
  }
  // An error without a prior: one that no reading of any size could exceed.
  constexpr double kAnywhere = 1e4;  // standard deviations of each reading
  for (Eigen::Index k = 0; k < n; ++k) {
    if (observation.sought()[static_cast<std::size_t>(k)].prior_std) continue;
    const double each = all.by_errors.col(k).norm() / std::sqrt(static_cast<double>(count));
    all.prior(k, k) = std::pow(kAnywhere / std::max(each, 1e-300), 2);
    all.fitted(k) = 0.0;  // anywhere about there
  }
  all.y += all.by_errors.leftCols(n) * all.fitted;
  InformationRoot known(observation.unknown_count());
  observation.add_set_up_priors(unknowns, known);
  all.set_up_root = known.root().topLeftCorner(set_up, set_up);
  all.set_up_reach = known.reachable().head(set_up);
  all.joint_per_mm = 1.0 / std::sqrt(square_by_joints(fit));
  return all;
}

void ByJoints::add(Eigen::Index first, const Eigen::MatrixXd& more) {
  for (Eigen::Index row = 0; row < more.rows(); ++row) rows.push_back(first + row);
  by_joint.conservativeResize(by_joint.rows() + more.rows(), more.cols());
  by_joint.bottomRows(more.rows()) = more;
}

std::vector<ByJoints> by_visits(const LinearReadings& all) {
  std::vector<ByJoints> visits;
  for (std::size_t k = 0; k < all.blocks.size(); ++k) {
    const ReadingBlock& one = all.blocks[k];
    for (const Eigen::MatrixXd* by : {&one.by_joint, &one.by_from_joint}) {
      if (by->size() > 0) visits.emplace_back().add(all.first[k], *by / std::sqrt(one.visits));
    }
  }
  return visits;
}

std::vector<ByJoints> by_poses(const LinearReadings& all) {
  std::map<std::size_t, ByJoints> poses;
  for (std::size_t k = 0; k < all.blocks.size(); ++k) {
    const ReadingBlock& one = all.blocks[k];
    poses[one.station].add(all.first[k], one.by_joint);
    if (one.by_from_joint.size() > 0) poses[one.from].add(all.first[k], one.by_from_joint);
  }
  std::vector<ByJoints> list;
  list.reserve(poses.size());
  for (auto& [pose, one] : poses) list.push_back(std::move(one));
  return list;
}

}  // namespace paracal::detail
