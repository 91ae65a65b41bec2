#include "sought.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "paracal/mechanism/base_motion.hpp"

namespace paracal::detail {
namespace {

bool listed(const std::vector<SourceSelector>& selectors, std::size_t limb, Source source) {
  return std::ranges::any_of(selectors, [&](const SourceSelector& one) { return one.matches(limb, source); });
}

template <typename Wanted>
std::vector<SoughtSource> select(const Robot& robot, const CalibrationOptions& options, Wanted&& wanted) {
  std::vector<SoughtSource> sought;
  for (const Parameter& one : robot.parameters()) {
    const bool fixed = one.as_joint_zero != 0.0 || listed(options.fixed, one.limb, one.source);
    if (!fixed && wanted(one.source)) sought.push_back({one.limb, one.source});
  }
  return sought;
}

}  // namespace

std::vector<SoughtSource> encoder_offsets(const Robot& robot, const CalibrationOptions& options) {
  return select(robot, options, [](Source source) { return is_joint_zero(source); });
}

std::vector<SoughtSource> position_group(const Robot& robot, const CalibrationOptions& options) {
  return select(robot, options, [](Source source) { return !tilts_plate(source); });
}

std::vector<SoughtSource> paper_columns(const Robot& robot, const CalibrationOptions& options) {
  static const std::vector<SourceSelector> kEquation15{{"e_x", 1}, {"e_z", 1}, {"e_z", 2},
                                                       {"e_x", 3}, {"e_y", 3}, {"e_z", 3}};
  std::vector<SoughtSource> sought = position_group(robot, options);
  if (robot.limb_count() != 4) return sought;
  std::erase_if(sought, [&](const SoughtSource& one) { return listed(kEquation15, one.limb, one.source); });
  return sought;
}

std::vector<SoughtSource> all_with_priors(const Robot& robot, const CalibrationOptions& options) {
  const Tolerances tolerances = options.tolerances.value_or(tolerances_of(robot));
  std::vector<SoughtSource> sought = select(robot, options, [](Source) { return true; });
  for (SoughtSource& one : sought) {
    if (listed(options.free, one.limb, one.source)) continue;
    double variance = std::pow(felt_std(robot, tolerances, one.limb, one.source), 2);
    if (variance > 0.0) {
      for (const CommonError& error : options.common) {
        variance += std::pow(error.std * error.direction(one.limb, one.source), 2);
      }
    }
    one.prior_std = std::sqrt(variance);
  }
  std::erase_if(sought, [](const SoughtSource& one) { return one.prior_std == 0.0; });
  return sought;
}

/// prior_std has the share of common errors already.
Eigen::MatrixXd prior_covariance(const std::vector<SoughtSource>& errors, const std::vector<CommonError>& common,
                                 const Eigen::VectorXd& factors) {
  const Eigen::Index count = std::ssize(errors);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SoughtSource& one = errors[static_cast<std::size_t>(i)];
    constexpr double kNone = 1e6;  // mm or rad: sought without a prior among others that have one
    covariance(i, i) = std::pow(one.prior_std.value_or(kNone), 2);
    for (Eigen::Index k = 0; k < i; ++k) {
      const SoughtSource& other = errors[static_cast<std::size_t>(k)];
      if (!one.prior_std || !other.prior_std) continue;
      for (const CommonError& error : common) {
        covariance(i, k) += factors(i) * factors(k) * error.std * error.std * error.direction(one.limb, one.source) *
                            error.direction(other.limb, other.source);
      }
      covariance(k, i) = covariance(i, k);
    }
  }
  return covariance;
}

}  // namespace paracal::detail
