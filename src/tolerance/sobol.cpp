#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "numerics/distributions.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/tolerance/analysis.hpp"

namespace paracal {
namespace {

constexpr std::uint64_t kOther = std::uint64_t{1} << 63;  // streams of the machines B

std::vector<Source> varying(const Robot& robot, const Tolerances& tolerances) {
  std::vector<Source> sources;
  for (const Source source : sources_of(robot.limbs())) {
    if (tolerances.std(source) > 0.0) sources.push_back(source);
  }
  return sources;
}

/// f of A, of B, and of A with the errors k of B, a row a machine.
class PickAndFreeze {
 public:
  PickAndFreeze(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic, const Pose& pose,
                const SobolOptions& options)
      : robot_(robot),
        tolerances_(tolerances),
        options_(options),
        response_(robot, {characteristic}, {pose}),
        sources_(varying(robot, tolerances)),
        values_(options.samples, static_cast<Eigen::Index>(sources_.size()) + 2) {}

  const std::vector<Source>& sources() const { return sources_; }

  const Eigen::ArrayXXd& evaluate() {
    tbb::task_arena arena(options_.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(options_.threads));
    arena.execute([&] { tbb::parallel_for(0, options_.samples, [&](int m) { evaluate(m); }); });
    return values_;
  }

 private:
  SourceErrors drawn(std::uint64_t stream) const {
    RandomStream random(options_.seed, stream);
    return draw_errors(robot_, tolerances_, random);
  }

  void evaluate(int m) {
    const auto stream = static_cast<std::uint64_t>(m);
    const SourceErrors one = drawn(stream), other = drawn(stream | kOther);
    values_(m, 0) = length(one);
    values_(m, 1) = length(other);
    for (std::size_t k = 0; k < sources_.size(); ++k) {
      SourceErrors mixed = one;
      for (std::size_t limb = 0; limb < robot_.limb_count(); ++limb)
        mixed(limb, sources_[k]) = other(limb, sources_[k]);
      values_(m, static_cast<Eigen::Index>(k) + 2) = length(mixed);
    }
  }

  double length(const SourceErrors& errors) const {
    Eigen::VectorXd components = Eigen::VectorXd::Zero(response_.rows());
    if (options_.model == Model::exact) {
      if (!response_.exact(errors, components)) throw Unreachable("a simulated machine cannot reach the pose");
      return components.norm();
    }
    for (std::size_t k = 0; k < robot_.parameters().size(); ++k) {
      const Parameter& one = robot_.parameters()[k];
      components += response_.linear().col(static_cast<Eigen::Index>(k)) * errors(one.limb, one.source);
    }
    return components.norm();
  }

  const Robot& robot_;
  const Tolerances& tolerances_;
  const SobolOptions& options_;
  Response response_;
  std::vector<Source> sources_;
  Eigen::ArrayXXd values_;
};

double correlation(const Eigen::ArrayXd& one, const Eigen::ArrayXd& other) {
  const Eigen::ArrayXd a = one - one.mean(), b = other - other.mean();
  const double scale = std::sqrt(a.square().sum() * b.square().sum());
  return scale > 0.0 ? (a * b).sum() / scale : 0.0;
}

/// Interval of a correlation coefficient of n pairs  [fisher1921].
Interval fisher(double correlation, int n, double confidence) {
  const double z = detail::two_sided_quantile(confidence) / std::sqrt(n - 3.0);
  const double centre = std::atanh(std::clamp(correlation, -1.0 + 1e-15, 1.0 - 1e-15));
  return {std::tanh(centre - z), std::tanh(centre + z)};
}

}  // namespace

std::vector<SobolIndex> sobol_indices(const Robot& robot, const Tolerances& tolerances, Characteristic characteristic,
                                      const Pose& pose, const SobolOptions& options) {
  if (options.samples < 8) throw InvalidArgument("Sobol indices: expected at least 8 samples");
  PickAndFreeze machines(robot, tolerances, characteristic, pose, options);
  const Eigen::ArrayXXd& values = machines.evaluate();
  std::vector<SobolIndex> indices;
  for (std::size_t k = 0; k < machines.sources().size(); ++k) {
    const Eigen::ArrayXd mixed = values.col(static_cast<Eigen::Index>(k) + 2);
    const double with_other = correlation(values.col(1), mixed), with_one = correlation(values.col(0), mixed);
    const Interval rest = fisher(with_one, options.samples, options.confidence);
    indices.push_back({.source = machines.sources()[k],
                       .first = with_other,
                       .total = 1.0 - with_one,
                       .first_interval = fisher(with_other, options.samples, options.confidence),
                       .total_interval = {1.0 - rest.high, 1.0 - rest.low}});
  }
  std::ranges::stable_sort(indices, std::ranges::greater(), &SobolIndex::total);
  return indices;
}

}  // namespace paracal
