#include <algorithm>
#include <utility>

#include "paracal/calibration/prediction.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"

namespace paracal {
namespace {

/// Rows x errors: how the plate moves with each, position first.
template <int Rows>
using Motions = Eigen::Matrix<double, Rows, Eigen::Dynamic>;

/// x, y, z and phi, or x, y, z and tilt, of a column of the exact derivatives.
template <int Rows>
Eigen::Matrix<double, Rows, 1> commanded(const Machine& machine, const Eigen::Ref<const Eigen::VectorXd>& state) {
  Eigen::Matrix<double, Rows, 1> motion;
  motion.template head<3>() = state.head<3>();
  if constexpr (Rows == 6) {
    motion.template tail<3>() = state.tail<3>();
  } else {
    motion(3) = machine.has_slide() ? machine.rotation_of(state(3)) : 0.0;
  }
  return motion;
}

/// The diagonal of G C G^T: each pair of errors once, two columns of C in one pass over G.
template <int Rows>
Eigen::Matrix<double, Rows, 1> variances(const Motions<Rows>& G, const Eigen::MatrixXd& C) {
  using Column = Eigen::Matrix<double, Rows, 1>;
  Column sum = Column::Zero();
  Eigen::Index i = 0;
  for (; i + 1 < C.cols(); i += 2) {
    Column first = 0.5 * C(i, i) * G.col(i) + C(i + 1, i) * G.col(i + 1), second = 0.5 * C(i + 1, i + 1) * G.col(i + 1);
    for (Eigen::Index k = i + 2; k < C.rows(); ++k) {
      const Column motion = G.col(k);
      first += C(k, i) * motion;
      second += C(k, i + 1) * motion;
    }
    sum += 2.0 * (G.col(i).cwiseProduct(first) + G.col(i + 1).cwiseProduct(second));
  }
  if (i < C.cols()) sum += C(i, i) * G.col(i).cwiseAbs2();
  return sum;
}

}  // namespace

PlateUncertainty::PlateUncertainty(DifferentiableMachine machine, const std::vector<SoughtSource>& parameters,
                                   const Eigen::MatrixXd& covariance)
    : machine_(std::move(machine)) {
  if (covariance.size() == 0) return;
  std::vector<Eigen::Index> errors, knots;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    (parameters[k].knot ? knots : errors).push_back(static_cast<Eigen::Index>(k));
  }
  std::ranges::stable_sort(knots, {}, [&](Eigen::Index k) { return parameters[static_cast<std::size_t>(k)].limb; });
  const auto column = [&](Eigen::Index k) {
    const SoughtSource& one = parameters[static_cast<std::size_t>(k)];
    return static_cast<Eigen::Index>(machine_.parameter(one.limb, one.source));
  };
  for (const Eigen::Index k : errors) columns_.push_back(column(k));
  for (const Eigen::Index k : knots) {
    const SoughtSource& one = parameters[static_cast<std::size_t>(k)];
    if (drives_.empty() || drives_.back().limb != static_cast<Eigen::Index>(one.limb)) {
      drives_.push_back({static_cast<Eigen::Index>(one.limb), column(k), {}});
    }
    drives_.back().knots.push_back(*one.knot);
  }
  errors_ = covariance(errors, errors);
  knots_by_errors_ = covariance(errors, knots);
  knots_ = covariance(knots, knots);
}

template <int Rows>
Eigen::VectorXd PlateUncertainty::variances_at(const ExactJacobian& exact, const Joints& joints) const {
  const auto n = static_cast<Eigen::Index>(columns_.size());
  Motions<Rows> G(static_cast<Eigen::Index>(Rows), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    G.col(k) = commanded<Rows>(machine_, exact.plate.col(columns_[static_cast<std::size_t>(k)]));
  }
  Eigen::Matrix<double, Rows, 1> sum = variances<Rows>(G, errors_);
  // A drive's error at its joint, f_l = sum_k B_k(q_l) x_k, moves the plate as an error of the joint's zero: its knots
  // fold into one column, and few of them are not zero there.
  Motions<Rows> by_drive(static_cast<Eigen::Index>(Rows), static_cast<Eigen::Index>(drives_.size()));
  std::vector<std::pair<Eigen::Index, double>> active;  // of all knots, with their B_k
  std::vector<std::size_t> first;                       // of each drive
  Eigen::Index knot = 0;
  for (std::size_t d = 0; d < drives_.size(); ++d) {
    const Drive& drive = drives_[d];
    const auto at = static_cast<Eigen::Index>(d);
    first.push_back(active.size());
    Eigen::VectorXd with_errors = Eigen::VectorXd::Zero(n);
    for (const SplineKnot& one : drive.knots) {
      const double share = one.at(joints(drive.limb));
      if (share != 0.0) {
        active.emplace_back(knot, share);
        with_errors += share * knots_by_errors_.col(knot);
      }
      ++knot;
    }
    by_drive.col(at) = commanded<Rows>(machine_, exact.plate.col(drive.zero));
    sum += 2.0 * by_drive.col(at).cwiseProduct(G.lazyProduct(with_errors));
    for (std::size_t other = 0; other <= d; ++other) {
      const std::size_t end = other < d ? first[other + 1] : active.size();
      double covariance = 0.0;
      for (std::size_t i = first[d]; i < active.size(); ++i) {
        for (std::size_t k = first[other]; k < end; ++k) {
          covariance += active[i].second * active[k].second * knots_(active[i].first, active[k].first);
        }
      }
      sum += (other < d ? 2.0 : 1.0) * covariance *
             by_drive.col(at).cwiseProduct(by_drive.col(static_cast<Eigen::Index>(other)));
    }
  }
  return sum.cwiseMax(0.0);  // rounding may leave a zero below
}

std::optional<Eigen::VectorXd> PlateUncertainty::at(const PlateState& plate, const Joints& joints) const {
  if (columns_.empty()) return std::nullopt;
  const ExactJacobian exact = exact_jacobian(machine_, plate, joints);
  if (!exact.ok) return std::nullopt;
  const Eigen::VectorXd variances =
      machine_.commands_tilt() ? variances_at<6>(exact, joints) : variances_at<4>(exact, joints);
  return kCoverageFactor * variances.cwiseSqrt();
}

}  // namespace paracal
