#pragma once

// Private to calibration: heights of the plate centre above a plane that is sought with the rest.

#include "series.hpp"

namespace paracal::detail {

///   height     z - (z_0 + s_x x + s_y y)
///
/// with z_0 and the slopes sought: 1 row.
class Heights final : public ReadingSeries {
 public:
  Heights(const HeightSeries& plane, const CalibrationOptions& options);

  std::unique_ptr<ReadingSeries> copy() const override { return std::make_unique<Heights>(*this); }
  std::size_t size() const override { return readings_.size(); }
  Group group(std::size_t index) const override;
  double sigma(std::size_t index) const override;
  Quantity quantity() const override { return Quantity::height; }
  void take_columns(Eigen::Index& next, bool seeks_scale) override;
  void start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) override;
  void add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const override;
  ByPlate rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const override;
  Residual residual(std::size_t index, const Placed& at) const override;
  std::string label(std::size_t index, const std::vector<Station>& stations) const override;
  void add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const override;
  void list(const Group& group, const std::vector<Station>& stations, const Residual& before, const Residual& after,
            Calibration& calibration) const override;
  void state_setup(const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& covariance,
                   Calibration& calibration) const override;

 private:
  const std::vector<HeightReading>& readings_;
  const CalibrationOptions& options_;
  Eigen::Index plane_ = -1;  ///< columns of z_0, s_x, s_y
};

}  // namespace paracal::detail
