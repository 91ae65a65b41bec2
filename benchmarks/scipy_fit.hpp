#pragma once

#include <string>
#include <vector>

#include "fine_fit.hpp"

namespace paracal::benchmark {

/// The same fits by SciPy: calibration_opponent.py, a separate process that solves all of them on request, on one
/// thread.
class ScipyFits {
 public:
  /// @param costs  squared residuals of our answers
  ScipyFits(const std::vector<FineFit>& fits, const std::vector<double>& costs);
  ~ScipyFits();
  ScipyFits(const ScipyFits&) = delete;
  ScipyFits& operator=(const ScipyFits&) = delete;

  /// "SciPy 1.10.1, NumPy 1.24.2"; empty where it is not installed.
  const std::string& versions() const { return versions_; }

  /// By a method of least_squares().
  /// @returns largest share by which a cost is off ours.
  double solve(const std::string& method);

 private:
  std::string answer() const;

  std::string tasks_;  ///< path
  int stream_ = -1;
  int process_ = -1;
  std::string versions_;
};

}  // namespace paracal::benchmark
