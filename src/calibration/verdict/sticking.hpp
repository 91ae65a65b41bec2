#pragma once

// Private to calibration: a joint that stops elsewhere now and then.

#include <optional>
#include <string>

#include "calibration/fit/stage_fit.hpp"

namespace paracal::detail {

struct StickingJoint {
  Eigen::Index joint = 0;
  double size = 0.0;                  ///< how far from where it stops else, root mean square, rad or mm
  std::size_t stuck = 0, visits = 0;  ///< visits at which it did so, of all
  double probability = 0.0;           ///< that these are no readings that are off in directions of their own

  /// As far as so few visits tell, more often than what an uncertainty of 95 % may leave out.
  bool may_be_often() const;
};

/// From poses that were visited at least three times, whether their readings are in use or not: visits that are far
/// from the median visit of their pose, if one joint explains nearly all of it.
std::optional<StickingJoint> sticking_joint(const StageFit& fit);

/// How often, how far, and what U includes.
std::string text_of(const StickingJoint& found, const Robot& robot);

}  // namespace paracal::detail
