#pragma once

// Private to calibration: distances between the plate centres at two stations.

#include "series.hpp"

namespace paracal::detail {

///   distance   (1 + scale) |r_to - r_from| + bias
///   rotation   phi_to - phi_from
///
/// with the bias, which all distances share, and the scale sought where options allow for them: 1 or 2 rows.
class Distances final : public ReadingSeries {
 public:
  Distances(const std::vector<DistanceReading>& readings, const CalibrationOptions& options);

  std::unique_ptr<ReadingSeries> copy() const override { return std::make_unique<Distances>(*this); }
  std::size_t size() const override { return readings_.size(); }
  Group group(std::size_t index) const override;
  double sigma(std::size_t index) const override;
  Quantity quantity() const override { return Quantity::distance; }
  Eigen::Index rotation_rows(std::size_t index) const override { return readings_[index].rotation ? 1 : 0; }
  void take_columns(Eigen::Index& next, bool seeks_scale) override;
  void add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const override;
  ByPlate rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const override;
  Residual residual(std::size_t index, const Placed& at) const override;
  std::string label(std::size_t index, const std::vector<Station>& stations) const override;
  void add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const override;
  void list(const Group& group, const std::vector<Station>& stations, const Residual& before, const Residual& after,
            FitResiduals& all) const override;
  void add_set_up(const FoundUnknowns& found, FoundSetUps& all, Remarks& remarks) const override;

 private:
  std::optional<double> bias(const Eigen::VectorXd& unknowns) const;

  const std::vector<DistanceReading>& readings_;
  const CalibrationOptions& options_;
  Eigen::Index bias_ = -1;  ///< column; -1 where none is sought
};

}  // namespace paracal::detail
