#include "variance_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/dense.hpp"
#include "numerics/square_root.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::detail {
namespace {

struct Sample {
  Eigen::VectorXd u;
  VarianceTable::At at;
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
      const Eigen::VectorXd u = one.mode.u + side * product(root, z);
      Sample sample{u, one.table.at(u, false), 0.5 * z.squaredNorm() - one.mode.log_density};
      sample.weight -= sample.at.cost;  // its logarithm as yet
      if (std::isfinite(sample.weight)) samples.push_back(std::move(sample));
    }
  }
  double sum = 0.0;
  for (Sample& sample : samples) sum += sample.weight = std::exp(sample.weight);
  for (Sample& sample : samples) sample.weight *= one.probability / sum;
  return samples;
}

/// Errors x = L t, t ~ N(0, I) beforehand, given readings y = S a + X L t + noise: the information of (a, t) is
///
///   H = (S X L)^T N^-1 (S X L) + diag(R^T R, I) = K K^T.
///
/// With K_t, the part of t in the lower right corner of K, x has the covariance F F^T, F = L K_t^-T. A product stays
/// semidefinite where a difference of covariances is lost in rounding.
class ErrorsGivenReadings {
 public:
  /// @param information  H of the readings, that of the set-up's priors among them, without the I of t. Its lower
  ///                     triangle is read.
  /// @param told  its right side.
  ErrorsGivenReadings(Eigen::MatrixXd information, const Eigen::VectorXd& told, const Eigen::MatrixXd& L)
      : sizes_(L.cols()) {
    information.diagonal().tail(sizes_).array() += 1.0;
    K_ = cholesky(information);
    const auto K_t = K_.bottomRightCorner(sizes_, sizes_).triangularView<Eigen::Lower>();
    root_ = K_t.solve(L.transpose()).transpose();
    mean_ = gain(told);
  }

  const Eigen::VectorXd& mean() const { return mean_; }
  const Eigen::MatrixXd& root() const { return root_; }
  /// What changes of the right side do to the mean: x = F [K^-1 told]_t.
  Eigen::MatrixXd gain(const Eigen::MatrixXd& told) const { return product(root_, solved(told).bottomRows(sizes_)); }

 private:
  Eigen::MatrixXd solved(const Eigen::MatrixXd& told) const { return K_.triangularView<Eigen::Lower>().solve(told); }

  Eigen::Index sizes_;  ///< t
  Eigen::MatrixXd K_, root_;
  Eigen::VectorXd mean_;
};

/// The readings of a table at one set of variances, whitened by N.
class WhitenedReadings {
 public:
  WhitenedReadings(const VarianceTable& table, const Eigen::VectorXd& u)
      : readings_(table.readings()), L_(table.root_of_errors(u)), N_root_(cholesky(table.covariance_beside_errors(u))) {
    Eigen::MatrixXd all(readings_.y.size(), readings_.by_set_up.cols() + L_.cols());
    all << readings_.by_set_up, product(readings_.by_errors, L_);
    rows_ = whitened(all);
  }

  ErrorsGivenReadings errors() const {
    const Eigen::Index set_up = readings_.by_set_up.cols();
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(rows_.cols(), rows_.cols());  // its lower triangle alone
    add_square(information, rows_.transpose());
    information.topLeftCorner(set_up, set_up) += product(readings_.set_up_root.transpose(), readings_.set_up_root);
    Eigen::VectorXd told = product(rows_.transpose(), whitened(readings_.y));
    told.head(set_up) -= product(readings_.set_up_root.transpose(), readings_.set_up_reach);
    return {std::move(information), told, L_};
  }

  /// Root of the part of the noise in the covariance of the errors of parts.
  Eigen::MatrixXd noise_root(const VarianceTable& table, const Eigen::VectorXd& u) const {
    const Eigen::MatrixXd of_noise = whitened(table.noise_variances(u).cwiseSqrt().asDiagonal());
    return errors().gain(product(rows_.transpose(), of_noise)).topRows(readings_.prior.rows());
  }

