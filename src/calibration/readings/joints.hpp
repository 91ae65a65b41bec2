#pragma once

// Private to calibration: joints that must agree, because limbs are more than degrees of freedom.

#include "series.hpp"

namespace paracal::detail {

///   0 = gaps of the joints at a station (JointGaps)
///
/// a row a limb more than degrees of freedom, a reading a station. Without a set-up.
class JointReadings final : public ReadingSeries {
 public:
  /// @param sigma  of a joint, rad or mm. @param ratio  mm that the end of a rod moves per rad or mm of a joint.
  JointReadings(std::size_t stations, double sigma, double ratio);

  std::unique_ptr<ReadingSeries> copy() const override { return std::make_unique<JointReadings>(*this); }
  std::size_t size() const override { return stations_; }
  Group group(std::size_t index) const override;
  double sigma(std::size_t /*index*/) const override { return ratio_ * sigma_; }
  Quantity quantity() const override { return Quantity::gap; }
  bool follows_gaps() const override { return true; }
  ByPlate rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const override;
  Residual residual(std::size_t index, const Placed& at) const override;
  std::string label(std::size_t index, const std::vector<Station>& stations) const override;
  void add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const override;

 private:
  std::size_t stations_;
  double sigma_, ratio_;
};

}  // namespace paracal::detail
