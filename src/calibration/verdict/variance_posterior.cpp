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

/// C + d d^T, d from the machine of the fit.
Eigen::MatrixXd about_the_fit(const LinearReadings& readings, const Eigen::VectorXd& errors,
                              const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd off = errors;
  off.head(readings.fitted.size()) -= readings.fitted;
  return covariance + off * off.transpose();
}

}  // namespace

double VariancePosterior::size(std::size_t term) const {
  double sum = 0.0;
  for (const Point& one : points) sum += one.weight * std::exp(2.0 * one.u(static_cast<Eigen::Index>(term)));
  return std::sqrt(sum);
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
                              .squares = {},
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
  posterior.squares = about_the_fit(readings, posterior.errors, posterior.covariance);
  posterior.noise = within(std::move(posterior.noise), posterior.covariance.topLeftCorner(n, n));
  return posterior;
}

namespace {

/// Information of blocks of readings about set-up and errors, station by station.
class Information {
 public:
  Information(const VarianceTable& table, const Eigen::VectorXd& u, Eigen::Index unknowns)
      : table_(table),
        u_(u),
        matrix_(Eigen::MatrixXd::Zero(unknowns, unknowns)),
        told_(Eigen::VectorXd::Zero(unknowns)) {}

  void add(const ReadingBlock& block, const Eigen::MatrixXd& rows, const Eigen::VectorXd& y) {
    const Eigen::MatrixXd V = covariance_of(block);
    const Eigen::MatrixXd weighed = cholesky_solution(V, rows);
    matrix_.noalias() += rows.transpose() * weighed;
    told_.noalias() += weighed.transpose() * y;
  }
  Eigen::MatrixXd& matrix() { return matrix_; }
  Eigen::VectorXd& told() { return told_; }

 private:
  double variance(Spreads what, Eigen::Index joint = -1) const {
    for (std::size_t k = 0; k < table_.terms().size(); ++k) {
      const VarianceTerm& one = table_.terms()[k];
      if (one.what == what && one.joint == joint) return std::exp(2.0 * u_(static_cast<Eigen::Index>(k)));
    }
    return 1.0;
  }

  /// Readings that share a pose share how far its joints are off; here each series has its own.
  Eigen::MatrixXd covariance_of(const ReadingBlock& block) const {
    const Eigen::Index rows = block.by_joint.rows();
    const auto series = static_cast<Eigen::Index>(block.series);
    Eigen::VectorXd noise = Eigen::VectorXd::Constant(
        rows, block.stated ? variance(Spreads::stated_noise) : variance(Spreads::noise, series));
    if (!block.stated && block.angles > 0) {
      noise.segment(block.first_angle, block.angles).setConstant(variance(Spreads::orientation_noise, series));
    }
    Eigen::MatrixXd V = (noise / block.visits).asDiagonal();
    for (Eigen::Index joint = 0; joint < block.by_joint.cols(); ++joint) {
      const double each = std::pow(table_.readings().joint_per_mm, 2) *
                          ((variance(Spreads::visits, joint) + variance(Spreads::visits)) / block.visits +
                           variance(Spreads::poses, joint) + variance(Spreads::poses));
      V += each * block.by_joint.col(joint) * block.by_joint.col(joint).transpose();
      if (block.by_from_joint.size() == 0) continue;
      V += each * block.by_from_joint.col(joint) * block.by_from_joint.col(joint).transpose();
    }
    return V;
  }

  const VarianceTable& table_;
  const Eigen::VectorXd& u_;
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd told_;
};

/// D(u).
Eigen::MatrixXd covariance_before(const VarianceTable& table, const Eigen::VectorXd& u) {
  const Eigen::Index n = table.readings().by_errors.cols();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t k = 0; k < table.terms().size(); ++k) {
    const VarianceTerm& one = table.terms()[k];
    if (!one.places.empty())
      all(one.places, one.places) += std::exp(2.0 * u(static_cast<Eigen::Index>(k))) * one.errors;
  }
  return all;
}

}  // namespace

VariancePosterior of_all(const StageFit& fit, const ReadingPlaces& places, const DriveSplines& drives,
                         const WeighedTable& some) {
  const LinearReadings& readings = some.table.readings();
  const Observation& observation = fit.observation();
  const Eigen::Index set_up = observation.nuisance_count(), n = observation.source_count();
  const Eigen::Index all = set_up + readings.by_errors.cols();
  Information information(some.table, some.mode.u, all);
  const Eigen::VectorXd from = readings.fitted;
  places.each_block(fit, 1, [&](ReadingBlock&& block) {
    Eigen::MatrixXd rows(block.rows.rows(), all);
    rows << block.rows.leftCols(set_up + n), by_drives(block, observation.joints(), drives.knots);
    information.add(block, rows, rows.middleCols(set_up, n) * from - block.rows.rightCols<1>());
  });
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(all - set_up, all - set_up);
  const Eigen::MatrixXd before = cholesky_solution(covariance_before(some.table, some.mode.u), identity);
  information.matrix().topLeftCorner(set_up, set_up) += readings.set_up_root.transpose() * readings.set_up_root;
  information.told().head(set_up) -= readings.set_up_root.transpose() * readings.set_up_reach;
  Eigen::MatrixXd with_priors = information.matrix();
  with_priors.bottomRightCorner(all - set_up, all - set_up) += before;
  const Eigen::VectorXd scale = with_priors.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() *
      cholesky_solution(scale.asDiagonal() * with_priors * scale.asDiagonal(), Eigen::MatrixXd::Identity(all, all)) *
      scale.asDiagonal();
  const Eigen::VectorXd mean = covariance * information.told();
  VariancePosterior posterior{.errors = mean.tail(all - set_up),
                              .covariance = covariance.bottomRightCorner(all - set_up, all - set_up),
                              .squares = {},
                              .points = {{some.mode.u, 1.0}}};
  posterior.squares = about_the_fit(readings, posterior.errors, posterior.covariance);
  const Eigen::MatrixXd noise = covariance * information.matrix() * covariance;
  posterior.noise = within(noise.block(set_up, set_up, n, n), posterior.covariance.topLeftCorner(n, n));
  return posterior;
}

}  // namespace paracal::detail
