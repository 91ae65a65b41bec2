#include "variance_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/dense.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::detail {
namespace {

struct Sample {
  Eigen::VectorXd u;
  VarianceTable::At at = {};
  double weight = 0.0;
};

/// In pairs on both sides of the mode, a little wider than Laplace's approximation: weights mend what is too wide, not
/// what is missing.
std::vector<Sample> samples_about(const WeighedTable& one) {
  constexpr int kPairs = 8;
  constexpr double kWider = 1.1, kFlat = 0.5;
  constexpr std::uint64_t kSeed = 64;
  const SymmetricEigen axes = symmetric_eigen(one.mode.curvature);
  const Eigen::MatrixXd root =
      kWider * axes.vectors * axes.values.cwiseMax(kFlat).cwiseSqrt().cwiseInverse().asDiagonal();
  RandomStream random(kSeed);
  std::vector<Sample> samples;
  for (int pair = 0; pair < kPairs; ++pair) {
    const Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(root.cols(), [&] { return random.normal(); });
    for (const double side : {1.0, -1.0}) {
      Sample sample{one.mode.u + side * root * z};
      sample.at = one.table.at(sample.u, false);
      sample.weight = 0.5 * z.squaredNorm() - (sample.at.cost + one.mode.log_density);  // its logarithm as yet
      if (std::isfinite(sample.weight)) samples.push_back(std::move(sample));
    }
  }
  double sum = 0.0;
  for (Sample& sample : samples) sum += sample.weight = std::exp(sample.weight);
  for (Sample& sample : samples) sample.weight *= one.probability / sum;
  return samples;
}

/// Of errors: E[Var] + Var[E], where with D = sum_t v_t D_t of one set of variances the errors have the mean
/// sum_t v_t D_t X^T z and the covariance D - sum_t,u v_t v_u D_t X^T P X D_u.
class ErrorMoments {
 public:
  explicit ErrorMoments(const VarianceTable& table) : table_(table) {
    for (std::size_t k = 0; k < table.terms().size(); ++k) {
      if (!table.terms()[k].places.empty()) parts_.push_back({&table.terms()[k], static_cast<Eigen::Index>(k)});
    }
    if (!table.fixed_errors().places.empty()) parts_.push_back({&table.fixed_errors(), -1});
    const Eigen::Index count = table.readings().y.size();
    for (Part& part : parts_) part.with.assign(parts_.size(), Eigen::MatrixXd::Zero(count, count));
  }

  /// @returns the mean of the errors with these variances.
  Eigen::VectorXd add(const Sample& sample) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(table_.readings().by_errors.cols());
    for (std::size_t s = 0; s < parts_.size(); ++s) {
      const VarianceTerm& term = *parts_[s].term;
      const double variance = variance_of(parts_[s], sample.u);
      const Eigen::VectorXd share = term.by_errors.transpose() * sample.at.z;
      mean(term.places) += variance * share;
      parts_[s].mean += sample.weight * variance;
      for (std::size_t t = 0; t <= s; ++t) {
        parts_[s].with[t] += sample.weight * variance * variance_of(parts_[t], sample.u) * sample.at.P;
      }
    }
    return mean;
  }

  Eigen::MatrixXd mean_covariance() const {
    const Eigen::Index n = table_.readings().by_errors.cols();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t s = 0; s < parts_.size(); ++s) {
      const VarianceTerm& one = *parts_[s].term;
      all(one.places, one.places) += parts_[s].mean * one.errors;
      for (std::size_t t = 0; t <= s; ++t) {
        const VarianceTerm& other = *parts_[t].term;
        const Eigen::MatrixXd told = one.by_errors.transpose() * (parts_[s].with[t] * other.by_errors);
        all(one.places, other.places) -= told;
        if (t < s) all(other.places, one.places) -= told.transpose();
      }
    }
    return all;
  }

  /// G N G^T of the noise N, with the errors of parts found by G y.
  Eigen::MatrixXd noise_part(const Sample& sample) const {
    Eigen::VectorXd noise = Eigen::VectorXd::Zero(table_.readings().y.size());
    for (std::size_t k = 0; k < table_.terms().size() && table_.terms()[k].what <= Spreads::orientation_noise; ++k) {
      noise += std::exp(2.0 * sample.u(static_cast<Eigen::Index>(k))) * table_.terms()[k].readings.diagonal();
    }
    Eigen::MatrixXd found = Eigen::MatrixXd::Zero(table_.readings().by_errors.cols(), noise.size());
    for (const Part& part : parts_) {
      const Eigen::MatrixXd share = part.term->by_errors.transpose() * sample.at.P;
      found(part.term->places, Eigen::all) += variance_of(part, sample.u) * share;
    }
    const Eigen::Index n = table_.readings().prior.rows();
    return found.topRows(n) * noise.asDiagonal() * found.topRows(n).transpose();
  }

 private:
  struct Part {
    const VarianceTerm* term;
    Eigen::Index variance;  ///< its place; -1: 1
    double mean = 0.0;
    std::vector<Eigen::MatrixXd> with = {};
  };
  static double variance_of(const Part& part, const Eigen::VectorXd& u) {
    return part.variance < 0 ? 1.0 : std::exp(2.0 * u(part.variance));
  }

  const VarianceTable& table_;
  std::vector<Part> parts_;
};

