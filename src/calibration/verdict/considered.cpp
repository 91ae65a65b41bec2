#include "posterior.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/fit/sought.hpp"
#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

/// Variances that the tolerances give some errors; 0: exact.
Eigen::VectorXd variances(const std::vector<SoughtSource>& errors, const std::vector<SoughtSource>& tolerated) {
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(std::ssize(errors));
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const auto found = std::ranges::find_if(tolerated, [&](const auto& one) { return is_same_error(one, errors[k]); });
    if (found != tolerated.end()) variances(static_cast<Eigen::Index>(k)) = std::pow(found->prior_std.value_or(0.0), 2);
  }
  return variances;
}

/// K B and K J of the errors p, from the rows' root over [set-up | p | q] with scales among the set-up.
struct Gains {
  Eigen::MatrixXd held;    ///< K B: p x q, scales first
  Eigen::MatrixXd sought;  ///< K J: p x p
};

/// (A^T A)^-1 A^T of what the rows tell; of what they do not, zero.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& rows) {
  if (rows.cols() == 0) return Eigen::MatrixXd::Zero(0, rows.rows());
  return product(analyse(rows, kRankTolerance).covariance, rows.transpose());
}

/// The set-up is whatever suits the errors best: what readings do not tell from it leaves the errors where they are.
Gains gains(const Eigen::MatrixXd& root, const std::vector<Eigen::Index>& scales, Eigen::Index setup,
            Eigen::Index sought) {
  std::vector<Eigen::Index> first, last = scales;
  for (Eigen::Index k = 0; k < setup + sought; ++k) {
    if (std::ranges::find(scales, k) == scales.end()) first.push_back(k);
  }
  for (Eigen::Index k = setup + sought; k < root.cols(); ++k) last.push_back(k);
  const Eigen::MatrixXd estimated = root(Eigen::indexing::all, first), held = root(Eigen::indexing::all, last);
  const Eigen::MatrixXd of_setup = estimated.leftCols(estimated.cols() - sought), to_setup = inverse_of(of_setup);
  const auto beside_setup = [&](const Eigen::MatrixXd& rows) -> Eigen::MatrixXd {
    return rows - product(of_setup, product(to_setup, rows));
  };
  const Eigen::MatrixXd errors = beside_setup(estimated.rightCols(sought)), inverse = inverse_of(errors);
  return {product(inverse, beside_setup(held)), product(inverse, errors)};
}

}  // namespace

Considered consider_held(const Finished& of, Eigen::MatrixXd covariance, Eigen::MatrixXd noise) {
  const Observation& observation = of.observation();
  Considered all{.covariance = std::move(covariance), .noise = std::move(noise)};
  if (has_priors(observation) || all.covariance.size() == 0) return all;
  const std::vector<SoughtSource> tolerated = all_with_priors(of.robot, of.options);
  for (const SoughtSource& one : tolerated) {
    const bool sought =
        std::ranges::any_of(observation.sought(), [&](const auto& other) { return is_same_error(one, other); });
    if (!sought && one.prior_std) all.held.push_back(one);
  }
  std::vector<SoughtSource> errors = observation.sought();
  errors.insert(errors.end(), all.held.begin(), all.held.end());
  for (SoughtSource& one : errors) one.prior_std.reset();
  Observation whole(observation.robot(), of.measurements, of.options, errors, true);
  whole.groups() = observation.groups();
  whole.noise() = observation.noise();
  const auto start = whole.start(observation.errors(of.fit.fit().parameters));
  InformationRoot root(whole.unknown_count());
  if (!start || !whole(*start, root)) return {{}, std::move(all.covariance), std::move(all.noise)};

  const Eigen::Index sought = observation.source_count(), count = std::ssize(all.held);
  const std::vector<Eigen::Index> scales = whole.scale_columns();
  const Gains gain = gains(root.root(), scales, whole.nuisance_count(), sought);
  const double scale_variance = std::pow(of.options.scale_std, 2);
  Eigen::VectorXd held_variances(std::ssize(scales) + count);
  held_variances << Eigen::VectorXd::Constant(std::ssize(scales), scale_variance), variances(all.held, tolerated);
  const Eigen::MatrixXd open = Eigen::MatrixXd::Identity(sought, sought) - gain.sought;
  const Eigen::MatrixXd through = gain.held * held_variances.asDiagonal(), of_noise = all.noise;
  all.covariance = all.noise = Eigen::MatrixXd::Zero(sought + count, sought + count);
  all.noise.topLeftCorner(sought, sought) = of_noise;
  all.covariance.topLeftCorner(sought, sought) =
      of_noise + product(through, gain.held.transpose()) +
      product(open * variances(observation.sought(), tolerated).asDiagonal(), open.transpose());
  all.covariance.topRightCorner(sought, count) = -through.rightCols(count);
  all.covariance.bottomLeftCorner(count, sought) = -through.rightCols(count).transpose();
  all.covariance.bottomRightCorner(count, count).diagonal() = held_variances.tail(count);
  return all;
}

}  // namespace paracal::detail
