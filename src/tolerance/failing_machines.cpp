#include "failing_machines.hpp"

#include <algorithm>
#include <cmath>

#include "cutting_planes.hpp"
#include "weighed_sample.hpp"

namespace paracal::detail {
namespace {

constexpr std::uint64_t kMachines = 16384, kPart = 256;
constexpr std::uint64_t kStreams = std::uint64_t{5} << 60;  // beyond those of any batch and of failure_share()

/// The design variable of each varying error, or -1.
std::vector<Eigen::Index> variables_of(const AllocationProblem& problem, const VaryingErrors& errors) {
  std::vector<Eigen::Index> variables;
  for (const Parameter& error : errors.parameters) {
    const auto has = [&](const DesignVariable& one) {
      return std::ranges::find(one.sources, error.source) != one.sources.end();
    };
    const auto found = std::ranges::find_if(problem.variables, has);
    variables.push_back(found == problem.variables.end() ? -1 : found - problem.variables.begin());
  }
  return variables;
}

}  // namespace

FailingMachines::FailingMachines(const Robot& robot, const AllocationProblem& problem,
                                 const std::vector<Requirement>& limits, const std::vector<Pose>& poses,
                                 const Eigen::VectorXd& half_widths)
    : at_(half_widths.array().log()), counts_(Eigen::ArrayXd::Zero(half_widths.size())) {
  const Tolerances tolerances = with(problem, half_widths);
  const Limits where(robot, tolerances, limits, poses);
  const FailureOptions options;
  const TiltedMixture mixture(where.errors(), likeliest_apart(where.modes(), where.errors()));
  const WeighedSample sample(where, mixture, kStreams, options);
  const std::vector<Eigen::Index> variables = variables_of(problem, where.errors());
  for (const Eigen::Index variable : variables) {
    if (variable >= 0) counts_(variable) += 1.0;
  }
  std::vector<double> weights;
  std::vector<Eigen::ArrayXd> squares;
  for (std::uint64_t first = 0; first < kMachines; first += kPart) {
    const WeighedSample::Machines drawn = sample.machines(first, kPart);
    for (Eigen::Index m = 0; m < drawn.weights.size(); ++m) {
      if (drawn.used_up(m) <= 1.0) continue;
      Eigen::ArrayXd of_this = Eigen::ArrayXd::Zero(half_widths.size());
      for (std::size_t k = 0; k < variables.size(); ++k) {
        const double z = drawn.errors(static_cast<Eigen::Index>(k), m) / where.errors().laws[k].std();
        if (variables[k] >= 0) of_this(variables[k]) += z * z;
      }
      weights.push_back(std::log(drawn.weights(m) / static_cast<double>(kMachines)));
      squares.push_back(of_this);
    }
  }
  log_weights_ = Eigen::Map<const Eigen::ArrayXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  squares_.resize(log_weights_.size(), half_widths.size());
  for (std::size_t m = 0; m < squares.size(); ++m) squares_.row(static_cast<Eigen::Index>(m)) = squares[m];
}

double FailingMachines::log_share(const std::vector<double>& x, std::vector<double>& gradient) const {
  const Eigen::ArrayXd step = Eigen::Map<const Eigen::ArrayXd>(x.data(), at_.size()) - at_.array();
  const Eigen::ArrayXd ratios = (-2.0 * step).exp();  // (T / T')^2
  const Eigen::ArrayXd exponents =
      log_weights_ - (counts_ * step).sum() + 0.5 * (squares_.matrix() * (1.0 - ratios).matrix()).array();
  const double largest = exponents.maxCoeff();
  const Eigen::ArrayXd terms = (exponents - largest).exp();
  const double sum = terms.sum();
  for (std::size_t v = 0; v < gradient.size(); ++v) {
    const auto k = static_cast<Eigen::Index>(v);
    gradient[v] = (terms * squares_.col(k)).sum() / sum * ratios(k) - counts_(k);
  }
  return largest + std::log(sum);
}

}  // namespace paracal::detail