/// No part of a variance is larger than all of it.
Eigen::MatrixXd within(Eigen::MatrixXd part, const Eigen::MatrixXd& all) {
  constexpr double kRounding = 1e-9;
  for (Eigen::Index k = 0; k < part.rows(); ++k) {
    const double share = part(k, k) / all(k, k);
    if (share <= 1.0 - kRounding) continue;
    const double factor = std::sqrt((1.0 - kRounding) / share);
    part.row(k) *= factor;
    part.col(k) *= factor;
  }
  return part;
}

}  // namespace

double VariancePosterior::size(std::size_t term) const {
  double sum = 0.0;
  for (const Point& one : points) sum += one.weight * std::exp(2.0 * one.u(static_cast<Eigen::Index>(term)));
  return std::sqrt(sum);
}

double VariancePosterior::largest(const std::vector<std::size_t>& terms) const {
  double most = 0.0;
  for (const std::size_t term : terms) most = std::max(most, size(term));
  return most;
}

double VariancePosterior::noise_factor(const VarianceTable& table) const {
  double factor = 1.0;
  for (const Spreads what : {Spreads::noise, Spreads::stated_noise}) {
    if (const double one = largest(table.terms_of(what)); one > 0.0) factor *= one;
  }
  return factor;
}

double VariancePosterior::probability_above(const std::vector<std::size_t>& terms, double std) const {
  double sum = 0.0;
  for (const Point& one : points) {
    double square = 0.0;
    for (const std::size_t term : terms) square += std::exp(2.0 * one.u(static_cast<Eigen::Index>(term)));
    if (square > std * std) sum += one.weight;
  }
  return std::min(sum, 1.0);
}

VariancePosterior averaged(const std::vector<WeighedTable>& tables) {
  const LinearReadings& readings = tables.front().table.readings();
  const Eigen::Index all = readings.by_errors.cols(), n = readings.prior.rows();
  VariancePosterior posterior{.errors = Eigen::VectorXd::Zero(all),
                              .covariance = Eigen::MatrixXd::Zero(all, all),
                              .noise = Eigen::MatrixXd::Zero(n, n)};
  std::vector<std::pair<double, Eigen::VectorXd>> means;
  for (const WeighedTable& one : tables) {
    const std::vector<Sample> samples = samples_about(one);
    ErrorMoments moments(one.table);
    for (const Sample& sample : samples) {
      means.emplace_back(sample.weight, moments.add(sample));
      posterior.errors += sample.weight * means.back().second;
      posterior.points.push_back({sample.u, sample.weight});
    }
    posterior.covariance += moments.mean_covariance();
    const auto best = std::ranges::max_element(samples, {}, &Sample::weight);
    posterior.noise += one.probability * moments.noise_part(*best);
  }
  for (const auto& [weight, mean] : means) {
    const Eigen::VectorXd off = mean - posterior.errors;
    posterior.covariance += weight * off * off.transpose();
  }
  posterior.covariance = 0.5 * (posterior.covariance + posterior.covariance.transpose()).eval();
  posterior.noise = within(std::move(posterior.noise), posterior.covariance.topLeftCorner(n, n));
  return posterior;
}

VariancePosterior of_all(const StageFit& fit, const ReadingPlaces& places, const DriveSplines& drives,
                         const WeighedTable& some) {
  const LinearReadings& readings = some.table.readings();
  const Eigen::VectorXd& u = some.mode.u;
  const Observation& observation = fit.observation();
  const Eigen::Index set_up = observation.nuisance_count(), n = observation.source_count();
  const Eigen::Index errors = readings.by_errors.cols(), all = set_up + errors;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(all, all);
  Eigen::VectorXd told = Eigen::VectorXd::Zero(all);
  places.each_block(fit, 1, [&](ReadingBlock&& block) {
    Eigen::MatrixXd rows(block.rows.rows(), all);
    rows << block.rows.leftCols(set_up + n), by_drives(block, observation.joints(), drives.knots);
    const Eigen::VectorXd y = rows.middleCols(set_up, n) * readings.fitted - block.rows.rightCols<1>();
    const Eigen::MatrixXd weighed = cholesky_solution(some.table.covariance_of(block, u), rows);
    information.noalias() += rows.transpose() * weighed;
    told.noalias() += weighed.transpose() * y;
  });
  information.topLeftCorner(set_up, set_up) += readings.set_up_root.transpose() * readings.set_up_root;
  told.head(set_up) -= readings.set_up_root.transpose() * readings.set_up_reach;
  Eigen::MatrixXd with_priors = information;
  with_priors.bottomRightCorner(errors, errors) +=
      cholesky_solution(some.table.covariance_of_errors(u), Eigen::MatrixXd::Identity(errors, errors));
  const Eigen::VectorXd scale = with_priors.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() *
      cholesky_solution(scale.asDiagonal() * with_priors * scale.asDiagonal(), Eigen::MatrixXd::Identity(all, all)) *
      scale.asDiagonal();
  const Eigen::MatrixXd noise = covariance * information * covariance;
  VariancePosterior posterior{.errors = (covariance * told).tail(errors),
                              .covariance = covariance.bottomRightCorner(errors, errors),
                              .points = {{u, 1.0}}};
  posterior.noise = within(noise.block(set_up, set_up, n, n), posterior.covariance.topLeftCorner(n, n));
  return posterior;
}

}  // namespace paracal::detail
