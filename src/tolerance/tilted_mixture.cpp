#include "tilted_mixture.hpp"

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "numerics/distributions.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::detail {
namespace {

constexpr double kAsDrawn = 0.05;       // share of machines as drawn, a defence where no mode was looked for
constexpr double kLikely = 0.05;        // a mode as likely as this needs no tilting
constexpr double kHardlyCounts = 1e-7;  // of the likeliest mode
constexpr double kApart = 1.0;          // standard deviations between the means of two laws of a mixture
constexpr std::size_t kMostModesApart = 64, kAllModes = 100'000;
constexpr std::uint64_t kChoice = std::uint64_t{1} << 40;  // number of the block that chooses the law

/// log Phi(-r), r >= 0
double log_tail(double r) {
  constexpr double kFar = 30.0;
  if (r < kFar) return std::log(normal_probability(-r));
  return -0.5 * r * r - std::log(r * std::sqrt(2.0 * std::numbers::pi));
}

/// Sums over the errors, of a . e tilted by theta a.
class TiltedSum {
 public:
  TiltedSum(const VaryingErrors& errors, const Eigen::VectorXd& a) : errors_(errors), a_(a) {}

  double mean(double theta) const {
    return sum([&](const SourceLaw& law, double a) { return a * law.mean(theta * a); });
  }
  double cumulant(double theta) const {
    return sum([&](const SourceLaw& law, double a) { return law.cumulant(theta * a); });
  }
  double variance() const {
    return sum([](const SourceLaw& law, double a) { return std::pow(a * law.std(), 2); });
  }
  double most() const {
    return sum([](const SourceLaw& law, double a) { return a > 0.0 ? a * law.most() : a * law.least(); });
  }
  double largest_theta() const {
    double largest = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < a_.size(); ++k) {
      if (a_(k) != 0.0) largest = std::min(largest, law(k).largest_tilt() / std::abs(a_(k)));
    }
    return largest;
  }
  /// theta with mean(theta) = 1, or as near to it as formulas reach.
  double theta_at_limit() const {
    const auto beyond = [&](double theta) { return mean(theta) - 1.0; };
    if (beyond(0.0) >= 0.0) return 0.0;
    const double largest = largest_theta();
    double low = 0.0, high = std::min(-beyond(0.0) / variance(), largest);
    while (beyond(high) < 0.0) {
      if (high >= largest) return largest;
      low = high;
      high = std::min(2.0 * high, largest);
    }
    constexpr int kDigits = 30;  // binary
    std::uintmax_t most = 100;
    const auto [one, other] =
        boost::math::tools::toms748_solve(beyond, low, high, boost::math::tools::eps_tolerance<double>(kDigits), most);
    return 0.5 * (one + other);
  }

 private:
  const SourceLaw& law(Eigen::Index k) const { return errors_.laws[static_cast<std::size_t>(k)]; }
  template <typename Term>
  double sum(const Term& term) const {
    double all = 0.0;
    for (Eigen::Index k = 0; k < a_.size(); ++k) {
      if (a_(k) != 0.0) all += term(law(k), a_(k));
    }
    return all;
  }

  const VaryingErrors& errors_;
  const Eigen::VectorXd& a_;
};

/// How far the means of two tilted laws are apart, in standard deviations.
double distance(const FailureMode& one, const FailureMode& other, const Eigen::ArrayXd& stds) {
  return ((one.tilt - other.tilt).array() * stds).matrix().norm();
}

}  // namespace

std::optional<FailureMode> failure_mode(const VaryingErrors& errors, const Eigen::VectorXd& a) {
  const TiltedSum sum(errors, a);
  if (!(sum.most() >= 1.0)) return std::nullopt;
  const double theta = sum.theta_at_limit(), cumulant = sum.cumulant(theta);
  const double r = std::sqrt(std::max(2.0 * (theta - cumulant), 0.0));
  return FailureMode{theta * a, cumulant, log_tail(r)};
}

