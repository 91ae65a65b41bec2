#pragma once

// Private to calibration: a series of lengths of any kind.

#include "length_model.hpp"
#include "series.hpp"

namespace paracal::detail {

///   length     (1 + scale) shown(r, set-up)
///
/// with the set-up of its kind, and the scale where such lengths show it, sought: 1 row.
class Lengths final : public ReadingSeries {
 public:
  Lengths(const LengthSeries& series, const CalibrationOptions& options);

  std::unique_ptr<ReadingSeries> copy() const override { return std::make_unique<Lengths>(*this); }
  std::size_t size() const override { return series_.readings.size(); }
  Group group(std::size_t index) const override;
  double sigma(std::size_t index) const override;
  Quantity quantity() const override { return Quantity::length; }
  void take_columns(Eigen::Index& next, bool seeks_scale) override;
  void start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) override;
  void add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const override;
  void set_units(Eigen::VectorXd& unit) const override;
  ByPlate rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const override;
  Residual residual(std::size_t index, const Placed& at) const override;
  std::string label(std::size_t index, const std::vector<Station>& stations) const override;
  void add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const override;
  std::optional<LengthKind> length_kind() const override { return series_.kind; }
  void list(const Group& group, const std::vector<Station>& stations, const Residual& before, const Residual& after,
            FitResiduals& all) const override;
  void add_set_up(const FoundUnknowns& found, FoundSetUps& all, Remarks& remarks) const override;

 private:
  SetUp set_up(const Eigen::VectorXd& unknowns) const { return unknowns.segment(first_, count_); }
  LengthShown shown(std::size_t index, const Placed& at) const;

  const LengthSeries& series_;
  const LengthModel& model_;
  const CalibrationOptions& options_;
  Eigen::Index first_ = -1, count_ = 0;  ///< columns of the set-up
  std::string assumed_ = {};             ///< what its start took for granted
};

}  // namespace paracal::detail
