#pragma once

// Private to calibration: wrong numbers of a robot file.

#include <Eigen/Core>
#include <vector>

#include "dimensions.hpp"
#include "mistake.hpp"

namespace paracal::detail {

/// Numbers of the robot file that are wrong together, and what they should be.
struct Misprint {
  std::vector<Dimension> of;
  Eigen::VectorXd values;

  std::size_t count() const { return of.size(); }
  double value(std::size_t k) const { return values(static_cast<Eigen::Index>(k)); }
};

/// "the readings fit a robot whose rod_mm is 960.0, the file says 950". Undone with the joints as the controller
/// believed them, which the wrong numbers told it.
Mistake mistake_of(const Robot& given, const Misprint& misprint);

}  // namespace paracal::detail