 private:
  Eigen::MatrixXd whitened(const Eigen::MatrixXd& rows) const {
    return N_root_.triangularView<Eigen::Lower>().solve(rows);
  }

  const LinearReadings& readings_;
  Eigen::MatrixXd L_, N_root_, rows_;
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

/// The covariance of readings V = N + X D X^T, of which errors are by far the most, tells errors as the small
/// difference D - D X^T V^-1 X D: of readings that are exact to the last digit it tells nothing.
bool keeps_digits(const VarianceTable& table, const Eigen::VectorXd& u) {
  constexpr double kMost = 1e8;  // of X D X^T over N: eight digits of a covariance are left
  double of_errors = 0.0;
  for (const auto& [term, std] : table.error_terms(u)) of_errors += std * std * term->trace();
  return of_errors < kMost * table.noise_variances(u).minCoeff();
}

/// Sums over samples of the variances, each with its weight.
class Averages {
 public:
  explicit Averages(const LinearReadings& readings)
      : errors_(readings.by_errors.cols()),
        all_{.errors = Eigen::VectorXd::Zero(errors_), .covariance = Eigen::MatrixXd::Zero(errors_, errors_)} {
    all_.noise = Eigen::MatrixXd::Zero(readings.prior.rows(), readings.prior.rows());
  }

  /// Errors x = sum_g x_g, x_g ~ N(0, s_g^2 D_g), given readings y = S a + X x + noise, P = V^-1 but for the set-up:
  ///
  ///   mean  sum_g s_g^2 (X D_g)^T P y,   covariance  sum_gh delta_gh s_g^2 D_g - s_g^2 (X D_g)^T P (X D_h) s_h^2.
  ///
  /// Only s and P differ from sample to sample, so that a sum of multiples of P is all that a pair of groups needs.
  void add_by_covariance(const VarianceTable& table, const std::vector<Sample>& samples) {
    const std::size_t groups = table.error_terms(samples.front().u).size();
    for (std::size_t g = 0; g < groups; ++g) {
      for (std::size_t h = 0; h <= g; ++h) add_pair(table, samples, g, h);
    }
    for (const Sample& sample : samples) add_mean(sample, gain(table, sample.u, sample.at.z));
    const Sample& best = *std::ranges::max_element(samples, {}, &Sample::weight);
    const Eigen::VectorXd noise = table.noise_variances(best.u).cwiseSqrt();
    add_noise(samples, gain(table, best.u, best.at.P * noise.asDiagonal()).topRows(all_.noise.rows()));
  }

  /// The same by the information of each sample.
  void add_by_information(const VarianceTable& table, const std::vector<Sample>& samples) {
    for (const Sample& sample : samples) {
      const ErrorsGivenReadings errors = WhitenedReadings(table, sample.u).errors();
      add_mean(sample, errors.mean());
      all_.covariance += product(sample.weight * errors.root(), errors.root().transpose());
    }
    const Eigen::VectorXd& best = std::ranges::max_element(samples, {}, &Sample::weight)->u;
    add_noise(samples, WhitenedReadings(table, best).noise_root(table, best));
  }

  VariancePosterior posterior() && {
    for (const auto& [weight, mean] : means_) all_.errors += weight * mean;
    Eigen::MatrixXd off(errors_, std::ssize(means_));
    for (Eigen::Index k = 0; k < off.cols(); ++k) {
      const auto& [weight, mean] = means_[static_cast<std::size_t>(k)];
      off.col(k) = std::sqrt(weight) * (mean - all_.errors);
    }
    add_square(all_.covariance, off);
    complete_from_lower(all_.covariance);
    const Eigen::Index n = all_.noise.rows();
    all_.noise = within(std::move(all_.noise), all_.covariance.topLeftCorner(n, n));
    return std::move(all_);
  }

