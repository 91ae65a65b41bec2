#pragma once

// Private to calibration: readings as a linear model, the visits of a pose together.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "calibration/fit/stage_fit.hpp"

namespace paracal::detail {

/// What one series reads at one pose (or from one pose to another), as the mean of its visits: rows [J | r], J by the
/// unknowns, divided by the standard deviations with which the readings entered.
struct ReadingBlock {
  /// One visit: its place among the groups, and how far its residuals are from their mean.
  struct Visit {
    std::size_t group;
    Eigen::VectorXd off;
  };

  Eigen::MatrixXd rows;
  Eigen::MatrixXd by_joint;       ///< H, by the joints there
  Eigen::MatrixXd by_from_joint;  ///< by those of the pose that it is relative to; empty: to none
  Eigen::MatrixXd scatter;        ///< sum of d d^T over the visits, d from their mean
  double visits = 1.0;
  std::size_t station = 0, from = 0;
  bool stated = false;
  std::size_t series = 0;
  std::vector<Visit> each = {};
  Eigen::Index first_angle = 0, angles = 0;  ///< rows of an orientation, or of a rotation
};

/// Readings in use by where they were taken: station, station that they are relative to, series.
class ReadingPlaces {
 public:
  explicit ReadingPlaces(const Observation& observation);

  std::size_t count() const { return places_.size(); }
  /// Blocks of every `stride`-th place, those of a station one after another.
  void each_block(const StageFit& fit, std::size_t stride, const std::function<void(ReadingBlock&&)>& look) const;

 private:
  struct Place {
    std::array<std::uint32_t, 3> at;
    std::vector<std::uint32_t> groups;
  };
  std::vector<Place> places_;
};

}  // namespace paracal::detail
