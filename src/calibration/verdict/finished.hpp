#pragma once

// Private to calibration.

#include "explanation.hpp"

namespace paracal::detail {

/// A finished fit with what it came from: from this, evidence is drawn.
struct Finished {
  const Robot& robot;  ///< as given; the fit's has errors as they were expected
  const Measurements& measurements;
  const CalibrationOptions& options;
  const StageFit& fit;
  const Explanation* explanation = nullptr;  ///< none: the machine is taken to be its geometry

  const Observation& observation() const { return fit.observation(); }
};

}  // namespace paracal::detail