 private:
  void add_pair(const VarianceTable& table, const std::vector<Sample>& samples, std::size_t g, std::size_t h) {
    double before = 0.0;
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(samples.front().at.P.rows(), samples.front().at.P.cols());
    for (const Sample& sample : samples) {
      const auto terms = table.error_terms(sample.u);
      const double s = terms[g].second * terms[h].second;
      before += sample.weight * s;
      P += sample.weight * s * s * sample.at.P;
    }
    const auto terms = table.error_terms(samples.front().u);
    const VarianceTerm &one = *terms[g].first, &other = *terms[h].first;
    Eigen::MatrixXd errors = product(-one.with_readings.transpose(), product(P, other.with_readings));
    if (g == h) errors += before * one.covariance;
    all_.covariance(one.places, other.places) += errors;
    if (g != h) all_.covariance(other.places, one.places) += errors.transpose();
  }

  /// What readings, multiplied by P, do to the means of the errors.
  Eigen::MatrixXd gain(const VarianceTable& table, const Eigen::VectorXd& u, const Eigen::MatrixXd& readings) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(errors_, readings.cols());
    for (const auto& [term, std] : table.error_terms(u)) {
      all(term->places, Eigen::all) += std * std * product(term->with_readings.transpose(), readings);
    }
    return all;
  }

  void add_mean(const Sample& sample, Eigen::VectorXd mean) {
    means_.emplace_back(sample.weight, std::move(mean));
    all_.points.push_back({sample.u, sample.weight});
  }
  void add_noise(const std::vector<Sample>& samples, const Eigen::MatrixXd& root) {
    double probability = 0.0;
    for (const Sample& sample : samples) probability += sample.weight;
    all_.noise += product(probability * root, root.transpose());
  }

  Eigen::Index errors_;
  VariancePosterior all_;
  std::vector<std::pair<double, Eigen::VectorXd>> means_;
};

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

NoiseOfSeries VariancePosterior::noise_of_series(const VarianceTable& table) const {
  NoiseOfSeries all = table.entered();
  for (const std::size_t term : table.terms_of(Spreads::stated_noise)) {
    for (SeriesNoise& one : all) one.stated *= size(term);
  }
  for (const std::size_t term : table.terms_of(Spreads::noise)) {
    all[static_cast<std::size_t>(table.terms()[term].joint)].unstated *= size(term);
  }
  return all;
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
  Averages all(readings);
  for (const WeighedTable& one : tables) {
    const std::vector<Sample> samples = samples_about(one);
    if (keeps_digits(one.table, one.mode.u)) {
      all.add_by_covariance(one.table, samples);
    } else {
      all.add_by_information(one.table, samples);
    }
  }
  return std::move(all).posterior();
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
    const Eigen::VectorXd y = product(rows.middleCols(set_up, n), readings.fitted) - block.rows.rightCols<1>();
    const Eigen::MatrixXd weighed = cholesky_solution(some.table.covariance_of(block, u), rows);
    information += product(rows.transpose(), weighed);
    told += product(weighed.transpose(), y);
  });
  information.topLeftCorner(set_up, set_up) += product(readings.set_up_root.transpose(), readings.set_up_root);
  told.head(set_up) -= product(readings.set_up_root.transpose(), readings.set_up_reach);
  const Eigen::MatrixXd L = some.table.root_of_errors(u);
  Eigen::MatrixXd by_sizes = Eigen::MatrixXd::Zero(all, set_up + L.cols());  // the unknowns by (a, t)
  by_sizes.topLeftCorner(set_up, set_up).setIdentity();
  by_sizes.bottomRightCorner(errors, L.cols()) = L;
  information = product(product(by_sizes.transpose(), information), by_sizes);
  const ErrorsGivenReadings given(information, product(by_sizes.transpose(), told), L);
  const Eigen::MatrixXd noise = given.gain(square_root(information)).topRows(n);
  VariancePosterior posterior{
      .errors = given.mean(), .covariance = product(given.root(), given.root().transpose()), .points = {{u, 1.0}}};
  posterior.noise = within(product(noise, noise.transpose()), posterior.covariance.topLeftCorner(n, n));
  return posterior;
}

}  // namespace paracal::detail
