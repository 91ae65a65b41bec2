#pragma once

// Private to calibration: plans that machines within the tolerances can follow.

#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// Whether machines can be sent to a pose, as the tolerances allow them: by their own joints and by those of the
/// nominal one. A fixed set of machines says so, whose errors are three times as large as drawn: so few then stand for
/// the rare ones among many. Errors that tilt a level plate are left out: they hardly change reach, and cost an
/// iteration a pose.
class ToleratedReach {
 public:
  explicit ToleratedReach(const Robot& robot);

  bool operator()(const Pose& pose) const;

 private:
  Machine nominal_;
  std::vector<Machine> machines_;  ///< none where not even home is reached: such tolerances say nothing
};

/// How far the workspace must shrink towards its centre to keep away from the rim of reach: 1 where it need not.
double tolerated_share(const Robot& robot);

}  // namespace paracal::detail