std::vector<FailureMode> likeliest(std::vector<FailureMode> modes) {
  std::ranges::stable_sort(modes, std::greater(), &FailureMode::log_probability);
  const auto hardly_counts = [&](const FailureMode& mode) {
    return mode.log_probability < modes.front().log_probability + std::log(kHardlyCounts);
  };
  modes.erase(std::ranges::find_if(modes, hardly_counts), modes.end());
  if (modes.size() > kAllModes) modes.resize(kAllModes);
  return modes;
}

std::vector<FailureMode> likeliest_apart(std::vector<FailureMode> modes, const VaryingErrors& errors) {
  Eigen::ArrayXd stds(errors.size());
  std::ranges::transform(errors.laws, stds.begin(), &SourceLaw::std);
  std::vector<FailureMode> chosen;
  for (FailureMode& mode : likeliest(std::move(modes))) {
    if (chosen.size() == kMostModesApart) break;
    const auto near = [&](const FailureMode& other) { return distance(mode, other, stds) < kApart; };
    if (std::ranges::none_of(chosen, near)) chosen.push_back(std::move(mode));
  }
  return chosen;
}

TiltedMixture::TiltedMixture(const VaryingErrors& errors, std::vector<FailureMode> modes) : errors_(&errors) {
  const bool likely =
      std::ranges::any_of(modes, [](const FailureMode& mode) { return mode.log_probability > std::log(kLikely); });
  if (likely) modes.clear();
  const auto count = static_cast<Eigen::Index>(modes.size());
  tilts_ = Eigen::MatrixXd::Zero(count + 1, errors.size());
  log_weight_ = Eigen::ArrayXd::Zero(count + 1);
  Eigen::ArrayXd share = Eigen::ArrayXd::Ones(count + 1);
  if (count > 0) {
    Eigen::ArrayXd log_probability(count);
    std::ranges::transform(modes, log_probability.begin(), &FailureMode::log_probability);
    share.tail(count) = (log_probability - log_probability.maxCoeff()).exp();
    share.tail(count) *= (1.0 - kAsDrawn) / share.tail(count).sum();
    share(0) = kAsDrawn;
  }
  log_weight_ = share.log();
  double sum = 0.0;
  for (Eigen::Index j = 0; j <= count; ++j) {
    shares_.push_back(sum += share(j));
    if (j == 0) continue;
    const FailureMode& mode = modes[static_cast<std::size_t>(j - 1)];
    tilts_.row(j) = mode.tilt.transpose();
    log_weight_(j) -= mode.cumulant;
  }
}

std::size_t TiltedMixture::law_of(double probability) const {
  const auto place = static_cast<std::size_t>(std::ranges::upper_bound(shares_, probability) - shares_.begin());
  return std::min(place, shares_.size() - 1);
}

void TiltedMixture::draw(std::uint64_t seed, std::uint64_t first, Eigen::Ref<Eigen::MatrixXd> errors,
                         Eigen::Ref<Eigen::ArrayXd> log_ratio) const {
  for (Eigen::Index m = 0; m < errors.cols(); ++m) {
    const std::uint64_t stream = first + static_cast<std::uint64_t>(m);
    const std::size_t law = is_plain() ? 0 : law_of(normal_probability(normal_pair(seed, stream, kChoice)[0]));
    std::optional<std::uint64_t> drawn;
    std::array<double, 2> pair{};
    for (Eigen::Index k = 0; k < errors.rows(); ++k) {
      const std::uint64_t number = errors_->parameters[static_cast<std::size_t>(k)].number;
      if (number / 2 != drawn) pair = normal_pair(seed, stream, *(drawn = number / 2));
      const double normal = pair[number % 2];
      errors(k, m) = errors_->laws[static_cast<std::size_t>(k)].draw(tilts_(static_cast<Eigen::Index>(law), k), normal);
    }
  }
  if (is_plain()) {
    log_ratio.setZero();
    return;
  }
  Eigen::ArrayXXd exponents = (tilts_ * errors).array().colwise() + log_weight_;
  const Eigen::ArrayXd largest = exponents.colwise().maxCoeff();
  exponents.rowwise() -= largest.transpose();
  log_ratio = -(largest + exponents.exp().colwise().sum().transpose().log());
}

}  // namespace paracal::detail
