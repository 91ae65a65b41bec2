#include "largest_errors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::detail {
namespace {

constexpr Eigen::Index kMachines = 1000;  // they tell a quantile of a twentieth within 3 %
constexpr std::size_t kAtOnce = 16;       // poses whose rows are multiplied together
/// Probability that poses left out may add to a twentieth: it moves the quantile by less than a tenth of those 3 %.
constexpr double kNeglected = 1e-3;

Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  RandomStream random(seed);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.normal(); });
}

double exceeded_by_a_twentieth(std::vector<double> of_each) {
  const auto place = of_each.begin() + static_cast<std::ptrdiff_t>(of_each.size() * 95 / 100);
  std::ranges::nth_element(of_each, place);
  return *place;
}

/// Probability that a Gaussian vector is longer than x: of one coordinate exactly, of three at most. A sum of squares
/// with a given expectation is never more probably large than that of a single coordinate [szekely2003], nor than that
/// of three which all vary as the most varying one.
double probability_beyond(double x, double trace, double largest) {
  if (!(trace > 0.0)) return 0.0;
  const double alone = 2.0 * normal_probability(-x / std::sqrt(trace));
  const double t = x * x / largest;
  const double all =
      2.0 * normal_probability(-std::sqrt(t)) + std::sqrt(2.0 * t / std::numbers::pi) * std::exp(-0.5 * t);
  return std::min(alone, all);
}

/// The largest values so far of each machine, for one set of standard deviations of joints.
class Largest {
 public:
  Largest(const PoseQuantity& quantity, const Eigen::VectorXd& joint_std) : quantity_(quantity), joint_std_(joint_std) {
    traces_.resize(quantity.by_errors.rows() / quantity.coordinates);
    largest_.resize(traces_.size());
    for (Eigen::Index pose = 0; pose < traces_.size(); ++pose) {
      Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(quantity.coordinates, quantity.coordinates);
      for (const Eigen::MatrixXd& rows :
           {of(quantity.by_errors, pose), by(quantity.by_joints, pose), by(quantity.by_home, pose)}) {
        covariance += rows.lazyProduct(rows.transpose());
      }
      traces_(pose) = covariance.trace();
      largest_(pose) = covariance.rows() > 1 ? symmetric_eigenvalues(covariance).maxCoeff() : traces_(pose);
    }
  }

  /// Variances at each pose, the sum of the coordinates.
  const Eigen::VectorXd& variances() const { return traces_; }
  double exceeded() const { return exceeded_; }

  /// @param moved  by the errors of each machine; off, home: its joints here and there.
  void take(Eigen::Index pose, Eigen::MatrixXd moved, const Eigen::MatrixXd& off, const Eigen::MatrixXd& home) {
    if (joint_std_.size() > 0) moved += product(by(quantity_.by_joints, pose), off);
    if (joint_std_.size() > 0 && quantity_.by_home.rows() > 0) moved -= product(by(quantity_.by_home, pose), home);
    squares_ = squares_.cwiseMax(moved.colwise().squaredNorm().transpose());
  }

  /// The probability that any of these poses exceeds what a twentieth exceeds so far hardly counts.
  bool may_neglect(std::span<const Eigen::Index> poses) {
    std::vector<double> squares(squares_.begin(), squares_.end());
    exceeded_ = std::sqrt(exceeded_by_a_twentieth(std::move(squares)));
    double probability = 0.0;
    for (const Eigen::Index pose : poses) probability += probability_beyond(exceeded_, traces_(pose), largest_(pose));
    return probability < kNeglected;
  }

 private:
  Eigen::MatrixXd of(const Eigen::MatrixXd& rows, Eigen::Index pose) const {
    return rows.middleRows(quantity_.coordinates * pose, quantity_.coordinates);
  }
  /// By the joints at a pose in units of their standard deviations.
  Eigen::MatrixXd by(const Eigen::MatrixXd& joints, Eigen::Index pose) const {
    if (joint_std_.size() == 0 || joints.rows() == 0) return Eigen::MatrixXd::Zero(quantity_.coordinates, 0);
    return of(joints, pose) * joint_std_.asDiagonal();
  }

  const PoseQuantity& quantity_;
  const Eigen::VectorXd& joint_std_;
  Eigen::VectorXd traces_, largest_, squares_ = Eigen::VectorXd::Zero(kMachines);
  double exceeded_ = 0.0;
};

}  // namespace

DrawnMachines::DrawnMachines(Eigen::Index errors, Eigen::Index joints) {
  // Of joints a prime number, so that they meet the poses in turn: drawing as many as there are poses would cost more
  // than all else.
  constexpr Eigen::Index kPool = 4099;
  constexpr std::uint64_t kSeedOfErrors = 95, kSeedOfJoints = 96;
  errors_ = normals(errors, kMachines, kSeedOfErrors);
  joints_ = normals(joints, kPool, kSeedOfJoints);
}

/// Joints of each machine at a pose.
Eigen::MatrixXd DrawnMachines::dealt(Eigen::Index pose, Eigen::Index poses) const {
  constexpr Eigen::Index kStride = 1787;
  const Eigen::Index pool = joints_.cols(), joints = joints_.rows(), step = poses * kStride % pool;
  Eigen::MatrixXd off(joints, kMachines);
  Eigen::Index from = pose * kStride % pool;
  for (Eigen::Index machine = 0; machine < kMachines; ++machine) {
    std::copy_n(joints_.data() + joints * from, joints, off.data() + joints * machine);
    from += step;
    if (from >= pool) from -= pool;
  }
  return off;
}

std::vector<double> DrawnMachines::largest(const PoseQuantity& quantity,
                                           const std::vector<Eigen::VectorXd>& joint_std) const {
  std::vector<Largest> all;
  all.reserve(joint_std.size());
  for (const Eigen::VectorXd& one : joint_std) all.emplace_back(quantity, one);
  const Eigen::Index rows = quantity.coordinates, poses = quantity.by_errors.rows() / rows;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(poses));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(poses);
  for (const Largest& one : all) variances = variances.cwiseMax(one.variances());
  std::ranges::stable_sort(order, std::greater{}, [&](Eigen::Index pose) { return variances(pose); });
  const Eigen::MatrixXd home = dealt(0, poses + 1);
  std::span<const Eigen::Index> left(order);
  for (bool neglected = false; !neglected && !left.empty();) {
    const auto now = left.first(std::min(kAtOnce, left.size()));
    left = left.subspan(now.size());
    Eigen::MatrixXd by_errors(rows * std::ssize(now), quantity.by_errors.cols());
    for (Eigen::Index k = 0; k < std::ssize(now); ++k) {
      by_errors.middleRows(rows * k, rows) =
          quantity.by_errors.middleRows(rows * now[static_cast<std::size_t>(k)], rows);
    }
    const Eigen::MatrixXd moved = product(by_errors, errors_.topRows(by_errors.cols()));
    for (Eigen::Index k = 0; k < std::ssize(now); ++k) {
      const Eigen::Index pose = now[static_cast<std::size_t>(k)];
      const Eigen::MatrixXd off = dealt(pose + 1, poses + 1);
      for (Largest& one : all) one.take(pose, moved.middleRows(rows * k, rows), off, home);
    }
    neglected = true;
    for (Largest& one : all) neglected = one.may_neglect(left) && neglected;
  }
  std::vector<double> exceeded;
  exceeded.reserve(all.size());
  for (const Largest& one : all) exceeded.push_back(one.exceeded());
  return exceeded;
}

}  // namespace paracal::detail
